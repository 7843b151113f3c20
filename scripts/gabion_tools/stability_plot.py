"""Maps of the coupled step's limit over the smaller uncoupled one. Run as a program: FILE of bench_stability's lines, PICTURE."""

import json
import math
import sys

import numpy

from gabion_tools.style import plt

DARK = 1.15  # of the fraction; below, the number on it is white


def grid(lines, across, up):
    """(values across, values up, fraction [up][across]); nan where nothing was measured."""
    x, y = sorted({line[across] for line in lines}), sorted({line[up] for line in lines})
    fractions = numpy.full((len(y), len(x)), numpy.nan)
    for line in lines:
        fractions[y.index(line[up]), x.index(line[across])] = line["fraction"]
    return x, y, fractions


def panel(axis, lines, across, up, names, title):
    x, y, fractions = grid(lines, across, up)
    image = axis.imshow(fractions, origin="lower", aspect="auto", vmin=0.9, vmax=1.3, cmap="viridis")
    axis.set_xticks(range(len(x)), [f"{value:g}" for value in x])
    axis.set_yticks(range(len(y)), [f"{value:g}" for value in y])
    axis.set(xlabel=names[0], ylabel=names[1], title=title)
    axis.grid(False)
    for (j, i), value in numpy.ndenumerate(fractions):
        if numpy.isfinite(value):
            axis.text(i, j, f"{value:.3f}", ha="center", va="center", fontsize=6.5, color="white" if value < DARK else "black")
    return image


def damping(axis, lines):
    shares = numpy.linspace(0.0, 0.9, 50)
    axis.plot(shares, 1.0 / numpy.sqrt(1.0 + shares), color="grey", lw=1.0, label=r"$1/\sqrt{1 + \alpha}$")
    for rows in sorted({line["rows"] for line in lines}):
        of_rows = sorted((line["damping"], line["fraction"]) for line in lines if line["rows"] == rows)
        axis.plot(*zip(*of_rows), "o", ms=4, label=rows)
    axis.set(xlabel="local damping", ylabel="limit over the uncoupled one", title="local damping")
    axis.legend()


def draw(lines, path):
    of = lambda kind, rows: [line for line in lines if line["map"] == kind and line["rows"] == rows]  # noqa: E731
    figure, axes = plt.subplots(2, 3, figsize=(13.0, 7.0))
    for axis, rows in zip(axes[0], ("mortar", "mortar2h", "strict")):
        image = panel(axis, of("overlap", rows), "size", "overlap", ("element over grain diameter", "overlap over element"), rows)
    for axis, rows in zip(axes[1], ("mortar", "strict")):
        lines_of = [{**line, "power": round(math.log10(line["stiffness"]), 6)} for line in of("contrast", rows)]
        panel(axis, lines_of, "power", "floor", ("log10 of stiffness, mesh over grains", "weights' floor"), f"{rows}, overlap of 2 elements")
    damping(axes[1][2], [line for line in lines if line["map"] == "damping"])
    figure.colorbar(image, ax=axes[0], label="limit over the uncoupled one")
    figure.savefig(path)
    plt.close(figure)


if __name__ == "__main__":
    with open(sys.argv[1], encoding="utf-8") as file:
        draw([json.loads(line) for line in file if line.startswith("{")], sys.argv[2])
