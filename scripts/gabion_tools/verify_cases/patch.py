"""Uniform strain and rigid motion of the whole coupled body: forces that must not appear.

Ghost force on a lattice: one step from rest under uniform strain; rms of the force that is left on the grains,
multipliers included (mass * velocity / dt), over the rms force of a bond. Grains within two diameters of the column's
ends, where the strain is not held, are left out.

On a random packing a uniform strain is no equilibrium, with or without an interface. There the strained column is
brought to rest in both models, ends held, and its bond forces are compared with those of the all-grain column: rms of
the difference over the rms force, beyond the interface (ghost_force_random) and within it, each force divided by the
weight of its contact.
"""

import json
import math

import numpy as np

TITLE = "uniform strain through the overlap, rigid translation and rotation"

LATTICE = {"fcc": "0.0707106781186548 m", "sc": "0.05 m"}
SCHEMES = {"mortar": {"model": "bridging"}, "edge": {"model": "edge"},
           "strict": {"model": "bridging", "coupling.bridging.rows": "strict"},
           "mortar2h": {"model": "bridging", "coupling.bridging.rows": "mortar2h"}}
# uniaxial along the column, and shears across it: all that a periodic column can carry
STRAIN = [0, 0, 1e-5, 0, 0, 0]


def one_step(context, scene, choice, initial, more=None):
    return context.run_scene(scene, {
        **choice, "grains.geometry": "frozen", "faces": "null", "probes": "[]", "gravity": "null",
        "stages": '[{"name": "look", "damping": 0, "steps": 1}]', "initial": json.dumps(initial),
        "output": '{"monitor_steps": 1}', **(more or {})})


def left_over(result, axis=2):
    """rms of the force left on grains and nodes away from the ends, N."""
    dt = result.summary["step"]["dt"]
    grains = result.state("grains", -1)
    ends = 4 * grains["radius"].max()
    everything = [grains["position"]] + ([result.state("mesh", -1)["nodes"]] if "mesh" in result.summary.get("media", ["mesh"]) else [])
    low = min(p[:, axis].min() for p in everything) + ends
    high = max(p[:, axis].max() for p in everything) - ends
    inside = (grains["position"][:, axis] > low) & (grains["position"][:, axis] < high)
    mass = 2650 * 4 / 3 * math.pi * grains["radius"] ** 3 * np.maximum(grains["weight"], 0)
    force = mass[inside, None] * grains["velocity"][inside] / dt
    return math.sqrt((force ** 2).sum(axis=1).mean())


def bond_force(result, strain=1e-5):
    """A bond's force under the strain: stress times area per bond, (M strain) d^2, of the order of the true rms, N."""
    modulus = result.summary["elasticity"]["stiffness"][2][2]
    return modulus * strain * result.summary["packing"]["mean_diameter"] ** 2


RANDOM = "column"  # the scene of the gravity column, here without gravity
LEAST_WEIGHT = 0.1  # below, a bond's force is that of the mesh divided by next to nothing


def strained_column(context, choice):
    """A column at rest after a uniform strain along it, ends held."""
    return context.run_scene(RANDOM, {
        **choice, "gravity": "null", "initial": json.dumps({"strain": STRAIN}), "faces": '{"zmin": "fixed", "zmax": "fixed"}',
        "probes": "[]", "run.measure_energy": False, "output": '{"monitor_steps": 100, "fields": ["contact_force"]}',
        "stages": '[{"name": "rest", "damping": 0.69, "until": {"unbalanced": 1e-6}, "max_steps": 100000}]'})


def bond_forces(run):
    """{(grain, grain): (force, N, height of the contact, m)}, grains by their number in the packing."""
    grains, contacts = run.state("grains"), run.state("contacts")
    pairs, names = contacts["grains"], grains["origin_id"]
    forces = {}
    for (i, j), normal, force in zip(pairs, contacts["normal"], contacts["force"]):
        a, b = names[i], names[j]
        height = grains["position"][i, 2] + grains["radius"][i] * normal[2]
        forces[(min(a, b), max(a, b))] = (force if a < b else -force, height)
    return forces


def bond_weight(zone, overlap, height):
    return min(1.0, max(0.01, (height - zone) / overlap))


def random_packing(context):
    reference = bond_forces(strained_column(context, {"model": "dem"}))
    scale = math.sqrt(np.mean([force @ force for force, _ in reference.values()]))
    for scheme, choice in SCHEMES.items():
        run = strained_column(context, choice)
        scene = json.loads((run.folder / "scene.effective.json").read_text(encoding="utf-8"))
        low = float(scene["coupling"]["zone"][0][2].split()[0])
        width = float(scene["coupling"].get("overlap", "0 m").split()[0]) if run.model == "bridging" else 0.0
        inside, beyond = [], []
        for bond, (force, height) in bond_forces(run).items():
            if bond not in reference:
                continue
            if height > low + width + 2 * run.summary["packing"]["mean_diameter"]:
                beyond.append(force - reference[bond][0])
            elif width > 0 and low < height < low + width and bond_weight(low, width, height) > LEAST_WEIGHT:
                inside.append(force / bond_weight(low, width, height) - reference[bond][0])
        rms = lambda forces: math.sqrt(np.mean([force @ force for force in forces])) / scale  # noqa: E731
        name = "ghost_force_random" if scheme == "mortar" else f"bond forces beyond the interface, random, {scheme}"
        yield context.figure(name, rms(beyond), "", "report")
        if inside:
            yield context.figure(f"bond forces in the overlap, random, {scheme}", rms(inside), "", "report")


def run(context):
    worst = 0.0
    for packing, radius in LATTICE.items():
        for scheme, choice in SCHEMES.items():
            more = {"grains.packing": packing, "grains.radius": radius}
            if scheme == "edge" and packing == "sc":
                more["coupling.edge.reach"] = 1.01  # planes are 2 r apart
            result = one_step(context, "lattice_patch", choice, {"strain": STRAIN}, more)
            ghost = left_over(result) / bond_force(result)
            if scheme in ("mortar", "edge"):
                worst = max(worst, ghost)
            yield context.figure(f"ghost force, {packing}, {scheme}, planes on the lattice", ghost, "", "report")
    yield context.figure("ghost_force_lattice", worst, "", "<= 1e-10")
    off = one_step(context, "lattice_patch", SCHEMES["mortar"], {"strain": STRAIN}, {
        "coupling.bridging.zone": '[["0 m", "0 m", "0 m"], ["0.8 m", "0.8 m", "4.03 m"]]'})
    yield context.figure("ghost force, fcc, mortar, planes off the lattice", left_over(off) / bond_force(off), "", "report")
    yield from random_packing(context)

    turned = 0.0
    for scheme in ("mortar", "edge"):
        for motion in ({"rotation": [3e-6, -2e-6, 1e-6]}, {"translation": ["1 um", "2 um", "-1 um"]}):
            result = one_step(context, "lattice_patch", SCHEMES[scheme], motion, {
                "ground.periodic": "[]", "ground.box": '[["0 m", "0 m", "0 m"], ["0.8 m", "0.8 m", "6.4 m"]]'})
            stress = np.abs(result.state("mesh", -1)["stress"]).max()
            force = left_over(result) / bond_force(result)
            modulus = result.summary["elasticity"]["stiffness"][2][2]
            turned = max(turned, force, stress / (modulus * 1e-5))
    yield context.figure("rigid_rotation_stress", turned, "", "<= 1e-10")
