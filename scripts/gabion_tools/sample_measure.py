"""Displacements of the four models at the same points, and what is fitted to them. Needs numpy.

The points are the grains' places in the all-grain run. A model's displacement there is that of its own grain with
the grain's weight plus that of its mesh with the rest, so every model is measured in the same way.
"""

import json

import numpy as np

OF_SAMPLE = "sample"  # name of the material that a calibrated run defines


def on_mesh(run, points, index=-1):
    """Displacement of the mesh at points; nan where there is no mesh."""
    mesh = run.state("mesh", index)
    found = np.full((len(points), 3), np.nan)
    if not mesh:
        return found
    nodes, motion = mesh["nodes"], mesh["displacement"]
    motion = motion if len(motion) == len(nodes) else motion[mesh["node"]]
    for corners in mesh["elements"]:
        low, high = nodes[corners].min(axis=0), nodes[corners].max(axis=0)
        slack = 1e-9 * (high - low)
        inside = np.flatnonzero(np.all((points >= low - slack) & (points <= high + slack), axis=1))
        along = (points[inside] - low) / (high - low)
        middle = 0.5 * (low + high)
        found[inside] = sum(np.where(nodes[c] > middle, along, 1.0 - along).prod(axis=1)[:, None] * motion[c]
                            for c in corners)
    return found


def grain_share(run, reference):
    """Weight of the run's own grain at every grain of the all-grain run; 0 where the run has none."""
    names = reference.state("grains")["origin_id"]
    share, grains = np.zeros(len(names)), run.state("grains")
    if not grains:
        return share, np.empty(0, int)
    place = {name: k for k, name in enumerate(names)}
    at = np.array([place[name] for name in grains["origin_id"]])
    share[at] = grains["weight"] if run.model == "bridging" else 1.0
    return share, at


def displacement(run, reference, index=-1):
    """Of the model, at the places of the reference's grains."""
    points = reference.state("grains")["position"]
    share, at = grain_share(run, reference)
    mesh = on_mesh(run, points, index)
    alone = np.isnan(mesh[:, 0])
    share[alone], mesh[alone] = 1.0, 0.0
    moved = (1.0 - share)[:, None] * mesh
    if len(at):
        moved[at] += share[at, None] * run.state("grains", index)["displacement"]
    return moved


def gradient(points, moved, weight=None):
    """Displacement gradient by a least-squares affine fit."""
    root = np.sqrt(np.ones(len(points)) if weight is None else weight)[:, None]
    unknown = np.column_stack([np.ones(len(points)), points])
    return np.linalg.lstsq(unknown * root, moved * root, rcond=None)[0][1:]


def effective(run):
    return json.loads((run.folder / "scene.effective.json").read_text(encoding="utf-8"))


def ground(run):
    """Corners of the ground's box, m."""
    box = effective(run)["ground"]["box"]
    return np.array([[float(str(value).split()[0]) for value in corner] for corner in box])


def material_of_sample(reference, young, poisson, density):
    """Changes that give the mesh these constants and leave the grains as they are in the reference."""
    scene = effective(reference)
    soil = {**scene["materials"][scene["ground"]["material"]], "young": f"{young!r} Pa", "poisson": poisson,
            "bulk_density": f"{density!r} kg/m3"}
    return {f"materials.{OF_SAMPLE}": soil, "ground.material": OF_SAMPLE, "mesh.stiffness": "material"}


def grain_mass(reference):
    scene = effective(reference)
    density = float(scene["materials"][scene["ground"]["material"]]["density"].split()[0])
    return density * 4.0 / 3.0 * np.pi * reference.state("grains")["radius"] ** 3


def seeds(context):
    """One packing is off its mean by several per cent: figures are means over three, or of the one asked for."""
    return (1, 2, 3) if context.seed is None else (context.seed,)


def mean_figures(context, packings, goals):
    """A figure for every name in packings, a list of {name: value}: the mean, and its standard error beside it."""
    for name in packings[0]:
        values = np.array([packing[name] for packing in packings])
        yield context.figure(name, values.mean(), "", goals.get(name, "report"))
        if len(values) > 1:
            yield context.figure(f"standard error of {name}, {len(values)} packings",
                                 values.std(ddof=1) / np.sqrt(len(values)), "", "report")
