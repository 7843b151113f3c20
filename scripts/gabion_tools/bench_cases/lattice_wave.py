"""A wave packet through the interface of a lattice column."""

import math

from gabion_tools.verify_cases.reflection import SCHEMES, SPONGE
from gabion_tools.wave_columns import Column

TITLE = "Wave packet of 2.4 m through the interface of a lattice (6 elements of 0.4 m)"
REFERENCE = "all grains of the same column; on a lattice it has no scatter, and its transmission is within 0.3 % of the closed form's 1"
ERROR = "amplitudes: root of the reflected energy over the incident, and root of the transmitted over that of all grains, less 1; the worse counts"
KERNELS = "frozen"
ELEMENT, WAVE = 0.4, 2.4  # m


def column(overlap=8):
    """overlap: elements."""
    return Column("lattice_wave", ELEMENT, WAVE, unit=ELEMENT, side=ELEMENT, overlap=overlap)


def measure(context, columns, scheme):
    """(runs, parts) of columns, one a packing."""
    runs, parts = [], {"reflected": [], "transmitted": []}
    for one in columns:
        reflected, through, whole = one.measure(context, scheme)
        runs.append(one.run(context, scheme))
        parts["reflected"].append(math.sqrt(reflected))
        parts["transmitted"].append(math.sqrt(through / whole) - 1)
    return runs, parts


def whole(context, columns):
    """The all-grain columns that the coupled ones are measured against."""
    runs = [one.run(context, {"model": "dem"}) for one in columns]
    return runs, {"reflected": [0.0] * len(runs), "transmitted": [0.0] * len(runs)}


def jobs(context):
    yield {"label": "all grains", "knob": "reference", "reference": True, "measure": lambda: whole(context, [column()])}
    for overlap in (1, 2, 4, 8, 12):
        for scheme in (SPONGE, "mortar"):
            yield {"label": f"{scheme}, overlap {overlap} h", "knob": "overlap",
                   "measure": lambda overlap=overlap, scheme=scheme: measure(context, [column(overlap)], SCHEMES[scheme])}
    for scheme in ("mortar2h", "strict", "row_sum", "edge", "edge_hats"):
        yield {"label": f"{scheme}, overlap 8 h" if "edge" not in scheme else scheme, "knob": "rows",
               "measure": lambda scheme=scheme: measure(context, [column()], SCHEMES[scheme])}
    for strength in (6.4, 102.4):
        yield {"label": f"mortar, sponge of {strength}, overlap 8 h", "knob": "sponge",
               "measure": lambda strength=strength: measure(context, [column()], {"model": "bridging", "coupling.bridging.sponge.strength": strength})}
    yield {"label": "mortar with sponge, overlap 8 h, rates up to 4", "knob": "rates",
           "measure": lambda: measure(context, [column()], {**SCHEMES[SPONGE], "mesh.rates": {"largest": 4}})}
    yield {"label": "mortar with sponge, floor 0.1", "knob": "weights",
           "measure": lambda: measure(context, [column()], {**SCHEMES[SPONGE], "coupling.bridging.weight_floor": 0.1})}
