"""Elements of several rates: energy, what the changes of rate reflect, and what is saved.

Scene two_rates: a corner of grains in much mesh, rates 1, 2, 4, 8 in layers of 6 elements. A transit is the time that a
P wave takes through the ground. Excursion: largest less smallest energy balance over the largest energy; drift: the
balance's straight-line change over the run over the same. "with the swing": of balance + rate_swing, what waves in coarser
elements hold beyond kinetic + elastic energy to second order (docs/theory.md); no such order exists for motion at the mesh's limit. Reflection: a packet runs down a column of the same lattice into
the mesh and through the changes of rate, with several rates and with one; kinetic energy of the difference in the grains,
before the changes, over the incident energy.
"""

import json
import math

import numpy as np

TITLE = "several rates in the continuum: energy, reflection at the changes, speed"

SCENE = "two_rates"
ELEMENT, OVERLAP = 0.4, 8      # m; elements
LARGEST, LAYERS, FIRST = 8, 6, 2
PACKET, SIGMAS = 1.5, 3.0      # standard deviation over wavelength, half length of the packet in standard deviations
SIDE = 2 * ELEMENT
NESTED = {"largest": LARGEST}
AT_ONCE = {"largest": LARGEST, "nested": False}
FRACTIONS = (0.5, 0.54, 0.58, 0.62, 0.66, 0.7, 0.75, 0.8, 0.85, 0.9, 0.93, 0.96, 0.995)
# packets that fill a third of the ground, 15 and 10 elements a wavelength, and motion at all wavelengths
WAVE = {"axis": "z", "polarisation": "z", "wavelength": "6 m", "centre": "9.6 m", "width": "3 m", "amplitude": "1 um", "sense": "-"}
SHORTER = {**WAVE, "wavelength": "4 m"}
NOISE = {"noise": "1e-3 m/s"}


def p_speed(summary):
    elastic = summary["elasticity"]
    return math.sqrt(elastic["stiffness"][2][2] / elastic["density"])


def shaken(context, initial, transits, **changes):
    """The run, and the drift of its balance without and with the swing."""
    first = context.run_scene(SCENE, stages(8))
    length = 19.2
    steps = transits * length / p_speed(first.summary) / first.summary["step"]["dt"]
    whole = 8 * math.ceil(steps / 8)
    result = context.run_scene(SCENE, {**stages(whole), "initial": json.dumps(initial), "output": '{"monitor_steps": 80}',
                                       "mesh.rates.energy_tolerance": 1, **changes})
    time, balance = result.history("energy", "time"), result.history("energy", "balance")
    drift = lambda values: abs(np.polyfit(time, values, 1)[0]) * float(np.ptp(time)) / result.summary["energy"]["largest"]  # noqa: E731
    return result, (drift(balance), drift(balance + result.history("energy", "continuum rate_swing")))


def stages(steps):
    return {"stages": json.dumps([{"name": "free", "damping": 0, "steps": steps}])}


def column(context, elements, rates):
    """The last and first state of the grains of a packet of so many elements wavelength."""
    wavelength = elements * ELEMENT
    sigma, overlap = PACKET * wavelength, OVERLAP * ELEMENT
    to_last_change = (FIRST + LAYERS * (int(math.log2(LARGEST)) - 1)) * ELEMENT
    start = overlap + SIGMAS * sigma
    path = 2 * (start + to_last_change)  # there and back
    up, down = ELEMENT * math.ceil((start + SIGMAS * sigma) / ELEMENT), ELEMENT * math.ceil((path - start + SIGMAS * sigma) / ELEMENT)
    box = lambda low: json.dumps([["0 m", "0 m", f"{low!r} m"], [f"{SIDE!r} m", f"{SIDE!r} m", f"{up!r} m"]])  # noqa: E731
    wave = {**WAVE, "wavelength": f"{wavelength!r} m", "centre": f"{start!r} m", "width": f"{sigma!r} m"}
    whole = context.run_scene(SCENE, stages(8)).summary
    steps = 8 * math.ceil(path / p_speed(whole) / whole["step"]["dt"] / 8)
    return context.run_scene(SCENE, {
        "ground.box": box(-down), "ground.periodic": '["x", "y"]', "coupling.bridging.zone": box(0.0), "coupling.bridging.overlap": f"{overlap!r} m",
        "coupling.edge": "null", "faces": "null", "initial": json.dumps({"wave": wave}),
        "mesh.rates": json.dumps(rates and {**rates, "energy_tolerance": 1}),
        "run.step": f"{whole['step']['dt']!r} s", **stages(steps)})


