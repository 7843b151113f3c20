"""One point of speed against error, and what follows from many. Standard library only.

    counts   grain-steps + element cost * element-steps, element cost: time of an element's step over that of a grain's
    wall     time of stepping, s
    error    of the mean over packings, |mean|, with the standard error of that mean where there are several
"""

import math
from dataclasses import dataclass, field

HEADLINES = (0.01, 0.03)
COUPLED = ("bridging", "edge")
COSTS = {"counts": lambda p: p.counts, "wall": lambda p: p.wall}


@dataclass
class Point:
    scene: str
    label: str
    knob: str              # what was changed against the scene as it is
    model: str
    parts: dict            # {name of an error: [one signed value a packing]}
    grain_steps: float     # means over the packings
    element_steps: float
    counts: float
    wall: float
    grains: float
    elements: float
    steps: float
    note: str = ""
    failed: str = ""
    means: dict = field(default_factory=dict)

    def __post_init__(self):
        self.means = {name: mean_and_error(values) for name, values in self.parts.items()}

    @property
    def error(self):
        """The worst of the parts."""
        return max((abs(mean) for mean, _ in self.means.values()), default=math.nan)

    @property
    def uncertainty(self):
        """Standard error of the worst part; nan with one packing."""
        return max(self.means.values(), key=lambda m: abs(m[0]), default=(math.nan, math.nan))[1]


def mean_and_error(values):
    mean = sum(values) / len(values)
    if len(values) < 2:
        return mean, math.nan
    variance = sum((v - mean) ** 2 for v in values) / (len(values) - 1)
    return mean, math.sqrt(variance / len(values))


def steps_of(summary):
    """(grain-steps, element-steps) of a run."""
    sizes, steps = summary["sizes"], summary["step"]["count"]
    return (float(sizes.get("grain_steps", sizes["grains"] * steps)), float(sizes.get("element_steps", sizes["elements"] * steps)))


def measured(scene, label, knob, runs, parts, element_cost, note=""):
    """runs: one RunResult a packing; parts: {error: [values]}."""
    each = [steps_of(run.summary) for run in runs]
    mean = lambda values: sum(values) / len(runs)  # noqa: E731
    grain, element = mean([g for g, _ in each]), mean([e for _, e in each])
    return Point(scene, label, knob, runs[0].model, {k: [float(v) for v in values] for k, values in parts.items()}, grain, element,
                 grain + element_cost * element, mean([run.summary["wall"]["stepping"] for run in runs]),
                 mean([run.summary["sizes"]["grains"] for run in runs]), mean([run.summary["sizes"]["elements"] for run in runs]),
                 mean([run.summary["step"]["count"] for run in runs]), note)


def front(points, cost):
    """Points that no other one beats in cost and error, by falling cost."""
    chosen, best = [], math.inf
    for point in sorted(points, key=lambda p: (cost(p), p.error)):
        if point.error < best:
            chosen.append(point)
            best = point.error
    return chosen


def speedup(points, reference, limit, cost, models=COUPLED):
    """(factor, point) of the cheapest point of these models whose error is at most limit; (None, None) where none is."""
    able = [p for p in points if p.error <= limit and p.model in models]
    if not able or reference is None:
        return None, None
    best = min(able, key=cost)
    return cost(reference) / cost(best), best


def element_costs(speeds):
    """Time of an element's step over that of a grain's, for frozen and for updated contacts; speeds: {case of kernels: M/s}."""
    find = lambda word: next(value for case, value in speeds.items() if case.startswith(word))  # noqa: E731
    brick = find("bricks")
    return {"frozen": find("bonded, frozen") / brick, "updated": find("breakable bonds") / brick}
