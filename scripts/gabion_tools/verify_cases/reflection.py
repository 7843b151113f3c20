"""What an interface reflects and lets through, on a lattice column and on random columns minus their all-grain runs."""

import numpy as np

from gabion_tools.places import BUILD
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


PICTURE = BUILD / "reflection.png"


def draw(lattice_figures, random_figures):
    """R and T over the wavelength, one curve a choice of rows. {(scheme, elements): (R, T, all-grain T)}."""
    from gabion_tools.style import plt
    picture, panels = plt.subplots(2, 2, figsize=(9.0, 6.6), sharex="col")
    for column, (title, figures) in enumerate((("FCC lattice, h = 2.83 d", lattice_figures),
                                               ("random packing, h = 5 d", random_figures))):
        for scheme in dict.fromkeys(name for name, _ in figures):
            points = sorted((elements, values) for (name, elements), values in figures.items() if name == scheme)
            length = [elements for elements, _ in points]
            for panel, which in zip(panels[:, column], (0, 1)):
                panel.plot(length, [values[which] for _, values in points], "o-", ms=4, lw=1.2, label=scheme)
        if random_figures and column:
            whole = sorted((elements, values[2]) for (name, elements), values in figures.items() if name == SPONGE)
            panels[1, 1].plot(*zip(*whole), "k--", lw=1.0, label="all grains")
        panels[0, column].set(title=title, yscale="log", ylabel="reflected energy R")
        panels[1, column].set(xlabel="wavelength over element size", ylabel="transmitted energy T", ylim=(0, 1.05))
        panels[1, column].legend()
    PICTURE.parent.mkdir(exist_ok=True)
    picture.savefig(PICTURE)
    plt.close(picture)


def run(context):
    lengths = (10, 6, 5, 4, 3, 2)
    worst = 0.0
    drawn = {}
    for scheme in SCHEMES if context.full else (SPONGE, "mortar", "strict", "edge"):
        for elements in lengths if context.full or scheme == SPONGE else (6, 4):
            r, t, dem = lattice(context, scheme, elements)
            drawn[scheme, elements] = r, t, dem
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
    if context.full:
        drawn_random = {(SPONGE, elements): values for elements, values in mean.items()}
        for scheme in (name for name in SCHEMES if name != SPONGE):
            for elements in (6, 5, 4, 3):
                drawn_random[scheme, elements] = r, t, dem = random(context, scheme, elements, 1)
                yield context.figure(f"R random, {scheme}, {elements}h, one packing", r, "", "report")
                yield context.figure(f"T random, {scheme}, {elements}h, one packing (all grains {dem:.3f})", t, "", "report")
        draw(drawn, drawn_random)
    yield context.figure("random_6h", mean[6][0], "", "<= 0.012")
    yield context.figure("random_transmission_6h_minus_dem", mean[6][1] - mean[6][2], "", "-0.05 .. 0.05")
    yield context.figure("random_worst_with_sponge", max(m[0] for m in mean.values()), "", "<= 0.035")
