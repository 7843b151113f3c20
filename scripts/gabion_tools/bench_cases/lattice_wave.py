"""A wave packet through the interface of a lattice column."""

import math

from gabion_tools.verify_cases.reflection import SCHEMES, SPONGE
from gabion_tools.wave_columns import Column

TITLE = "Wave packet of 2.4 m through the interface of a lattice (6 elements of 0.4 m)"
REFERENCE = "all grains of the same column; on a lattice it has no scatter, and its transmission is within 0.3 % of the closed form's 1"
ERROR = "amplitudes: root of the reflected energy over the incident, and root of the transmitted over that of all grains, less 1; the worse counts"
KERNELS = "frozen"
SCENE, UNIT, WAVE, SEEDS = "lattice_wave", 0.4, 2.4, (None,)


def column(overlap=8, element=0.4, changes=None, seed=None):
    return Column(SCENE, element, WAVE, unit=UNIT, side=0.4, overlap=overlap, changes=changes)


def measure(context, scheme, make=None, **how):
    runs, parts = [], {"reflected": [], "transmitted": []}
    for seed in SEEDS:
        one = (make or column)(seed=seed, **how)
        reflected, through, whole = one.measure(context, scheme)
        runs.append(one.run(context, scheme))
        parts["reflected"].append(math.sqrt(reflected))
        parts["transmitted"].append(math.sqrt(through / whole) - 1)
    return runs, parts


def whole(context, make=None):
    """The all-grain column that the coupled ones are measured against."""
    runs = [(make or column)(seed=seed).run(context, {"model": "dem"}) for seed in SEEDS]
    return runs, {"reflected": [0.0] * len(runs), "transmitted": [0.0] * len(runs)}


def jobs(context):
    yield {"label": "all grains", "knob": "reference", "reference": True, "measure": lambda: whole(context)}
    for overlap in (2, 4, 8, 12):
        for scheme in (SPONGE, "mortar"):
            yield {"label": f"{scheme}, overlap {overlap} h", "knob": "overlap",
                   "measure": lambda overlap=overlap, scheme=scheme: measure(context, SCHEMES[scheme], overlap=overlap)}
    for scheme in ("mortar2h", "strict", "row_sum", "edge", "edge_hats"):
        yield {"label": f"{scheme}, overlap 8 h" if "edge" not in scheme else scheme, "knob": "rows",
               "measure": lambda scheme=scheme: measure(context, SCHEMES[scheme])}
    yield {"label": "mortar with sponge, floor 0.1", "knob": "weights",
           "measure": lambda: measure(context, {**SCHEMES[SPONGE], "coupling.bridging.weight_floor": 0.1})}
