"""Plots over time from the CSV files. Each function takes a Run and returns the PNG's path, or None without data."""

import re

import numpy as np

from gabion_tools.run_data import split_unit
from gabion_tools.style import TALL, WIDE, label, plt, save

AXES = "xyz"


def time_column(table):
    return next(name for name in table if split_unit(name)[0] == "time")


def has_rows(run, name):
    return name in run.histories and len(next(iter(run.histories[name].values()), [])) > 0


def title(run, what):
    return f"{what}\n{run.title}" + (f" ({run.model})" if run.model else "")


def by_axis(table):
    """{'x': {group: values}, ...} from columns '<group>.x [m]', and their unit."""
    found, unit = {axis: {} for axis in AXES}, ""
    for column, values in table.items():
        name, column_unit = split_unit(column)
        group, _, axis = name.rpartition(".")
        if group and axis in found:
            found[axis][group], unit = values, column_unit
    return found, unit


def energy(run):
    """Energies stacked, works as lines, and the balance's error below."""
    if not has_rows(run, "energy"):
        return None
    table = run.histories["energy"]
    time = table[time_column(table)]
    stored, works = {}, {}
    for column, values in table.items():
        name = split_unit(column)[0]
        entry = re.split(r"[ .]", name)[-1].replace("_", " ")  # 'grains broken_bonds': both media in one
        if column == time_column(table) or "balance" in name or entry == "rate swing":
            continue
        # An engine's own multipliers' work is not an energy of the whole: the two cancel.
        into = works if entry in ("loads", "constraints", "multipliers", "external") else stored
        into[entry] = into.get(entry, 0.0) + values
    scale = max((np.abs(v).max() for v in [*stored.values(), *works.values()]), default=0.0)
    shown = {name: v for name, v in stored.items() if np.abs(v).max() > 1e-4 * scale}
    works = {name: v for name, v in works.items() if np.abs(v).max() > 1e-4 * scale}

    figure, (top, below) = plt.subplots(2, 1, figsize=TALL, sharex=True, height_ratios=(3, 1))
    colours = plt.get_cmap("tab10").colors
    upper, lower = np.zeros_like(time), np.zeros_like(time)
    for k, (name, values) in enumerate(shown.items()):
        positive, negative = np.clip(values, 0, None), np.clip(values, None, 0)
        top.fill_between(time, upper, upper + positive, color=colours[k % 10], alpha=0.75, linewidth=0, label=name)
        if negative.any():
            top.fill_between(time, lower, lower + negative, color=colours[k % 10], alpha=0.75, linewidth=0)
        upper, lower = upper + positive, lower + negative
    for k, (name, values) in enumerate(works.items()):
        top.plot(time, values, "k", linestyle=("--", ":", "-.")[k % 3], linewidth=1.2, label=f"work of {name}")
    top.axhline(0, color="0.4", linewidth=0.6)
    top.set(ylabel="energy [J]", title=title(run, "Energies, stacked"))
    top.legend(loc="center left", bbox_to_anchor=(1.0, 0.5))
    error = next((v for c, v in table.items() if split_unit(c)[0] == "balance error"), None)
    if error is not None:
        below.plot(time, error / (scale or 1.0), "k", linewidth=1.0)
    below.axhline(0, color="0.4", linewidth=0.6)
    below.set(xlabel="time [s]", ylabel="balance error over\nlargest energy [-]")
    return save(figure, run.folder, "energy")


def probes(run):
    """Displacement of every probe, one panel an axis that moves."""
    if not has_rows(run, "probes"):
        return None
    table = run.histories["probes"]
    time, (groups, unit) = table[time_column(table)], by_axis(table)
    largest = max((np.nanmax(np.abs(v)) for axis in AXES for v in groups[axis].values()), default=0.0)
    moving = [axis for axis in AXES
              if any(np.nanmax(np.abs(v)) > 1e-3 * largest for v in groups[axis].values())] or ["z"]
    figure, panels = plt.subplots(len(moving), 1, figsize=(8.0, 1.2 + 2.6 * len(moving)), sharex=True, squeeze=False)
    for axis, panel in zip(moving, panels[:, 0]):
        for name, values in groups[axis].items():
            panel.plot(time, values, linewidth=1.2, label=label(name))
        panel.set_ylabel(f"displacement {axis} [{unit}]")
    panels[0, 0].legend(loc="center left", bbox_to_anchor=(1.0, 0.5))
    panels[0, 0].set_title(title(run, "Displacement of the probes"))
    panels[-1, 0].set_xlabel("time [s]")
    return save(figure, run.folder, "probes")


