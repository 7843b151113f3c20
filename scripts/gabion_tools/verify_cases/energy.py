"""Energy of undamped coupled runs with frozen contacts and random motion of 1e-6 diameters; work of the multipliers."""

import numpy as np

TITLE = "energy balance, work of the multipliers, momentum"

SCENES = {"lattice": "tiny_lattice", "random": "tiny"}
SCHEMES = {"bridging_mortar": {"model": "bridging"},
           "bridging_strict": {"model": "bridging", "coupling.bridging.rows": "strict"},
           "edge": {"model": "edge"}}


def run(context):
    steps = 40000 if context.full else 10000
    drifts, residual, momentum = {}, 0.0, 0.0
    for scheme, choice in SCHEMES.items():
        for name, scene in SCENES.items():
            result = context.run_scene(scene, {
                **choice, "grains.geometry": "frozen", "coupling.bridging.sponge": "null", "gravity": "null", "faces": "null",
                "stages": '[{"name": "shake", "damping": 0, "steps": %d}]' % steps, "probes": "[]", "initial": '{"noise": "1e-3 m/s"}',
                "output": '{"monitor_steps": 100}'})
            balance = result.history("energy", "balance")
            scale = result.summary["energy"]["largest"]
            drifts[scheme, name] = float(np.ptp(balance) / scale)
            residual = max(residual, work_residual(result))
            momentum = max(momentum, linear_momentum(result))
    for scheme in SCHEMES:
        yield context.figure(f"drift_{scheme}", max(drifts[scheme, name] for name in SCENES), "", "<= 1e-9")
        for name in SCENES:
            yield context.figure(f"drift, {scheme}, {name}, {steps} steps", drifts[scheme, name], "", "report")
    yield context.figure("multiplier_work_residual", residual, "", "<= 1e-12")
    yield context.figure("linear_momentum_change", momentum, "", "<= 1e-12")


def work_residual(result):
    """Change of work on grains + work on continuum over the largest energy of the run. The first step's share, which
    joins the two media's unequal random velocities, is left out."""
    total = result.history("energy", "grains multipliers") + result.history("energy", "continuum multipliers")
    return float(np.ptp(total) / result.summary["energy"]["largest"])


def linear_momentum(result):
    """Change of the whole linear momentum over the sum of m|v|."""
    scale = result.history("monitor", "sum of m v")
    return max(float(np.ptp(result.history("monitor", f"momentum.{axis}")) / scale.max()) for axis in "xyz")
