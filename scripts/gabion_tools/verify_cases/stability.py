"""Undamped coupled runs at 0.98 of the smaller uncoupled stable step, for each choice of rows and floor of the weights.

Random motion excites every mode, the highest too: a step above the limit of the coupled system makes the energy grow
exponentially within a few hundred steps. Stable: the balance of energy, which explicit steps keep to round-off in a
linear system, stays within 1e-9 for 20 000 steps.
"""

import json
import math

import numpy as np

from gabion_tools import drawing

TITLE = "coupled runs at 0.98 of the uncoupled stable step, each choice of rows, weights' floor 0.01 and 0.001"

SCENES = {"lattice": "tiny_lattice", "random": "tiny"}
FRACTION = 0.98
STEPS = 20000
BRIDGING = {"mortar": {}, "mortar2h": {}, "strict": {}}
EDGE = {"edge": {}, "edge_projected": {}, "edge_hats": {"coupling.edge.reach": 1.25}}


def schemes():
    """(name, changes): every choice of rows, bridging with both floors."""
    for rows, more in BRIDGING.items():
        for floor in (0.01, 0.001):
            yield f"{rows}, floor {floor}", {"model": "bridging", "coupling.bridging.rows": rows,
                                             "coupling.bridging.weight_floor": floor, **more}
    for rows, more in EDGE.items():
        yield rows, {"model": "edge", "coupling.edge.rows": rows, **more}


def run(context):
    worst = 0.0
    for name, choice in schemes():
        for packing, scene in SCENES.items():
            result = context.run_scene(scene, {
                **choice, "grains.geometry": "frozen", "coupling.bridging.sponge": "null", "gravity": "null",
                "faces": "null", "probes": "[]", "initial": '{"noise": "1e-3 m/s"}', "run.step_fraction": FRACTION,
                "run.energy_tolerance": 1, "output": '{"monitor_steps": 200}',
                "stages": '[{"name": "shake", "damping": 0, "steps": %d}]' % STEPS})
            balance = result.history("energy", "balance")
            drift = float(np.ptp(balance) / result.summary["energy"]["largest"])
            worst = max(worst, drift)
            yield context.figure(f"energy drift at 0.98, {name}, {packing}", drift, "", "<= 1e-9")
    yield context.figure("stable_at_098_worst_drift", worst, "", "<= 1e-9")
    if context.full:
        yield from stability_map(context)


def stability_map(context):
    """Where the coupled step is really stable: bisection on columns and packings, see docs/hard_cases.md."""
    lines = context.json_lines("bench_stability", timeout=1800)
    context.root.mkdir(parents=True, exist_ok=True)
    written = context.root / "stability_map.jsonl"
    written.write_text("".join(json.dumps(line) + "\n" for line in lines), encoding="utf-8")
    drawing.call("stability_plot", written, written.with_suffix(".png"))
    for kind in ("overlap", "edge", "contrast", "random"):
        least = min(line["fraction"] for line in lines if line["map"] == kind)
        yield context.figure(f"least stable step over the uncoupled one, map {kind}", least, "", ">= 0.995")
    least = min(line["fraction"] * math.sqrt(1.0 + line["damping"]) for line in lines if line["map"] == "damping")
    yield context.figure("least stable step over the damped one, map damping", least, "", ">= 0.995")
