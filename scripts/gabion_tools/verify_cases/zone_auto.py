"""coupling.zone = auto on impacts of 5, 13 and 25 m/s: error against all grains, size against the hand-chosen zone, verdicts.

Coarse grains, 60 ms. Verdict: what summary.json says under "zone". A zone made too small on purpose ends inside the gravel
and must be flagged at every speed.
"""

import math

import numpy as np

from gabion_tools import zone_size
from gabion_tools.bench_cases import impact
from gabion_tools.sample_measure import effective

TITLE = "zone = auto: error, size and verdict on impacts of 5, 13 and 25 m/s"

SPEEDS = (5, 13, 25)
HAND = zone_size.box(impact.box(4.5))
TOO_SMALL = impact.bridging(2.5, overlap=1.5)
TARGET = 0.03


def volume(run):
    return zone_size.volume(zone_size.box(effective(run)["coupling"]["zone"]))


def seeds(context):
    if context.seed is not None:
        return (context.seed,)
    return range(1, 9) if context.full else (1, 2)


def run(context):
    flagged = []
    for speed in SPEEDS:
        change = {"block.velocity": f"{speed} m/s"}
        parts, sizes, verdicts = {name: [] for name in impact.PARTS}, [], []
        for seed in seeds(context):
            _, whole = impact.block(context, seed, {**change, "model": "dem"})
            auto, found = impact.block(context, seed, {**change, "model": "bridging", "coupling.bridging.zone": "auto"})
            for name, key in impact.PARTS.items():
                parts[name].append(found[key] / whole[key] - 1)
            sizes.append(volume(auto))
            verdicts.append(auto.summary["zone"]["large_enough"])
            small, _ = impact.block(context, seed, {**change, **TOO_SMALL})
            flagged.append(not small.summary["zone"]["large_enough"])
        for name, values in parts.items():
            yield context.figure(f"{name}_error_auto_{speed}", float(np.mean(values)), "", f"-{TARGET} .. {TARGET}")
            if len(values) > 1:
                yield context.figure(f"{name}_standard_error_auto_{speed}", float(np.std(values, ddof=1) / math.sqrt(len(values))), "", "report")
        yield context.figure(f"volume_auto_over_hand_{speed}", float(np.mean(sizes)) / zone_size.volume(HAND), "", "<= 1")
        yield context.figure(f"verdicts_large_enough_{speed}", float(np.mean(verdicts)), "share", "= 1")
    yield context.figure("too_small_flagged", float(np.mean(flagged)), "share", "= 1")
