"""What all plots share. Needs matplotlib."""

import os
import tempfile

os.environ.setdefault("MPLCONFIGDIR", os.path.join(tempfile.gettempdir(), f"gabion-matplotlib-{os.getuid()}"))

import matplotlib  # noqa: E402

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402

plt.rcParams.update({
    "figure.dpi": 110, "savefig.dpi": 110, "figure.constrained_layout.use": True,
    "font.size": 10, "axes.titlesize": 11, "axes.grid": True, "grid.alpha": 0.25, "axes.axisbelow": True,
    "axes.spines.top": False, "axes.spines.right": False, "legend.frameon": False, "legend.fontsize": 9,
    "axes.formatter.limits": (-3, 4), "axes.formatter.use_mathtext": True,
})

WIDE, TALL = (8.0, 4.2), (8.0, 6.4)  # inches
MODEL_COLOURS = {"dem": "#1f77b4", "continuum": "#7f7f7f", "bridging": "#d62728", "edge": "#2ca02c"}
MODEL_LINES = {"dem": "-", "continuum": ":", "bridging": "--", "edge": "-."}


def label(column):
    """'reaction of xmin.x [N]' for an axis: underscores as blanks."""
    return column.replace("_", " ")


def save(figure, folder, name):
    """Writes folder/plots/<name>.png and returns its path."""
    plots = folder / "plots"
    plots.mkdir(exist_ok=True)
    path = plots / f"{name}.png"
    figure.savefig(path)
    plt.close(figure)
    return path
