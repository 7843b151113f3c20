"""A column under its own weight, periodic sideways: settlement of the top and vertical stress against all grains.

Settlement: the probe on the top, an affine fit to the grains within two diameters; the same less that of a level 4.4
diameters above the base. Stress: mean vertical stress of every layer of elements against the weight of the all-grain
column above it, largest departure over the stress at the base; in the overlap the mesh's weighted stress and that of
the grains' weighted contact forces added up. Weight: reaction of the base over the weight of the all-grain column.
"""

import numpy as np

from gabion_tools import sample_measure as sample

TITLE = "column under its own weight: settlement and vertical stress of the coupled models against all grains"

SCENE = "column"
GRAVITY = 9.81
MODELS = {
    "bridging": {"model": "bridging"},
    "edge": {"model": "edge"},
    "strict": {"model": "bridging", "coupling.bridging.rows": "strict"},
    "continuum": {"model": "continuum"},
}
BASE_DIAMETERS = 4.4
FINE = {"grains.radius": {"uniform": ["0.02 m", "0.04 m"]}, "mesh.size": "0.15 m"}  # 17 000 grains


def top(run):
    return run.history("probes", "top.z")[-1]


def above_base(run, reference):
    """Settlement of the top relative to a level a little above the base, m: held grains have no contact below them that
    gives way, so that the base itself is not the same in grains and mesh."""
    points, low = reference.state("grains")["position"], sample.ground(reference)[0]
    level = low[2] + BASE_DIAMETERS * reference.summary["packing"]["mean_diameter"]
    near = np.abs(points[:, 2] - level) < 2 * reference.summary["packing"]["mean_diameter"]
    moved = sample.displacement(run, reference)[near, 2]
    return top(run) - np.polyval(np.polyfit(points[near, 2] - level, moved, 1), 0.0)


def base_reaction(run):
    """Force that the base carries, N; the grains' and the mesh's."""
    columns = [name for name in run.histories["reactions"] if "zmin.z" in name]
    return sum(run.histories["reactions"][name][-1] for name in columns)


def weight_above(reference, level):
    """Of the all-grain column above a level, N; a grain that the level cuts counts by its volume."""
    grains = reference.state("grains")
    r, height = grains["radius"], grains["position"][:, 2] - level
    t = np.clip((height + r) / (2 * r), 0.0, 1.0)
    return GRAVITY * (sample.grain_mass(reference) * t * t * (3 - 2 * t)).sum()


def grain_stress(run, low, high, area):
    """Mean vertical stress that the grains' contacts carry between two heights, Pa: sum of force times branch inside."""
    contacts, height = run.state("contacts"), run.state("grains")["position"][:, 2]
    first, second = height[contacts["grains"][:, 0]], height[contacts["grains"][:, 1]]
    inside = np.clip(np.maximum(first, second), low, high) - np.clip(np.minimum(first, second), low, high)
    return float((contacts["force"][:, 2] * np.sign(second - first) * inside).sum() / (area * (high - low)))


def layer_stress(run, area, shared):
    """{height of an element layer: mean vertical stress, Pa}, of layers in the overlap or of those the mesh carries alone."""
    mesh = run.state("mesh")
    corners = mesh["nodes"][mesh["elements"]][:, :, 2]
    heights = corners.mean(axis=1)
    found = {}
    for h in np.unique(np.round(heights, 9)):
        layer = np.abs(heights - h) < 1e-6
        alone = mesh["weight"][layer].min() > 1 - 1e-12
        if alone == shared:
            continue
        found[h] = (mesh["weight"][layer] * mesh["stress"][layer, 2]).mean()
        if shared:
            found[h] += grain_stress(run, corners[layer].min(), corners[layer].max(), area)
    return found


def stress_error(run, reference, area, shared=False):
    """Largest departure of the vertical stress from the weight of the all-grain column above, relative."""
    largest = weight_above(reference, -np.inf) / area
    layers = layer_stress(run, area, shared)
    return max(abs(-stress - weight_above(reference, h) / area) for h, stress in layers.items()) / largest


def one_packing(context, size, seed):
    """{figure: value} of one packing, and the largest unbalanced force of all grains, bridging and edge."""
    size = {**size, "grains.seed": seed}
    reference = context.run_scene(SCENE, {**size, "model": "dem"})
    low, high = sample.ground(reference)
    area = (high[0] - low[0]) * (high[1] - low[1])
    weight = weight_above(reference, -np.inf)
    found, rest = {}, [stage["unbalanced"] for stage in reference.summary["stages"]]
    for name, choice in MODELS.items():
        done = context.run_scene(SCENE, {**size, **choice, "output": '{"monitor_steps": 100, "fields": ["contact_force"]}'})
        found[f"settlement_{name}_error"] = top(done) / top(reference) - 1
        found[f"settlement_above_base_{name}_error"] = above_base(done, reference) / above_base(reference, reference) - 1
        found[f"stress_{name}_error"] = stress_error(done, reference, area)
        if done.model == "bridging":
            found[f"overlap_stress_{name}_error"] = stress_error(done, reference, area, shared=True)
        found[f"weight_{name}_error"] = base_reaction(done) / weight - 1
        rest += [stage["unbalanced"] for stage in done.summary["stages"]]
    return {**found, "settlement_dem_mm": -top(reference) * 1e3}, max(rest)


def run(context):
    size = FINE if context.full else {}
    packings, rest = zip(*[one_packing(context, size, seed) for seed in sample.seeds(context)])
    goals = {"settlement_bridging_error": "-0.005 .. 0.005", "settlement_edge_error": "-0.01 .. 0.01",
             "stress_bridging_error": "<= 0.003", "overlap_stress_bridging_error": "<= 0.003"}
    yield from sample.mean_figures(context, packings, goals)
    yield context.figure("residual", max(rest), "", "<= 1e-6")
