"""The rock on the gravel trench: bridging and edge against all grains of the same packing.

Coarse grains, mean diameter 0.3 m: enough to compare models on the same packing, too coarse for the impact itself.
Short: one packing, 60 ms. --full: to rest, over several packings, mean ratio with its standard error; a figure whose
standard error is above the tolerance is undecided, with the number of packings that would decide it.
"""

import numpy as np

from gabion_tools import sample_measure as sample

TITLE = "rock on a gravel trench: force and penetration of the coupled models against all grains"

SCENE = "impact"
PACKINGS = 8
TOLERANCE = 0.03
GOAL = f"-{TOLERANCE} .. {TOLERANCE}"
COUPLED = ("bridging", "edge")
COARSE = {"grains.radius": {"uniform": ["0.1 m", "0.2 m"]}, "mesh.size": "0.75 m"}
SHORT = {**COARSE, "stages[1].duration": "62 ms", "output.every": "62 ms"}
LONG = {**COARSE, "output.every": "0.4 s"}
FIGURES = {"force": "largest_force_4ms", "penetration": "penetration_60ms", "impulse": "impulse_60ms"}
FINAL = {"penetration_end": "penetration_end", "time_to_stop": "time_to_stop", "impulse_to_stop": "impulse_to_stop"}


def one_packing(context, seed, changes, figures):
    """{figure: ratio to all grains - 1}, all grains' own figures, and the energy balances."""
    runs = {model: context.run_scene(SCENE, {**changes, "model": model, "grains.seed": seed}) for model in ("dem", *COUPLED)}
    block = {model: run.summary["figures"]["block"] for model, run in runs.items()}
    ratios = {f"{name}_{model}_over_dem": block[model][key] / block["dem"][key] - 1
              for name, key in figures.items() for model in COUPLED}
    own = {f"{key}_dem": block["dem"][key] for key in figures.values()}
    return ratios, own, max(run.summary["energy"]["balance_error"] for run in runs.values())


def run(context):
    figures = {**FIGURES, **FINAL} if context.full else FIGURES
    seeds = range(1, PACKINGS + 1) if context.full and context.seed is None else sample.seeds(context)[:1]
    ratios, own, balances = zip(*[one_packing(context, seed, LONG if context.full else SHORT, figures) for seed in seeds])
    for name in ratios[0]:
        values = np.array([one[name] for one in ratios])
        goal = GOAL if name.startswith(("force", "penetration")) or context.full else "report"
        yield context.figure(name, values.mean(), "", goal)
        if len(values) > 1:
            error = values.std(ddof=1) / np.sqrt(len(values))
            yield context.figure(f"{name}_standard_error", error, "", f"<= {TOLERANCE}")
            yield context.figure(f"{name}_packings_needed", int(np.ceil((values.std(ddof=1) / TOLERANCE) ** 2)), "", "report")
    for name in own[0]:
        values = np.array([one[name] for one in own])
        yield context.figure(name, values.mean(), "", "report")
        if len(values) > 1:
            yield context.figure(f"{name}_scatter", values.std(ddof=1) / abs(values.mean()), "", "report")
    yield context.figure("energy_balance", max(balances), "", "<= 0.001")
