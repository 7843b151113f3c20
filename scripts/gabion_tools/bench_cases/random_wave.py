"""A wave packet through the interface of a random column."""

from gabion_tools.bench_cases import lattice_wave
from gabion_tools.verify_cases.reflection import SCHEMES, SPONGE
from gabion_tools.wave_columns import Column

TITLE = "Wave packet of 3 m through the interface of a random packing (30 diameters)"
REFERENCE = "all grains of the same packing, subtracted"
ERROR = lattice_wave.ERROR + "; a random packing scatters a part of the wave back from beyond the interface, which no mesh can return"
KERNELS = "frozen"
UNIT, WAVE, SIDE = 0.5, 3.0, 1.0


def column(seed=None, overlap=4.0, element=0.5):
    """overlap: m."""
    return Column("random_wave", element, WAVE, unit=UNIT, side=SIDE, overlap=overlap / element, packet=1.0, changes={"grains.seed": seed})


def seeds(context):
    if context.seed is not None:
        return (context.seed,)
    return (1, 2, 3) if context.full else (1,)


def jobs(context):
    columns = lambda **how: [column(seed=seed, **how) for seed in seeds(context)]  # noqa: E731
    measure = lambda scheme, **how: lattice_wave.measure(context, columns(**how), scheme)  # noqa: E731

    yield {"label": "all grains", "knob": "reference", "reference": True, "measure": lambda: lattice_wave.whole(context, columns())}
    for overlap in (0.5, 1.0, 2.0, 4.0):
        yield {"label": f"mortar with sponge, overlap {overlap / 0.5:.0f} h", "knob": "overlap", "measure": lambda overlap=overlap: measure(SCHEMES[SPONGE], overlap=overlap)}
    for element in (0.25, 1.0):
        yield {"label": f"mortar with sponge, h = {element / 0.1:.1f} d, overlap 4 m", "knob": "mesh", "measure": lambda element=element: measure(SCHEMES[SPONGE], element=element)}
    for scheme in ("mortar", "mortar2h", "strict", "row_sum", "edge", "edge_hats"):
        yield {"label": f"{scheme}, overlap 8 h" if "edge" not in scheme else scheme, "knob": "rows", "measure": lambda scheme=scheme: measure(SCHEMES[scheme])}