def reflected(context, elements, rates):
    several, one = column(context, elements, rates), column(context, elements, None)
    last, other, first = several.state("grains", -1), one.state("grains", -1), one.state("grains", 0)
    above = last["position"][:, 2] > (OVERLAP + 0.5) * ELEMENT
    energy = lambda v: float((v ** 2).sum())  # noqa: E731
    return energy(last["velocity"][above] - other["velocity"][above]) / energy(first["velocity"])


def kept(context, run, drifts, words):
    rates = run.summary["rates"]
    yield context.figure(f"energy_excursion{words}", rates["energy_excursion"], "", "<= 0.01")
    yield context.figure(f"energy_drift{words}", drifts[0], "", "<= 0.001")
    yield context.figure(f"energy_excursion with the swing{words}", rates["energy_excursion_with_swing"], "", "<= 0.01")
    yield context.figure(f"energy_drift with the swing{words}", drifts[1], "", "<= 0.001")


def run(context):
    result, drifts = shaken(context, {"wave": WAVE}, 50)
    sizes = result.summary["sizes"]
    yield context.figure("elements_per_grain", sizes["elements"] / sizes["grains"], "", ">= 50")
    yield from kept(context, result, drifts, "")
    yield from kept(context, *shaken(context, {"wave": SHORTER}, 50), ", 10 elements a wavelength")
    for fraction in FRACTIONS if context.full else (0.8,):
        shorter, drifts = shaken(context, {"wave": SHORTER}, 50, **{"run.step_fraction": fraction})
        yield from kept(context, shorter, drifts, f", 10 elements a wavelength, {fraction} of the grains' limit")
    noisy, (drift, _) = shaken(context, NOISE, 50 if context.full else 10)
    yield context.figure("energy_excursion, random motion", noisy.summary["rates"]["energy_excursion"], "", "<= 0.01")
    yield context.figure("energy_drift, random motion", drift, "", "<= 0.001")
    for elements in (8, 6, 4):
        yield context.figure(f"reflection_{elements}h", reflected(context, elements, NESTED), "", "<= 0.002")
    for elements in (8, 6, 4):
        yield context.figure(f"reflection_{elements}h, not nested", reflected(context, elements, AT_ONCE), "", "report")
    yield from speed(context, sizes)
    if context.full:
        worst = 0.0
        for fraction in FRACTIONS:
            result, _ = shaken(context, NOISE, 5, **{"run.step_fraction": fraction})
            worst = max(worst, result.summary["rates"]["energy_excursion"])
            yield context.figure(f"energy_excursion at {fraction} of the grains' limit, random motion",
                                 result.summary["rates"]["energy_excursion"], "", "<= 0.013")
        yield context.figure("energy_excursion_steps_worst", worst, "", "<= 0.013")


def speed(context, sizes):
    """Evaluations of elements and wall time, of the whole run and of the continuum alone."""
    steps = 400
    timed = {name: context.run_scene(SCENE, {**stages(steps), "mesh.rates": json.dumps(rates), "output": '{"monitor_steps": 400}'}, threads=1)
             for name, rates in (("one", None), ("several", NESTED))}
    count = {name: run.summary["sizes"]["element_steps"] for name, run in timed.items()}
    wall = {name: run.summary["wall"]["stepping"] for name, run in timed.items()}
    yield context.figure("counts_speedup", count["one"] / count["several"], "", "> 1")
    alone = context.json_lines("bench_continuum", "rates", round(sizes["elements"] ** (1 / 3)), 40)[0]
    yield context.figure("wall_speedup of the continuum alone", alone["wall_speedup"], "", "> 1")
    yield context.figure("wall_speedup of the run", wall["one"] / wall["several"], "", "> 1")
