"""The two smallest models: a chain of bonded grains, and one brick. Closed forms beside them."""

import math

RADIUS = 0.5           # m
STIFFNESS = 2.0e6      # N/m2, normal stiffness over radius
DENSITY = 2000.0       # kg/m3
GRAIN_MASS = DENSITY * 4.0 / 3.0 * math.pi * RADIUS**3
BOND_STIFFNESS = STIFFNESS * RADIUS / 2.0  # two equal grains in series, N/m

YOUNG, POISSON = 5.0e6, 0.25
SIDE = (2.0, 1.0, 1.0)  # m


def options(measure=0):
    return dict(gravity=[0, 0, 0], box_lo=[-10, -10, -10], box_hi=[10, 10, 10], periodic=[0, 0, 0],
                measure_energy=measure)


def set_up_chain(client, grains=2, measure=0):
    """Touching grains along x, bonded, that can neither rotate nor slide."""
    client.ask("OPTIONS", **options(measure))
    client.ask("GRAIN_MATERIALS", normal_stiffness=[STIFFNESS], shear_stiffness=[STIFFNESS], density=[DENSITY],
               friction=[math.inf], normal_strength=[math.inf], shear_strength=[math.inf], rolling_stiffness=[0.0],
               rolling_friction=[0.0], restitution=[1.0], rotation=[1])
    client.ask("GRAINS", position=[[2 * RADIUS * i, 0, 0] for i in range(grains)], radius=[RADIUS] * grains,
               material=[0] * grains)
    client.ask("CONTACT_OPTIONS", geometry="frozen", rotations=0, skin=0.0)
    return client.ask("BONDS", gap=1e-6)


LATTICE = 3                         # grains along a side
LATTICE_SIDE = 2 * RADIUS * LATTICE  # m


def set_up_lattice(client):
    """A simple cubic lattice of touching bonded grains, periodic in every direction."""
    client.ask("OPTIONS", **{**options(1), "box_lo": [0] * 3, "box_hi": [LATTICE_SIDE] * 3, "periodic": [1] * 3})
    client.ask("GRAIN_MATERIALS", normal_stiffness=[STIFFNESS], shear_stiffness=[0.3 * STIFFNESS], density=[DENSITY],
               friction=[math.inf], normal_strength=[math.inf], shear_strength=[math.inf], rolling_stiffness=[0.0],
               rolling_friction=[0.0], restitution=[1.0], rotation=[1])
    places = [[RADIUS * (1 + 2 * n) for n in (i, j, k)] for i in range(LATTICE) for j in range(LATTICE) for k in range(LATTICE)]
    client.ask("GRAINS", position=places, radius=[RADIUS] * len(places), material=[0] * len(places))
    client.ask("CONTACT_OPTIONS", geometry="updated", rotations=1, skin=0.0)
    client.ask("BONDS", gap=1e-6)
    return client.ask("PREPARE")


def stiffness_matrix():
    shear = YOUNG / (2 * (1 + POISSON))
    lame = YOUNG * POISSON / ((1 + POISSON) * (1 - 2 * POISSON))
    rows = [[0.0] * 6 for _ in range(6)]
    for i in range(3):
        for j in range(3):
            rows[i][j] = lame + (2 * shear if i == j else 0.0)
        rows[i + 3][i + 3] = shear
    return rows


P_MODULUS = stiffness_matrix()[0][0]
CORNERS = [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0, 0, 1], [1, 0, 1], [1, 1, 1], [0, 1, 1]]
BRICK_MASS = DENSITY * SIDE[0] * SIDE[1] * SIDE[2]


def face(axis, side):
    return [n for n, corner in enumerate(CORNERS) if corner[axis] == side]


def set_up_brick(client, measure=0):
    client.ask("OPTIONS", **options(measure))
    client.ask("SOLID_MATERIALS", stiffness=[stiffness_matrix()], density=[DENSITY])
    client.ask("MESH", nodes=[[c * s for c, s in zip(corner, SIDE)] for corner in CORNERS],
               elements=[list(range(8))], wrap=[[0] * 8], material=[0])


def fix(client, name, entities, components):
    client.ask("CONSTRAIN", name=name, entities=entities, components=components, direction=[0, 0, 0],
               history_kind="zero")
