"""The ground's surface before and after an impact, round the block's axis. Needs numpy and matplotlib."""

import numpy as np

from gabion_tools.history_plots import title
from gabion_tools.style import WIDE, plt, save

CELL, CELL_DIAMETERS = 0.25, 1.5  # m and mean diameters: the smaller one, as the mean surface level is measured
FLYING = 3.0  # mean diameters above the ground: a grain in flight is no surface


def surface(position, radius, low, high, size):
    """(cell centres, highest grain top in each cell of that size); nan where a cell has no grain."""
    count = np.maximum(1, ((high - low) / size).astype(int))
    cell = ((position[:, :2] - low) / (high - low) * count).astype(int)
    inside = np.all((cell >= 0) & (cell < count), axis=1)
    top = np.full(count, -np.inf)
    np.maximum.at(top, tuple(cell[inside].T), position[inside, 2] + radius[inside])
    x, y = (low[a] + (np.arange(count[a]) + 0.5) * (high[a] - low[a]) / count[a] for a in (0, 1))
    centres = np.stack(np.meshgrid(x, y, indexing="ij"), axis=-1)
    return centres, np.where(np.isfinite(top), top, np.nan)


def profile(centres, top, axis, edges):
    """Median, lower and upper quartile of the height in each ring; nan where a ring has no cell."""
    distance = np.hypot(centres[..., 0] - axis[0], centres[..., 1] - axis[1])
    rings = [top[(distance >= a) & (distance < b) & np.isfinite(top)] for a, b in zip(edges[:-1], edges[1:])]
    return np.array([np.percentile(ring, [50, 25, 75]) if len(ring) else [np.nan] * 3 for ring in rings])


def crater(run):
    """Height of the surface against the distance from the block's axis, first and last state."""
    grains, block = run.state("grains"), run.state("block")
    if not block or not len(grains.get("position", [])):
        return None
    first = run.state("grains", 0)
    axis = run.state("block", 0)["vertices"].mean(axis=0)[:2]
    low, high = grains["position"][:, :2].min(axis=0), grains["position"][:, :2].max(axis=0)
    diameter = 2 * grains["radius"].mean()
    size = min(CELL, CELL_DIAMETERS * diameter)
    edges = np.arange(0.0, 0.5 * (high - low).min(), size)
    middle = 0.5 * (edges[:-1] + edges[1:])
    figure, panel = plt.subplots(figsize=WIDE)
    level = None
    for state, colour, name in ((first, "0.5", "before"), (grains, "#d62728", "after")):
        moved = state.get("displacement", np.zeros_like(grains["position"]))
        here = grains["position"] + moved
        keep = np.ones(len(here), bool) if level is None else here[:, 2] - grains["radius"] < level + FLYING * diameter
        centres, top = surface(here[keep], grains["radius"][keep], low, high, size)
        if level is None:
            level = np.nanmean(top)
        median, lower, upper = profile(centres, top, axis, edges).T
        panel.fill_between(middle, lower, upper, color=colour, alpha=0.25, linewidth=0)
        panel.plot(middle, median, color=colour, linewidth=1.6, label=f"{name} (median, quartiles in each ring)")
    corners = block["vertices"]
    panel.plot(np.hypot(*(corners[:, :2] - axis).T), corners[:, 2], "k^", markersize=5, label="corners of the block")
    panel.axhline(level, color="0.4", linewidth=0.6, linestyle=":")
    panel.set(xlabel="distance from the block's axis [m]", ylabel="height of the highest grain [m]",
              title=title(run, f"Crater, t = {run.state_times()[-1]:.3g} s"))
    panel.set_ylim(min(np.nanmin(corners[:, 2]), level - 1.0) - 0.1, level + 1.5)
    panel.legend()
    return save(figure, run.folder, "crater")
