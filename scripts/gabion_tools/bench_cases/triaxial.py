"""The cube under axial strain: modulus and Poisson's ratio against all grains."""

from gabion_tools.verify_cases import triaxial

TITLE = "Triaxial compression of a cube of 4 300 grains"
REFERENCE = "all grains of the same packing; the mesh has the constants that this run shows where the mesh replaces grains"
ERROR = "E over that of all grains less 1, and the difference of Poisson's ratios"
KERNELS = "updated"


def zone(top):
    """The sample's lower part."""
    return [["-1.5 m", "-1.5 m", "0 m"], ["1.5 m", "1.5 m", f"{top!r} m"]]


def wide(overlap, size=0.5, border=triaxial.BORDER, **more):
    """border: height of the middle of the overlap, m."""
    return {"coupling.bridging.overlap": f"{overlap!r} m", "coupling.bridging.zone": zone(border + overlap / 2), "mesh.size": f"{size!r} m", **more}


def edge(border):
    return {"coupling.edge.zone": zone(border)}


def seeds(context):
    if context.seed is not None:
        return (context.seed,)
    return (1, 2, 3) if context.full else (1,)


def measure(context, name, choice):
    runs, parts = [], {"E": [], "nu": []}
    for seed in seeds(context):
        size = {"grains.seed": seed}
        reference = context.run_scene(triaxial.SCENE, {**size, "model": "dem"})
        young, poisson = triaxial.moduli(reference, reference)
        if name == "dem":
            run, e, nu = reference, young, poisson
        else:
            run = context.run_scene(triaxial.SCENE, {**size, **triaxial.MODELS[name], **choice, **triaxial.constants(reference, name, choice)})
            e, nu = triaxial.moduli(run, reference)
        runs.append(run)
        parts["E"].append(e / young - 1)
        parts["nu"].append(nu - poisson)
    return runs, parts


def jobs(context):
    yield {"label": "all grains", "knob": "reference", "reference": True, "measure": lambda: measure(context, "dem", {})}
    yield {"label": "continuum", "knob": "coupling", "measure": lambda: measure(context, "continuum", {}), "note": "0 by construction: its constants are those of the reference"}
    for overlap in (0.5, 1.0, 1.5, 2.0):
        yield {"label": f"bridging, overlap {overlap:.1f} m", "knob": "overlap", "measure": lambda overlap=overlap: measure(context, "bridging", wide(overlap))}
    yield {"label": "bridging, mesh 0.75 m, overlap 1.5 m", "knob": "mesh", "measure": lambda: measure(context, "bridging", wide(1.5, 0.75))}
    yield {"label": "bridging, overlap 1.5 m, half the step", "knob": "step",
           "measure": lambda: measure(context, "bridging", wide(1.5, **{"run.step_fraction": 0.45}))}
    yield {"label": "bridging, overlap 1.5 m, weights' floor 0.1", "knob": "weights",
           "measure": lambda: measure(context, "bridging", wide(1.5, **{"coupling.bridging.weight_floor": 0.1}))}
    yield {"label": "strict, overlap 1.5 m", "knob": "rows", "measure": lambda: measure(context, "strict", wide(1.5))}
    yield {"label": "bridging, middle of the overlap at 0.75 m", "knob": "zone", "measure": lambda: measure(context, "bridging", wide(1.0, border=0.75))}
    yield {"label": "edge, border at 0.5 m", "knob": "zone", "measure": lambda: measure(context, "edge", edge(0.5))}
    yield {"label": "edge", "knob": "coupling", "measure": lambda: measure(context, "edge", {})}
