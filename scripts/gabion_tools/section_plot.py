"""The ground cut open at the last state, and what the interface carries. Needs numpy and matplotlib."""

import numpy as np
from matplotlib.collections import EllipseCollection, LineCollection, PolyCollection

from gabion_tools.history_plots import time_column, title
from gabion_tools.run_data import split_unit
from gabion_tools.style import label, plt, save

AXES = "xyz"
EDGES = ((0, 1), (1, 2), (2, 3), (3, 0), (4, 5), (5, 6), (6, 7), (7, 4), (0, 4), (1, 5), (2, 6), (3, 7))


def chosen_plane(plane, low, high):
    """(normal axis, value): from 'y=0.5', else through the middle across y."""
    if plane:
        axis, _, value = plane.partition("=")
        return AXES.index(axis.strip()), float(value)
    return 1, 0.5 * (low[1] + high[1])


def magnified(motion, size):
    """Factor that makes the largest motion visible: 1 once it is a fiftieth of the ground."""
    largest = np.nanmax(np.linalg.norm(motion, axis=1)) if len(motion) else 0.0
    if largest == 0.0 or largest > 0.02 * size:
        return 1.0
    raw = 0.03 * size / largest
    return 10 ** np.floor(np.log10(raw)) * max(m for m in (1, 2, 5) if m <= raw / 10 ** np.floor(np.log10(raw)))


def cut_elements(nodes, elements, axis, value, moved=None):
    """Polygons where the plane meets the elements at rest [(polygon, element)], corners in order round each.

    moved: where the nodes are drawn; the cut is carried along.
    """
    flat = [a for a in range(3) if a != axis]
    value += 1e-9 * np.ptp(nodes[:, axis])  # a plane between two layers belongs to one of them
    corner, drawn = nodes[elements], (nodes if moved is None else moved)[elements]
    side = corner[:, :, axis] - value
    hit = np.flatnonzero((side.min(axis=1) < 0) & (side.max(axis=1) >= 0))
    polygons = []
    for element in hit:
        points = []
        for a, b in EDGES:
            sa, sb = side[element, a], side[element, b]
            if (sa < 0) != (sb < 0):
                points.append(drawn[element, a] + (drawn[element, b] - drawn[element, a]) * sa / (sa - sb))
        points = np.array(points)[:, flat]
        around = points - points.mean(axis=0)
        polygons.append((points[np.argsort(np.arctan2(around[:, 1], around[:, 0]))], element))
    return polygons


def section(run, plane=None):
    """Grains as circles by displacement (or broken bonds), the mesh as a grid, the overlap shaded, the block."""
    grains, mesh, block = run.state("grains"), run.state("mesh"), run.state("block")
    rest = [a for a in (grains.get("position"), mesh.get("nodes")) if a is not None and len(a)]
    if not rest:
        return None
    low, high = np.min([a.min(axis=0) for a in rest], axis=0), np.max([a.max(axis=0) for a in rest], axis=0)
    axis, value = chosen_plane(plane, low, high)
    flat = [a for a in range(3) if a != axis]
    motion = np.concatenate([part["displacement"] for part in (grains, mesh) if len(part.get("displacement", []))]
                            or [np.zeros((1, 3))])
    factor = 1.0 if block else magnified(motion, (high - low).max())
    largest = np.nanmax(np.linalg.norm(motion, axis=1)) or 1.0
    across, up = (high - low)[flat]
    figure, panel = plt.subplots(figsize=(min(8.0, max(5.0, 6.2 * across / up + 2.5)),
                                          min(8.0, max(4.0, 6.0 * up / across + 1.0))))
    colours = None

    if len(mesh.get("nodes", [])):
        moved = mesh["nodes"] + factor * mesh.get("displacement", np.zeros_like(mesh["nodes"]))
        polygons = cut_elements(mesh["nodes"], mesh["elements"], axis, value, moved)
        by_node = np.linalg.norm(mesh.get("displacement", np.zeros_like(mesh["nodes"])), axis=1)
        weight = mesh.get("weight", np.ones(len(mesh["elements"])))
        colours = panel.add_collection(PolyCollection(
            [p for p, _ in polygons], array=np.array([by_node[mesh["elements"][e]].mean() for _, e in polygons]),
            cmap="viridis", clim=(0, largest), edgecolor="0.75", linewidth=0.5))
        if np.any(grains.get("broken", np.zeros(1)) > 0):  # grains show their bonds: one colour scale is enough
            colours.set(array=None, facecolor="0.88", edgecolor="0.6")
            colours = None
        shared = [p for p, e in polygons if weight[e] < 1.0]
        if shared:
            panel.add_collection(PolyCollection(shared, facecolor="none", edgecolor="#d62728", hatch="///",
                                                linewidth=0.0, alpha=0.8, zorder=2, label="overlap"))
            panel.legend(loc="upper right", frameon=True, facecolor="white", framealpha=1.0)
    if len(grains.get("position", [])):
        u = grains.get("displacement", np.zeros_like(grains["position"]))
        centre, radius = grains["position"] + factor * u, grains["radius"]
        off = centre[:, axis] - value
        hit = np.abs(off) < radius
        across = 2 * np.sqrt(radius[hit] ** 2 - off[hit] ** 2)
        broken = grains.get("broken")
        circles = EllipseCollection(across, across, np.zeros_like(across), units="xy",
                                    offsets=centre[hit][:, flat], transOffset=panel.transData,
                                    edgecolor="0.15", linewidth=0.3, zorder=3)
        if broken is not None and np.any(broken > 0):
            circles.set(array=broken[hit], cmap="inferno_r", clim=(0, broken.max()))
            figure.colorbar(circles, ax=panel, label="broken bonds of a grain", shrink=0.7)
        else:
            circles.set(array=np.linalg.norm(u, axis=1)[hit], cmap="viridis", clim=(0, largest))
            colours = circles
        panel.add_collection(circles)
        low, high = np.fmin(low, centre.min(axis=0)), np.fmax(high, centre.max(axis=0))
    if block:
        faces = np.split(block["face_vertices"], block["face_ptr"][1:-1])
        outline = [block["vertices"][np.append(face, face[0])][:, flat] for face in faces]
        panel.add_collection(LineCollection(outline, color="k", linewidth=1.2, zorder=5))
        low = np.fmin(low, block["vertices"].min(axis=0))
        high = np.fmax(high, block["vertices"].max(axis=0))
    if colours is not None:
        figure.colorbar(colours, ax=panel, label="displacement [m]", shrink=0.7)
    margin = 0.03 * (high - low).max()
    panel.set(xlim=(low[flat[0]] - margin, high[flat[0]] + margin),
              ylim=(low[flat[1]] - margin, high[flat[1]] + margin), aspect="equal",
              xlabel=f"{AXES[flat[0]]} [m]", ylabel=f"{AXES[flat[1]]} [m]")
    drawn = "displacements as they are" if factor == 1.0 else f"displacements drawn {factor:g} times larger"
    panel.set_title(title(run, f"Section at {AXES[axis]} = {value:.4g} m, t = {run.state_times()[-1]:.4g} s") + "\n" + drawn)
    return save(figure, run.folder, "section")


