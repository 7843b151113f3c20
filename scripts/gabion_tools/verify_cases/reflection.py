"""What an interface reflects and lets through, on a lattice column and on random columns minus their all-grain runs."""

import numpy as np

from gabion_tools.wave_columns import Column

TITLE = "reflection and transmission of waves, lattice and random columns"

SPONGE = "mortar with sponge"
SCHEMES = {
    SPONGE: {"model": "bridging"},
    "mortar": {"model": "bridging", "coupling.bridging.sponge.strength": 0},
    "mortar2h": {"model": "bridging", "coupling.bridging.rows": "mortar2h", "coupling.bridging.sponge.strength": 0},
    "strict": {"model": "bridging", "coupling.bridging.rows": "strict", "coupling.bridging.sponge.strength": 0},
    "row_sum": {"model": "bridging", "coupling.bridging.rows": "strict", "coupling.bridging.solve": "row_sum",
                "coupling.bridging.sponge.strength": 0, "run.energy_tolerance": 1},
    "edge": {"model": "edge"},
    "edge_hats": {"model": "edge", "coupling.edge.rows": "edge_hats", "coupling.edge.reach": 1.25},
}


def lattice(context, scheme, elements):
    """FCC lattice of cells of 0.2 m, h = 2 cells = 2.83 d, overlap of 8 h."""
    column = Column("lattice_wave", 0.4, elements * 0.4, unit=0.4, side=0.4)
    return column.measure(context, SCHEMES[scheme])


def random(context, scheme, elements, seed):
    """Random packing, h = 5 d, 10 d wide, overlap of 8 h."""
    column = Column("random_wave", 0.5, elements * 0.5, unit=0.5, side=1.0, packet=1.0,
                    changes={"grains.seed": seed} if context.seed is None else {})
    return column.measure(context, SCHEMES[scheme])


def run(context):
    lengths = (10, 6, 5, 4, 3, 2)
    worst = 0.0
    for scheme in SCHEMES if context.full else (SPONGE, "mortar", "strict", "edge"):
        for elements in lengths if context.full or scheme == SPONGE else (6, 4):
            r, t, dem = lattice(context, scheme, elements)
            if scheme == SPONGE:
                worst = max(worst, r)
            if scheme == SPONGE and elements == 6:
                yield context.figure("lattice_6h", r, "", "<= 0.0003")
                yield context.figure("lattice_transmission_6h", t, "", ">= 0.95")
            yield context.figure(f"R lattice, {scheme}, {elements}h", r, "", "report")
            yield context.figure(f"T lattice, {scheme}, {elements}h (all grains {dem:.3f})", t, "", "report")
    yield context.figure("lattice_worst_with_sponge", worst, "", "report")

    mean = {}
    for elements in (8, 6, 5, 4, 3) if context.full else (6, 4, 3):
        figures = [random(context, SPONGE, elements, seed) for seed in ((1, 2, 3) if context.full else (1,))]
        mean[elements] = np.mean(figures, axis=0)
        yield context.figure(f"R random, {SPONGE}, {elements}h", mean[elements][0], "", "report")
        yield context.figure(f"T random, {SPONGE}, {elements}h (all grains {mean[elements][2]:.3f})", mean[elements][1],
                             "", "report")
    yield context.figure("random_6h", mean[6][0], "", "<= 0.012")
    yield context.figure("random_transmission_6h_minus_dem", mean[6][1] - mean[6][2], "", "-0.05 .. 0.05")
    yield context.figure("random_worst_with_sponge", max(m[0] for m in mean.values()), "", "<= 0.035")