def stress_strain(run):
    """stress.csv, where a scene has one: first column strain, every other against it."""
    if not has_rows(run, "stress"):
        return None
    table = run.histories["stress"]
    strain_name = next((c for c in table if "strain" in split_unit(c)[0] and "axial" in split_unit(c)[0]),
                       next(iter(table)))
    figure, panel = plt.subplots(figsize=WIDE)
    for column, values in table.items():
        if column not in (strain_name, time_column(table)):
            panel.plot(table[strain_name], values, linewidth=1.3, label=label(column))
    panel.set(xlabel=label(strain_name), title=title(run, "Stress and lateral strain"))
    panel.legend()
    return save(figure, run.folder, "stress")


def block(run):
    """Penetration and force of the block, raw and filtered."""
    if not has_rows(run, "block"):
        return None
    table = run.histories["block"]
    time = table[time_column(table)]
    figure, (top, below) = plt.subplots(2, 1, figsize=TALL, sharex=True)
    for column, values in table.items():
        name = split_unit(column)[0]
        if name == "penetration":
            top.plot(time, values, "k", linewidth=1.3)
            top.set_ylabel(label(column))
        elif name == "force_filtered":
            below.plot(time, values, "#d62728", linewidth=1.5, label="vertical, mean over 4 ms", zorder=3)
        elif name == "force_largest.z":
            below.plot(time, values, "0.6", linewidth=0.8, label="vertical, largest of each ms")
    top.set_title(title(run, "Block: penetration and force"))
    below.set(xlabel="time [s]", ylabel="force [N]")
    below.legend()
    return save(figure, run.folder, "block")


def face_totals(table):
    """{'zmin.z [N]': force} of both media together, from columns '<medium> <face>.<axis> [N]', the time kept."""
    total = {}
    for column, values in table.items():
        name = column if column == time_column(table) else column.split(" ", 1)[-1] if "." in column else column
        total[name] = total[name] + np.nan_to_num(values) if name in total else values
    return total


def reactions(run):
    """Force on each held face, both media together, the components that carry something."""
    if not has_rows(run, "reactions"):
        return None
    table = face_totals(run.histories["reactions"])
    time, (groups, unit) = table[time_column(table)], by_axis(table)
    largest = max((np.nanmax(np.abs(v)) for axis in AXES for v in groups[axis].values()), default=0.0)
    if largest == 0.0:
        return None
    figure, panel = plt.subplots(figsize=WIDE)
    styles = {"x": "-", "y": "--", "z": "-."}
    for axis in AXES:
        for name, values in groups[axis].items():
            normal = name.startswith(axis)
            if np.nanmax(np.abs(values)) > (0.02 if normal else 0.2) * largest:
                panel.plot(time, values, styles[axis], linewidth=1.2, label=f"{label(name)}, {axis}")
    panel.axhline(0, color="0.4", linewidth=0.6)
    panel.set(xlabel="time [s]", ylabel=f"reaction [{unit or 'N'}]",
              title=title(run, "Reactions of the held faces, both media together"))
    panel.legend(loc="center left", bbox_to_anchor=(1.0, 0.5))
    return save(figure, run.folder, "reactions")


def convergence(run):
    """Unbalanced force and largest speed against the step."""
    if not has_rows(run, "monitor"):
        return None
    table = run.histories["monitor"]
    step = next((v for c, v in table.items() if split_unit(c)[0] == "step"), None)
    if step is None:
        return None
    panels = [(c, v) for c, v in table.items()
              if split_unit(c)[0] in ("unbalanced", "largest speed") and np.any(v > 0)]
    if not panels:
        return None
    figure, axes = plt.subplots(len(panels), 1, figsize=(8.0, 1.2 + 2.6 * len(panels)), sharex=True, squeeze=False)
    for (column, values), panel in zip(panels, axes[:, 0]):
        panel.semilogy(step, np.where(values > 0, values, np.nan), "k", linewidth=1.0)
        name, unit = split_unit(column)
        panel.set_ylabel({"unbalanced": "unbalanced force\nover mean force", "largest speed": "largest speed"}[name]
                         + f" [{unit or '-'}]")
    axes[0, 0].set_title(title(run, "Unbalanced force and speed"))
    axes[-1, 0].set_xlabel("step")
    return save(figure, run.folder, "monitor")