def interface(run):
    """interface.csv over time, a panel a unit; at the last state the multipliers' force of each row."""
    rows, table = run.state("interface"), run.histories.get("interface", {})
    force = next((rows[name] for name in ("multiplier_force", "force", "multiplier") if name in rows), None)
    by_unit = {}
    for column, values in table.items():
        name, unit = split_unit(column)
        if name not in ("time", "step") and np.any(np.abs(values) > 0):
            by_unit.setdefault(unit, {})[name] = np.abs(values)
    have_map = force is not None and len(rows.get("position", [])) > 0
    count = len(by_unit) + have_map
    if not count:
        return None
    figure, panels = plt.subplots(count, 1, figsize=(8.0, 1.0 + 2.8 * count), squeeze=False)
    for (unit, curves), panel in zip(by_unit.items(), panels[:, 0]):
        for name, values in curves.items():
            panel.plot(table[time_column(table)], np.where(values > 1e-9 * np.nanmax(values), values, np.nan),
                       linewidth=1.2, label=label(name))
        low, high = (pick([pick(v[v > 0]) for v in curves.values()]) for pick in (min, max))
        panel.set(xlabel="time [s]", ylabel=f"absolute value [{unit or '-'}]",
                  yscale="log" if high > 1e4 * low else "linear")
        panel.legend(loc="center left", bbox_to_anchor=(1.0, 0.5))
    if have_map:
        map_of_rows(figure, panels[-1, 0], rows["position"], force, rows.get("jump"))
    panels[0, 0].set_title(title(run, "Interface") + ("" if by_unit else "\n" + panels[0, 0].get_title()))
    return save(figure, run.folder, "interface")


def map_of_rows(figure, panel, position, force, jump):
    """Dots at the rows, seen along the axis of the ground's smallest extent."""
    size = np.linalg.norm(force.reshape(len(force), -1), axis=1)
    across = np.sort(np.argsort(np.ptp(position, axis=0), kind="stable")[1:])
    dots = panel.scatter(position[:, across[0]], position[:, across[1]], c=size,
                         s=14 + 60 * size / (size.max() or 1.0), cmap="magma_r", edgecolor="0.3", linewidth=0.3)
    figure.colorbar(dots, ax=panel, label="force of a row [N]")
    largest = f", largest jump {np.abs(jump).max():.3g} m" if jump is not None and jump.size else ""
    panel.set(xlabel=f"{AXES[across[0]]} [m]", ylabel=f"{AXES[across[1]]} [m]", aspect="equal",
              title=f"Multiplier force of each row at the last state{largest}")
