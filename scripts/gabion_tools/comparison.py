"""Several runs over one another and compare.html. Run as a program: OUT RUN... Needs numpy and matplotlib."""

import html
import sys
from pathlib import Path

import numpy as np

from gabion_tools import report_page, summary
from gabion_tools.history_plots import face_totals
from gabion_tools.run_data import Run, split_unit
from gabion_tools.style import MODEL_COLOURS, MODEL_LINES, WIDE, label, plt, save


def names(runs):
    """A short label a run: its model, or its folder where two have the same model."""
    models = [run.model for run in runs]
    return [run.model if run.model and models.count(run.model) == 1 else run.folder.name for run in runs]


def look(run, runs):
    """Colour and line of a run; those of its model while no two share one."""
    if [other.model for other in runs].count(run.model) == 1 and run.model in MODEL_COLOURS:
        return {"color": MODEL_COLOURS[run.model], "linestyle": MODEL_LINES[run.model]}
    return {"color": plt.get_cmap("tab10").colors[runs.index(run) % 10]}


def overlay(folder, runs, history, x_name, column, name, what):
    """One column of one history of every run that has it."""
    figure, panel = plt.subplots(figsize=WIDE)
    x_label = y_label = None
    for run, title in zip(runs, names(runs)):
        table = run.histories.get(history, {})
        found = {split_unit(c)[0]: c for c in table}
        if column not in found or x_name not in found:
            continue
        x_label, y_label = found[x_name], found[column]
        panel.plot(table[x_label], table[y_label], linewidth=1.4, label=title, **look(run, runs))
    if y_label is None:
        plt.close(figure)
        return None
    panel.set(xlabel=label(x_label), ylabel=label(y_label), title=what)
    panel.legend()
    return save(figure, folder, name)


def columns(runs, history):
    """Names of the columns that at least two runs share (all, when there is one run)."""
    count = {}
    for run in runs:
        for column in run.histories.get(history, {}):
            count[split_unit(column)[0]] = count.get(split_unit(column)[0], 0) + 1
    return [name for name, n in count.items() if n >= min(2, len(runs))]


def moves(runs, history, column):
    """Whether a column is worth a plot: not small beside the largest of its history."""
    def largest(wanted):
        values = [np.nanmax(np.abs(v), initial=0.0) for run in runs for c, v in run.histories.get(history, {}).items()
                  if wanted(split_unit(c)[0])]
        return max(values, default=0.0)
    return largest(lambda name: name == column) > 0.1 * largest(lambda name: name not in ("time", "step"))


def overlays(folder, runs):
    for column in columns(runs, "probes"):
        if column not in ("time", "step") and moves(runs, "probes", column):
            yield overlay(folder, runs, "probes", "time", column, f"probe-{column}", f"Probe {label(column)}")
    for column in columns(runs, "reactions"):
        if column not in ("time", "step") and moves(runs, "reactions", column):
            yield overlay(folder, runs, "reactions", "time", column, f"reaction-{column}", f"Reaction {label(column)}")
    for run in runs:  # models settle in different times: the block's clock starts at its release
        for name, values in run.histories.get("block", {}).items():
            if split_unit(name)[0] == "time":
                values -= values[0]
    for column, what in (("penetration", "Penetration of the block"), ("force_filtered", "Vertical force on the block, mean over 4 ms")):
        yield overlay(folder, runs, "block", "time", column, f"block-{column}", what)
    strain = next((c for c in columns(runs, "stress") if "axial" in c and "strain" in c), None)
    for column in columns(runs, "stress"):
        if strain and column not in ("time", "step", strain):
            yield overlay(folder, runs, "stress", strain, column, f"stress-{column}", f"{label(column)}".capitalize())


def summary_table(runs):
    """One row a figure, one column a run."""
    flat = [dict(summary.rows({k: v for k, v in run.summary.items() if k != "warnings"})) for run in runs]
    keys = list(dict.fromkeys(key for one in flat for key in one))
    head = "".join(f"<td><b>{html.escape(name)}</b></td>" for name in names(runs))
    body = "".join(f"<tr><td>{html.escape(key)}</td>"
                   + "".join(f"<td>{html.escape(one.get(key, '-'))}</td>" for one in flat) + "</tr>" for key in keys)
    return f"<table><tr><td></td>{head}</tr>{body}</table>"


def write(folder, run_folders):
    """Draws the overlays and writes folder/compare.html."""
    runs = [Run(path) for path in run_folders]
    for run in runs:
        if "reactions" in run.histories:
            run.histories["reactions"] = face_totals(run.histories["reactions"])
    for old in (folder / "plots").glob("*.png"):
        old.unlink()
    plots = [path for path in overlays(folder, runs) if path]
    parts = ["<h2>Histories</h2>", *(report_page.image(path) for path in plots)] if plots else []
    parts += ["<h2>Summaries</h2>", summary_table(runs)]
    for run, name in zip(runs, names(runs)):
        section = run.folder / "plots" / "section.png"
        if section.exists():
            parts.append(f"<h2>Section, {html.escape(name)}</h2>{report_page.image(section)}")
    (folder / "compare.html").write_text(report_page.page(f"{runs[0].title}: comparison", parts), encoding="utf-8")


if __name__ == "__main__":
    write(Path(sys.argv[1]), [Path(word) for word in sys.argv[2:]])
