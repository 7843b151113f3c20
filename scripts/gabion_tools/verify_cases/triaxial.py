"""Apparent modulus and Poisson's ratio of a cube under axial strain and constant lateral pressure, four models.

Strain: affine fit of the increments after confinement, at the same points for every model, 0.2 to 0.8 of the height
and the inner 0.7 of the width. Stress: reaction of the head over the area, less the confinement. E_..._over_dem is
E / E_dem - 1, nu_..._minus_dem a plain difference.

The grains at a free face carry less than those inside (a cube of 16 diameters is 20 % softer than its inner part),
so the mesh is given the constants of the sample, not of its inner part: those that the all-grain run shows where the
mesh replaces grains, each grain counted with the share that the mesh takes over.
"""

import numpy as np

from gabion_tools import sample_measure as sample

TITLE = "triaxial compression of a cube: modulus and Poisson's ratio of the coupled models against all grains"

SCENE = "triaxial"
CONFINEMENT = 10e3  # Pa, as in the scene
BORDER = 1.5  # m, as in the scene: height of the border, which is also the middle of the overlap
HEIGHT = (0.2, 0.8)
WIDTH = 0.7
MODELS = {
    "continuum": {"model": "continuum"},
    "bridging": {"model": "bridging"},
    "edge": {"model": "edge"},
    "strict": {"model": "bridging", "coupling.bridging.rows": "strict"},
}
# 20 000 grains; the overlap stays 3 elements, 8 mean diameters wide
FINE = {"grains.radius": {"uniform": ["0.036 m", "0.072 m"]}, "mesh.size": "0.3 m", "coupling.bridging.overlap": "0.9 m",
        "coupling.bridging.zone": [["-1.5 m", "-1.5 m", "0 m"], ["1.5 m", "1.5 m", "1.95 m"]]}


def window(points, box):
    """Points between the parts of the sample that its faces disturb."""
    low, high = box
    middle, half = 0.5 * (low + high), 0.5 * (high - low)
    height = (points[:, 2] - low[2]) / (high[2] - low[2])
    return (np.all(np.abs(points[:, :2] - middle[:2]) < WIDTH * half[:2], axis=1)
            & (height > HEIGHT[0]) & (height < HEIGHT[1]))


def strained(run, reference):
    """Increments of displacement after confinement, as the scene's stage "load" counts them."""
    return sample.displacement(run, reference)


def axial_stress(run, box):
    columns = [name for name in run.histories["reactions"] if "zmax.z" in name]
    head = -sum(run.histories["reactions"][name][-1] for name in columns)
    low, high = box
    return head / ((high[0] - low[0]) * (high[1] - low[1])) - CONFINEMENT


def moduli(run, reference, share=None):
    """(E, nu) that the run shows in the window, points weighted with share."""
    box, points = sample.ground(reference), reference.state("grains")["position"]
    chosen = window(points, box)
    g = sample.gradient(points[chosen], strained(run, reference)[chosen], None if share is None else share[chosen])
    return axial_stress(run, box) / -g[2, 2], -(g[0, 0] + g[1, 1]) / (2 * g[2, 2])


def overlap(size):
    """Width of the overlap, m."""
    return float(size.get("coupling.bridging.overlap", "1.5 m").split()[0])


def border(model, size):
    """Height of the border, which is also the middle of the overlap, m: as in the scene, or of the zone in size."""
    zone = size.get(f"coupling.{model}.zone")
    if zone is None:
        return BORDER
    top = float(zone[1][2].split()[0])
    return top - 0.5 * overlap(size) if model == "bridging" else top


def kind(model):
    """Rows of another kind are bridging too."""
    return "bridging" if model == "strict" else model


def replaced_share(reference, model, size):
    """What the mesh takes over of every grain: all in a continuum, 1 - w in an overlap, what lies beyond a border."""
    height = reference.state("grains")["position"][:, 2]
    if model == "continuum":
        return np.ones(len(height))
    above = height - border(kind(model), size)
    if model == "edge":
        return (above > 0).astype(float)
    return np.clip(0.5 + above / overlap(size), 0.0, 1.0)


def replaced_part(share, model, size, height):
    """The same as a share of the sample's volume; the sample is packed more loosely along its faces."""
    return share.mean() if model == "continuum" else 1.0 - border(kind(model), size) / height


def constants(reference, model, size):
    """Changes that give the mesh of this model the constants of the grains that it replaces."""
    share, box = replaced_share(reference, model, size), sample.ground(reference)
    young, poisson = moduli(reference, reference, share)
    height, area = box[1, 2] - box[0, 2], np.prod(box[1, :2] - box[0, :2])
    part = replaced_part(share, model, size, height)
    density = (sample.grain_mass(reference) * share).sum() / (part * height * area)
    return sample.material_of_sample(reference, float(young), float(poisson), float(density))


def one_packing(context, size, seed):
    """{figure: value} of one packing, and the largest unbalanced force at the end of any stage."""
    size = {**size, "grains.seed": seed}
    reference = context.run_scene(SCENE, {**size, "model": "dem"})
    young, poisson = moduli(reference, reference)
    found, rest = {}, [stage["unbalanced"] for stage in reference.summary["stages"]]
    for name, choice in MODELS.items():
        done = context.run_scene(SCENE, {**size, **choice, **constants(reference, name, size)})
        e, nu = moduli(done, reference)
        found[f"E_{name}_over_dem"] = e / young - 1
        found[f"nu_{name}_minus_dem"] = nu - poisson
        rest += [stage["unbalanced"] for stage in done.summary["stages"]]
    return {**found, "E_dem": young / 1e6, "nu_dem": poisson}, max(rest)


def run(context):
    size = FINE if context.full else {}
    packings, rest = zip(*[one_packing(context, size, seed) for seed in sample.seeds(context)])
    aims = [figure.format(name) for name in ("bridging", "edge") for figure in ("E_{}_over_dem", "nu_{}_minus_dem")]
    for figure in sample.mean_figures(context, packings, dict.fromkeys(aims, "-0.01 .. 0.01")):
        if figure["figure"].endswith("E_dem"):
            figure["unit"] = "MPa"
        yield figure
    yield context.figure("residual", max(rest), "", "<= 1e-6")
