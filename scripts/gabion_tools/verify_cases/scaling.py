"""Spheres dropped on a cohesionless bed: exponents of the penetration and the duration against published laws.

Uehara, Ambroso, Ojha & Durian, Phys. Rev. Lett. 90, 194301 (2003): d ~ rho^(1/2) H^(1/3), H = h + d the total drop.
Goldman & Umbanhowar, Phys. Rev. E 77, 021308 (2008): the duration does not depend on the speed where that is high.
The exponents are fitted to all runs at once; their standard errors come from the fit's residuals.
"""

import numpy as np

TITLE = "spheres on a cohesionless bed: penetration against drop height and density"

SCENE = "sphere_drop"
GRAVITY, SIDE = 9.81, 0.06
DENSITY = 2500.0
SPEEDS = (1.0, 1.4, 2.0, 2.8, 4.0)      # m/s, at DENSITY
DENSITIES = (1000.0, 5000.0, 10000.0)   # kg/m3, at MIDDLE
MIDDLE = 2.0


def exponents(log_inputs, log_output):
    """Least-squares slopes and their standard errors."""
    matrix = np.column_stack([np.ones(len(log_output)), *log_inputs])
    found, *_ = np.linalg.lstsq(matrix, log_output, rcond=None)
    left = log_output - matrix @ found
    freedom = len(log_output) - matrix.shape[1]
    spread = np.sqrt(np.diag(np.linalg.inv(matrix.T @ matrix)) * (left @ left) / freedom)
    return found[1:], spread[1:]


def run(context):
    drops = [(speed, DENSITY) for speed in SPEEDS] + [(MIDDLE, density) for density in DENSITIES]
    depth, duration, balance = [], [], []
    for speed, density in drops:
        mass = density * np.pi / 6 * SIDE ** 3
        done = context.run_scene(SCENE, {"block.velocity": f"{speed} m/s", "block.mass": f"{mass:.6g} kg"})
        block = done.summary["figures"]["block"]
        depth.append(block["penetration_largest"])
        duration.append(block["time_to_stop"])
        balance.append(done.summary["energy"]["balance_error"])
    speed, density = np.array(drops).T
    total = speed ** 2 / (2 * GRAVITY) + np.array(depth)
    (drop, heavy), (drop_error, heavy_error) = exponents([np.log(total), np.log(density)], np.log(depth))
    yield context.figure("exponent_of_the_drop", drop, "", "0.333 +- 0.05")
    yield context.figure("exponent_of_the_drop_standard_error", drop_error, "", "report")
    yield context.figure("exponent_of_the_density", heavy, "", "0.5 +- 0.075")
    yield context.figure("exponent_of_the_density_standard_error", heavy_error, "", "report")
    yield context.figure("duration_ratio_of_the_two_fastest", duration[len(SPEEDS) - 1] / duration[len(SPEEDS) - 2], "", "0.9 .. 1.1")
    for k, v in enumerate(SPEEDS):
        yield context.figure(f"penetration_at_{v:g}_m/s", depth[k], "m", "report")
        yield context.figure(f"duration_at_{v:g}_m/s", duration[k], "s", "report")
    yield context.figure("energy_balance", max(balance), "", "report")
