"""Draws every plot that a run folder has data for, into its folder plots/. Run as a program: FOLDER [AXIS=VALUE]."""

import sys
from pathlib import Path

from gabion_tools import crater_plot, history_plots, section_plot
from gabion_tools.run_data import Run

PLOTS = [history_plots.energy, history_plots.probes, history_plots.stress_strain, history_plots.block,
         history_plots.reactions, history_plots.convergence, section_plot.section, crater_plot.crater, section_plot.interface]


def draw(folder, plane=None):
    """Paths of what was drawn. A plot that fails is named and does not keep the others from being drawn."""
    run, made, failed = Run(folder), [], []
    for old in (run.folder / "plots").glob("*.png"):
        old.unlink()
    for plot in PLOTS:
        try:
            path = plot(run, plane) if plot is section_plot.section else plot(run)
            if path:
                made.append(path)
        except Exception as error:  # noqa: BLE001  (whatever it is, the other plots are still wanted)
            failed.append(f"{plot.__name__}: {type(error).__name__}: {error}")
    for line in failed:
        print("plot", line, file=sys.stderr)
    return made, failed


if __name__ == "__main__":
    sys.exit(1 if draw(Path(sys.argv[1]), *sys.argv[2:3])[1] else 0)
