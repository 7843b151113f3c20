"""The field experiment of Pichler et al. 2005: a 10-tonne cube on its tip at 13 m/s, penetration 0.51 m.

Gravel calibrated from statics alone (scenarios/materials/gravel_*.json): E 196 MPa and nu 0.36 of the study, friction
angle of a compacted well-graded gravel, reached by one of three mechanisms; restitution from the literature. Nothing is
fitted to the impact. Short: the first mechanism alone; --full: all three, the study's own gravel, other restitutions. The
experiment's force, 3.5 MN, is that of a linear law through its penetration, and its stop at
61 ms and S = 2 follow from the same law: those two are shown for comparison only.
"""

import json
import re

from gabion_tools.places import SCENARIOS

TITLE = "the field experiment predicted from static tests of the gravel, three mechanisms"

SCENE = "impact"
MECHANISMS = ("rolling", "locked", "clumps")
FIRST = MECHANISMS[0]  # whose figures carry the plain names
TRENCH = '[["-2 m","-2 m","-2 m"],["2 m","2 m","0 m"]]'
GOALS = {"penetration": "0.51 +- 0.051", "max_force": "3.5e+06 +- 5.25e+05"}
FIGURES = {"penetration": ("penetration_end", "m"), "max_force": ("largest_force_4ms", "N"), "stop_time": ("time_to_first_stop", "s"),
           "S": ("S", "")}


def figures(context, mechanism, material, changes=()):
    done = context.run_scene(SCENE, {"fills": f'[{{"box": {TRENCH}, "material": "{material}"}}]', "output.every": "0.4 s",
                                     **dict(changes)})
    block = done.summary["figures"]["block"]
    for name, (key, unit) in FIGURES.items():
        label = name if mechanism == FIRST else f"{name}_{mechanism}"
        yield context.figure(label, block.get(key), unit, GOALS.get(name, "report"))
    label = "energy_balance" if mechanism == FIRST else f"energy_balance_{mechanism}"
    yield context.figure(label, done.summary["energy"]["balance_error"], "", "<= 0.001")


def run(context):
    for mechanism in MECHANISMS if context.full else (FIRST,):
        yield from figures(context, mechanism, f"gravel_{mechanism}")
    if not context.full:
        return
    yield from figures(context, "study", "seed_gravel")
    for restitution in (0.3, 0.7):
        for mechanism in MECHANISMS:
            material = f"gravel_{mechanism}"
            yield from figures(context, f"{mechanism}_restitution_{restitution}", "gravel",
                               {"materials": varied(material, restitution=restitution)}.items())


def varied(material, **changes):
    """Materials of the scene: 'gravel', a built-in one with other values."""
    text = (SCENARIOS / "materials" / f"{material}.json").read_text(encoding="utf-8")
    values = json.loads(re.sub(r"^\s*//.*$", "", text, flags=re.M))
    return json.dumps({"gravel": {**values, **changes}})
