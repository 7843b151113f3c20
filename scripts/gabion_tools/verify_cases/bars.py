"""A bar with a fixed base under a half-sine on its head, in the four models, against the closed form of the wave equation.

The bar is a lattice column that repeats sideways (no lateral strain: modulus M = C11), its lower half mesh where the
model is coupled. Figures: error of the largest displacement at head and middle, for pulses of T c/L = 1, 2, 4, 8.
"""

import json
import math

import numpy as np

TITLE = "bar under a half-sine: peaks at head and middle of the four models against the closed form"

SCENE = "lattice_wave"
LENGTH, SIDE, ELEMENT = 8.0, 0.8, 0.4  # m; 20 elements, 56 diameters
STRESS = 1e4  # Pa
# displacement over s0 L/M; d'Alembert's solution with the pulse reflected at base and head
PEAKS = {1: (0.6366, 0.6366), 2: (1.2732, 0.9003), 4: (1.5738, 0.9321), 8: (1.2061, 0.6602)}
MODELS = ("dem", "continuum", "bridging", "edge")
OVERLAP = 8 * ELEMENT


def box(low, high):
    return [[0.0, 0.0, low], [SIDE, SIDE, high]]


def metres(corners):
    return json.dumps([[f"{v!r} m" for v in corner] for corner in corners])


def changes(model, pulse, duration):
    middle = 0.5 * LENGTH
    half_sine = {"amplitude": f"{STRESS!r} Pa", "start": "0 s", "duration": f"{pulse!r} s"}
    return {
        "model": model, "ground.box": metres(box(0.0, LENGTH)), "mesh.size": f"{ELEMENT!r} m",
        "coupling.bridging.zone": metres(box(middle - 0.5 * OVERLAP, LENGTH)), "coupling.bridging.overlap": f"{OVERLAP!r} m",
        "coupling.bridging.sponge.strength": 0, "coupling.edge.zone": metres(box(middle, LENGTH)),
        "faces": json.dumps({"zmin": "fixed", "zmax": {"pressure": {"half_sine": half_sine}}}), "initial": "{}",
        "stages": json.dumps([{"name": "pulse", "damping": 0, "duration": f"{duration!r} s"}]),
        "probes": json.dumps([{"name": name, "at": [f"{0.5 * SIDE!r} m", f"{0.5 * SIDE!r} m", f"{z!r} m"]}
                              for name, z in (("head", LENGTH), ("middle", middle))]),
        "output": '{"monitor_steps": 50}'}


def lattice_constants(context):
    """(M, c): of the packing as the program measures it."""
    look = context.run_scene(SCENE, changes("continuum", 1.0, 1e-4))
    elastic = look.summary["elasticity"]
    modulus = elastic["stiffness"][2][2]
    return modulus, math.sqrt(modulus / elastic["density"])


def run(context):
    modulus, speed = lattice_constants(context)
    scale = STRESS * LENGTH / modulus
    worst = dict.fromkeys(MODELS, 0.0)
    for ratio, expected in PEAKS.items():
        pulse = ratio * LENGTH / speed
        for model in MODELS:
            done = context.run_scene(SCENE, changes(model, pulse, pulse + 2 * LENGTH / speed))
            for place, closed in zip(("head", "middle"), expected):
                down = -done.history("probes", f"{place}.z") / scale
                error = float(np.max(down) / closed - 1)
                worst[model] = max(worst[model], abs(error))
                yield context.figure(f"{place}, T c/L = {ratio}, {model}", error, "", "report")
    for model in MODELS:
        yield context.figure(f"bar_worst_peak_error_{model}", worst[model], "", "<= 0.005" if model == "continuum" else "<= 0.01")
