"""The pulse on a cube whose sides are on rollers: histories against all grains."""

import numpy as np

from gabion_tools.bench_cases.triaxial import edge, wide
from gabion_tools.verify_cases import compression, triaxial

TITLE = "Stress pulse on a cube of 4 300 grains, sides on rollers"
REFERENCE = "all grains of the same packing; the mesh has the P modulus of the same grains in a static run on rollers"
ERROR = "peaks at the head and the middle, and the period, ratio to all grains less 1; the worst counts"
KERNELS = "frozen"


def seeds(context):
    if context.seed is not None:
        return (context.seed,)
    return (1, 2, 3) if context.full else (1, 2)


def sides(seed):
    return {**compression.SIDES, "grains.seed": seed}


def at_rest(context, seed):
    load = {"name": "load", "damping": 0.7, "until": {"unbalanced": 1e-6}, "max_steps": 100000,
            "faces": {"zmax": {"displace": {"by": "-0.3 mm", "over": "20 ms"}, "direction": "z"}}}
    return context.run_scene(triaxial.SCENE, {**sides(seed), "model": "dem", "faces.zmin": "fixed", "stages": [load]})


def measure(context, model, choice):
    runs, parts = [], {"head": [], "middle": [], "period": []}
    stages = {"stages": [{"name": "pulse", "damping": 0, "duration": compression.LONG}]}
    for seed in seeds(context):
        whole = context.run_scene(compression.SCENE, {**sides(seed), **stages, "model": "dem"})
        run = whole
        if model != "dem" or choice:
            constants = {} if model == "dem" else compression.confined_constants(at_rest(context, seed), model, choice)
            run = context.run_scene(compression.SCENE, {**sides(seed), **stages, "model": model, **choice, **constants})
        runs.append(run)
        reference, found = compression.measured(whole), compression.measured(run)
        for part, key in (("head", "peak_A"), ("middle", "peak_B"), ("period", "period")):
            parts[part].append(found[key] / reference[key] - 1)
    return runs, parts


def floor(context):
    """Standard error of the head's peak of all grains over these packings."""
    stages = {"stages": [{"name": "pulse", "damping": 0, "duration": compression.LONG}]}
    peaks = np.array([compression.peaks(context.run_scene(compression.SCENE, {**sides(s), **stages, "model": "dem"}))["peak_A"] for s in seeds(context)])
    return float(peaks.std(ddof=1) / peaks.mean() / np.sqrt(len(peaks))) if len(peaks) > 1 else None


def jobs(context):
    yield {"label": "all grains", "knob": "reference", "reference": True, "measure": lambda: measure(context, "dem", {}), "floor": lambda: floor(context)}
    yield {"label": "all grains, half the step", "knob": "step", "measure": lambda: measure(context, "dem", {"run.step_fraction": 0.45})}
    yield {"label": "continuum", "knob": "coupling", "measure": lambda: measure(context, "continuum", {})}
    yield {"label": "continuum, mesh 0.25 m", "knob": "mesh", "measure": lambda: measure(context, "continuum", {"mesh.size": "0.25 m"})}
    for overlap in (0.5, 1.0, 1.5, 2.0):
        yield {"label": f"bridging, overlap {overlap:.1f} m", "knob": "overlap", "measure": lambda overlap=overlap: measure(context, "bridging", wide(overlap))}
    yield {"label": "bridging, mesh 0.75 m, overlap 1.5 m", "knob": "mesh", "measure": lambda: measure(context, "bridging", wide(1.5, 0.75))}
    yield {"label": "bridging, strict, overlap 1.5 m", "knob": "rows", "measure": lambda: measure(context, "bridging", wide(1.5, **{"coupling.bridging.rows": "strict"}))}
    yield {"label": "bridging, overlap 1.5 m, half the step", "knob": "step", "measure": lambda: measure(context, "bridging", wide(1.5, **{"run.step_fraction": 0.45}))}
    yield {"label": "bridging, overlap 1.5 m, no sponge", "knob": "sponge", "measure": lambda: measure(context, "bridging", wide(1.5, **{"coupling.bridging.sponge.strength": 0}))}
    for border in (1.0, 0.75):
        yield {"label": f"bridging, overlap 1.0 m, its middle at {border} m", "knob": "zone", "measure": lambda border=border: measure(context, "bridging", wide(1.0, border=border))}
    for border in (1.0, 0.5):
        yield {"label": f"edge, border at {border} m", "knob": "zone", "measure": lambda border=border: measure(context, "edge", edge(border))}
    yield {"label": "edge", "knob": "coupling", "measure": lambda: measure(context, "edge", {})}
