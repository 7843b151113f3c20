"""The rock on the gravel trench: coupled models against all grains of the same packings."""

import numpy as np

TITLE = "Rock on a gravel trench (coarse grains, 60 ms)"
REFERENCE = "all grains of the same packing, on the smallest ground that has converged; one packing after the other, errors are means over them"
ERROR = "penetration at 60 ms and largest 4 ms force, ratio to all grains less 1; the worse of the two means counts"
KERNELS = "updated"
OMITTED = ("grain size of 0.2 m: the same sweep takes an hour a packing; one point of it is in docs/verification.md",)

SCENE = "impact"
HALF = 6.0  # m, half the ground's width and its depth
PARTS = {"penetration": "penetration_60ms", "force": "largest_force_4ms"}


def box(half, depth=None):
    return [[f"{-half!r} m", f"{-half!r} m", f"{-(depth or half)!r} m"], [f"{half!r} m", f"{half!r} m", "0 m"]]


BASE = {"grains.radius": {"uniform": ["0.1 m", "0.2 m"]}, "mesh.size": "0.75 m", "stages[1].duration": "62 ms", "output.every": "62 ms",
        "ground.box": box(HALF), "probes": []}


def bridging(half, overlap=1.5, size=0.75, **more):
    return {"model": "bridging", "coupling.bridging.zone": box(half), "coupling.bridging.overlap": f"{overlap!r} m", "mesh.size": f"{size!r} m", **more}


def edge(half, size=0.75):
    return {"model": "edge", "coupling.edge.zone": box(half), "mesh.size": f"{size!r} m"}


def seeds(context):
    if context.seed is not None:
        return (context.seed,)
    return range(1, 9) if context.full else range(1, 4)


def block(context, seed, change):
    run = context.run_scene(SCENE, {**BASE, **change, "grains.seed": seed})
    return run, run.summary["figures"]["block"]


def measure(context, change, against=None):
    """(runs, {part: [ratio - 1 of each packing]}); against: what the reference changes."""
    runs, parts = [], {name: [] for name in PARTS}
    for seed in seeds(context):
        run, figures = block(context, seed, change)
        reference = block(context, seed, against or {"model": "dem"})[1]
        runs.append(run)
        for name, key in PARTS.items():
            parts[name].append(figures[key] / reference[key] - 1)
    return runs, parts


def floor(context):
    """Standard error of the mean penetration of all grains over these packings: what no choice of model removes."""
    values = np.array([block(context, seed, {"model": "dem"})[1]["penetration_60ms"] for seed in seeds(context)])
    return float(values.std(ddof=1) / values.mean() / np.sqrt(len(values))) if len(values) > 1 else None


def jobs(context):
    yield {"label": "all grains", "knob": "reference", "reference": True, "measure": lambda: measure(context, {"model": "dem"}),
           "floor": lambda: floor(context)}
    yield {"label": "all grains, half the step", "knob": "step", "measure": lambda: measure(context, {"model": "dem", "run.step_fraction": 0.45}),
           "note": "how far the reference hangs on its step"}
    yield {"label": "all grains of 0.4 m", "knob": "grain size",
           "measure": lambda: measure(context, {"model": "dem", "grains.radius": {"uniform": ["0.1333 m", "0.2667 m"]}}),
           "note": "coarser grains in place of coupling"}
    for half in (5.25, 4.5, 4.1, 3.75, 3.4, 3.0):
        yield {"label": f"bridging, zone +-{half} m", "knob": "zone", "measure": lambda half=half: measure(context, bridging(half))}
    yield {"label": "bridging, zone = auto", "knob": "zone", "note": "cost of the quick run not counted",
           "measure": lambda: measure(context, {"model": "bridging", "coupling.bridging.zone": "auto"})}
    yield {"label": "bridging, +-4.5 m, overlap 2.25 m", "knob": "overlap", "measure": lambda: measure(context, bridging(4.5, overlap=2.25))}
    yield {"label": "bridging, +-4.5 m, mesh 1 m, overlap 2 m", "knob": "mesh", "measure": lambda: measure(context, bridging(4.5, overlap=2.0, size=1.0))}
    yield {"label": "bridging, +-4.1 m, strict rows", "knob": "rows", "measure": lambda: measure(context, bridging(4.1, **{"coupling.bridging.rows": "strict"}))}
    yield {"label": "bridging, +-4.1 m, half the step", "knob": "step", "measure": lambda: measure(context, bridging(4.1, **{"run.step_fraction": 0.45}))}
    yield {"label": "bridging, +-4.1 m, weights' floor 0.1", "knob": "weights", "measure": lambda: measure(context, bridging(4.1, **{"coupling.bridging.weight_floor": 0.1}))}
    for half in (2.85, 2.7, 2.6):
        yield {"label": f"bridging, +-{half} m, overlap 0.75 m", "knob": "zone", "measure": lambda half=half: measure(context, bridging(half, overlap=0.75))}
    for what, knob, change in (("grading 1.6", "grading", {"mesh.grading": 1.6}), ("rates up to 4", "rates", {"mesh.rates": {"largest": 4}}),
                               ("sponge of 12.8", "sponge", {"coupling.bridging.sponge": {"strength": 12.8}})):
        yield {"label": f"bridging, +-2.7 m, overlap 0.75 m, {what}", "knob": knob,
               "measure": lambda change=change: measure(context, bridging(2.7, overlap=0.75, **change))}
    for half in (3.75, 3.0, 2.6, 2.25, 2.1):
        yield {"label": f"edge, zone +-{half} m", "knob": "zone", "measure": lambda half=half: measure(context, edge(half))}
