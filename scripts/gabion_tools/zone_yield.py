"""Where a run's ground yielded, and how fast its load changed. Needs numpy; prints JSON. Words: FOLDER SHARE."""

import json
import math
import sys

import numpy as np

from gabion_tools.run_data import Run

YIELDED = 0.5           # damage of a grain from which on the search for the box begins
FEWEST_GRAINS = 10      # of a slab, below which its share says nothing
GAP = 1.0               # diameters of ground that stays whole, beyond which single yielding slabs do not count
START = 1.5             # diameters round the grains that begin the search, so that slabs across them hold enough
WIDTHS = (0.5, 1.0, 2.0)  # of a slab, diameters: the first with grains enough in most slabs
ENERGY_SHARE = 0.95     # of the load's rate, below the frequency that is given


def slab_share(position, damage, axis, inside, edges):
    """Mean damage of the slabs between edges along an axis; nan where too few grains lie."""
    place = np.digitize(position[inside, axis], edges) - 1
    valid = (place >= 0) & (place < len(edges) - 1)
    count = np.bincount(place[valid], minlength=len(edges) - 1)
    total = np.bincount(place[valid], weights=damage[inside][valid], minlength=len(edges) - 1)
    return np.where(count >= FEWEST_GRAINS, total / np.maximum(count, 1), np.nan)


def yield_box(position, damage, diameter, share):
    """[lo, hi] of the ground in which a share of the contacts or more slid or broke, m; None: nowhere."""
    hit = damage >= min(YIELDED, 0.5 * damage.max())
    if damage.max() <= share:
        return None
    lo, hi = np.quantile(position[hit], 0.01, axis=0) - START * diameter, np.quantile(position[hit], 0.99, axis=0) + START * diameter
    for _ in range(4):
        for axis in range(3):
            others = [a for a in range(3) if a != axis]
            inside = np.all((position[:, others] >= lo[others]) & (position[:, others] <= hi[others]), axis=1)
            low, high = yielding_slabs(position, damage, axis, inside, diameter, share, 0.5 * (lo[axis] + hi[axis]))
            if low is not None:
                lo[axis], hi[axis] = low, high
    return [lo.tolist(), hi.tolist()]


def yielding_slabs(position, damage, axis, inside, diameter, share, middle):
    """Ends of the slabs across an axis in which damage reaches the share, from the one nearest to the middle as far as they follow
    one another within GAP diameters; (None, None) where none does or none has grains enough."""
    first, last = position[:, axis].min(), position[:, axis].max()
    for width in WIDTHS:
        edges = np.linspace(first, last, max(2, int(round((last - first) / (width * diameter)))) + 1)
        found = slab_share(position, damage, axis, inside, edges)
        if np.isfinite(found).mean() > 0.5:
            break
    yields = np.flatnonzero(found >= share)
    if not len(yields):
        return None, None
    reach = 1 + max(1, round(GAP * diameter / (edges[1] - edges[0])))
    groups = np.split(yields, np.flatnonzero(np.diff(yields) > reach) + 1)
    group = min(groups, key=lambda g: max(edges[g[0]] - middle, middle - edges[g[-1] + 1], 0.0))
    return edges[group[0]], edges[group[-1] + 1]


def frequency(time, force):
    """Below it lies 95 % of the power of the force's rate of change, Hz: what a load sends into the
    ground goes with its rate."""
    if len(time) < 8:
        return None
    step = float(np.median(np.diff(time)))
    even = np.arange(time[0], time[-1], step)
    rate = np.gradient(np.interp(even, time, force), step)
    power = np.abs(np.fft.rfft(rate)) ** 2  # no window: what counts most is at the beginning
    total = np.cumsum(power)
    return float(np.fft.rfftfreq(len(rate), step)[np.searchsorted(total, ENERGY_SHARE * total[-1])])


def main(folder, share):
    run = Run(folder)
    grains = run.state("grains")
    diameter = 2.0 * float(grains["radius"].mean())
    found = {"box": yield_box(grains["position"], grains["damage"], diameter, share), "diameter": diameter,
             "grains": len(grains["radius"]), "yielded": float((grains["damage"] >= YIELDED).mean()),
             "frequency": None, "shear_speed": None}
    block = run.histories.get("block")
    if block:
        found["frequency"] = frequency(block["time [s]"], block["force_filtered [N]"])
        found["penetration"] = float(block["penetration [m]"][-1])
    elastic = run.summary.get("elasticity")
    if elastic:
        found["shear_speed"] = math.sqrt(elastic["stiffness"][3][3] / elastic["density"])
    print(json.dumps(found))


if __name__ == "__main__":
    main(sys.argv[1], float(sys.argv[2]))
