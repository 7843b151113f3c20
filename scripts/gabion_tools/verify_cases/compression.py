"""A pressure pulse on the head of a cube, sides free and on rollers: first peaks at the head (A) and the middle (B), and period.

The scene's pulse is well resolved (10 elements); a second one, 4 elements long, is near the mesh's limit.
The mesh has the constants that the all-grain sample shows in the triaxial case, with the grains' own mass. Peak: first
maximum of the downward displacement. Period: between two zero crossings of the same sign after it.
"""

import numpy as np

from gabion_tools import sample_measure as sample
from gabion_tools.errors import Failure
from gabion_tools.verify_cases import triaxial

TITLE = "stress pulse on a cube: peaks and period of the coupled models against all grains"

SCENE = "compression"
LONG = "80 ms"  # several periods, so that one is measured between crossings of the same sign
SHORT = "3.7 ms"  # 4 elements of 0.5 m
SHORT_RUN = "15 ms"
ENOUGH = 0.3    # of the largest displacement: smaller maxima are no peaks


def first_peak(time, down):
    """(time, value) of the first maximum, through the three samples around it."""
    inner = down[1:-1]
    at = np.flatnonzero((inner > down[:-2]) & (inner >= down[2:]) & (inner > ENOUGH * down.max()))
    if len(at) == 0:
        raise Failure("the displacement has no maximum: the run is too short")
    k = at[0] + 1
    before, here, after = down[k - 1:k + 2]
    shift = 0.5 * (before - after) / (before - 2 * here + after)
    return time[k] + shift * (time[k + 1] - time[k]), here - 0.25 * (before - after) * shift


def period(time, down):
    """Between the first two crossings of the same sign after the first peak."""
    start = first_peak(time, down)[0]
    k = np.flatnonzero((down[:-1] > 0) & (down[1:] <= 0) & (time[:-1] > start))
    if len(k) < 2:
        raise Failure("fewer than two zero crossings of the same sign: the run is too short")
    crossing = time[k] + (time[k + 1] - time[k]) * down[k] / (down[k] - down[k + 1])
    return crossing[1] - crossing[0]


def peaks(run):
    """First peaks at A and B, m downwards."""
    time = run.history("probes", "time")
    return {f"peak_{name}": first_peak(time, -run.history("probes", f"{name}.z"))[1] for name in "AB"}


def measured(run):
    time = run.history("probes", "time")
    down = {name: -run.history("probes", f"{name}.z") for name in "AB"}
    return {**peaks(run), "period": period(time, down["A"])}


SIDES = {f"faces.{face}": "roller" for face in ("xmin", "xmax", "ymin", "ymax")}
POISSON = 0.32  # any will do: sides on rollers leave only the P modulus


def confined_constants(reference, model, size):
    """Changes that give the mesh the P modulus of the grains that it replaces, from a static run on rollers."""
    share, box = triaxial.replaced_share(reference, model, size), sample.ground(reference)
    points = reference.state("grains")["position"]
    inside = triaxial.window(points, box)
    gradient = sample.gradient(points[inside], sample.displacement(reference, reference)[inside], share[inside])
    area = np.prod(box[1, :2] - box[0, :2])
    head = -sum(values[-1] for name, values in reference.histories["reactions"].items() if "zmax.z" in name)
    modulus = head / area / -gradient[2, 2]
    young = modulus * (1 + POISSON) * (1 - 2 * POISSON) / (1 - POISSON)
    height = box[1, 2] - box[0, 2]
    density = (sample.grain_mass(reference) * share).sum() / (triaxial.replaced_part(share, model, size, height) * area * height)
    return sample.material_of_sample(reference, float(young), POISSON, float(density))


def on_rollers(context, size):
    """{figure: value} with the sides on rollers: one-dimensional, without the soft skin of free sides."""
    load = {"name": "load", "damping": 0.7, "until": {"unbalanced": 1e-6}, "max_steps": 100000,
            "faces": {"zmax": {"displace": {"by": "-0.3 mm", "over": "20 ms"}, "direction": "z"}}}
    at_rest = context.run_scene(triaxial.SCENE, {**size, **SIDES, "model": "dem", "faces.zmin": "fixed", "stages": [load]})
    reference = measured(context.run_scene(SCENE, {**size, **SIDES, "model": "dem"}))
    found = {}
    for model in ("bridging", "edge", "continuum"):
        done = context.run_scene(SCENE, {**size, **SIDES, "model": model, **confined_constants(at_rest, model, size)})
        found.update({f"{name}_{model}_rollers_error": value / reference[name] - 1 for name, value in measured(done).items()})
    return found


def one_packing(context, size, seed):
    """{figure: value} of one packing, and the largest error of an energy balance."""
    size = {**size, "grains.seed": seed}
    sample_run = context.run_scene(triaxial.SCENE, {**size, "model": "dem"})
    size["stages"] = [{"name": "pulse", "damping": 0, "duration": LONG}]
    short = {"stages": [{"name": "pulse", "damping": 0, "duration": SHORT_RUN}],
             "faces.zmax.pressure.half_sine.duration": SHORT}
    reference = measured(context.run_scene(SCENE, {**size, "model": "dem"}))
    short_reference = peaks(context.run_scene(SCENE, {**size, **short, "model": "dem"}))
    found, balance = {}, []
    for model in ("bridging", "edge", "continuum"):
        choice = {**size, "model": model, **triaxial.constants(sample_run, model, size)}
        done = context.run_scene(SCENE, choice)
        found.update({f"{name}_{model}_error": value / reference[name] - 1 for name, value in measured(done).items()})
        brief = peaks(context.run_scene(SCENE, {**choice, **short}))
        found.update({f"{name}_{model}_error, pulse of 4 elements": value / short_reference[name] - 1 for name, value in brief.items()})
        balance.append(abs(done.summary["energy"]["balance_error"]))
    found.update(on_rollers(context, size))
    units = {"peak_A": ("peak_A_dem_mm", 1e3), "peak_B": ("peak_B_dem_mm", 1e3), "period": ("period_dem_ms", 1e3)}
    found.update({label: reference[name] * scale for name, (label, scale) in units.items()})
    return found, max(balance)


def run(context):
    size = triaxial.FINE if context.full else {}
    packings, balance = zip(*[one_packing(context, size, seed) for seed in sample.seeds(context)])
    aims = [f"{name}_{model}{sides}_error" for sides in ("", "_rollers") for model in ("bridging", "edge") for name in ("peak_A", "peak_B", "period")]
    yield from sample.mean_figures(context, packings, dict.fromkeys(aims, "-0.01 .. 0.01"))
    yield context.figure("energy_balance", max(balance), "", "<= 1e-6")
