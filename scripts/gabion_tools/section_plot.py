"""The ground cut open at the last state, and what the interface carries. Needs numpy and matplotlib."""

import numpy as np
from matplotlib.collections import EllipseCollection, LineCollection, PolyCollection
from matplotlib.colors import LogNorm, Normalize

from gabion_tools.history_plots import time_column, title
from gabion_tools.run_data import split_unit
from gabion_tools.style import label, plt, save

AXES = "xyz"
FRAME = 0.25  # of the ground's size, shown around it
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


class Section:
    """What a section shows of a run's last state: places drawn, displacements, the cut."""

    def __init__(self, run, plane):
        self.grains, self.mesh, self.block = run.state("grains"), run.state("mesh"), run.state("block")
        rest = [a for a in (self.grains.get("position"), self.mesh.get("nodes")) if a is not None and len(a)]
        self.empty = not rest
        if self.empty:
            return
        self.low, self.high = np.min([a.min(axis=0) for a in rest], axis=0), np.max([a.max(axis=0) for a in rest], axis=0)
        frame = FRAME * (self.high - self.low)
        frame_low, frame_high = self.low - frame, self.high + frame
        self.axis, self.value = chosen_plane(plane, self.low, self.high)
        self.flat = [a for a in range(3) if a != self.axis]
        parts = [part["displacement"] for part in (self.grains, self.mesh) if len(part.get("displacement", []))]
        moved = np.concatenate(parts or [np.zeros((1, 3))])
        motion = np.linalg.norm(moved, axis=1)
        self.factor = 1.0 if self.block else magnified(moved, (self.high - self.low).max())
        # a few grains in flight must not take the whole colour scale
        self.largest = np.nanpercentile(motion, 99) if self.block else np.nanmax(motion)
        self.largest = self.largest or np.nanmax(motion) or 1.0
        # from tenths of a millimetre in the ground to a metre under the block
        self.norm = LogNorm(1e-4 * self.largest, self.largest, clip=True) if self.block else Normalize(0.0, self.largest)
        for part, place in ((self.grains, "position"), (self.mesh, "nodes")):
            if len(part.get(place, [])):
                part.setdefault("displacement", np.zeros_like(part[place]))
                moved = part[place] + self.factor * part["displacement"]
                self.low, self.high = np.fmin(self.low, moved.min(axis=0)), np.fmax(self.high, moved.max(axis=0))
        # grains that fly far are counted, not shown
        places = self.grains.get("position", np.zeros((0, 3))) + self.factor * self.grains.get("displacement", np.zeros((0, 3)))
        self.beyond = int(np.any((places < frame_low) | (places > frame_high), axis=1).sum())
        self.low, self.high = np.fmax(self.low, frame_low), np.fmin(self.high, frame_high)
        if self.block:
            self.low = np.fmin(self.low, self.block["vertices"].min(axis=0))
            self.high = np.fmax(self.high, self.block["vertices"].max(axis=0))

    def draw_mesh(self, panel, by_displacement):
        """Colours of the elements, or None where they are grey."""
        mesh = self.mesh
        if not len(mesh.get("nodes", [])):
            return None
        moved = mesh["nodes"] + self.factor * mesh["displacement"]
        polygons = cut_elements(mesh["nodes"], mesh["elements"], self.axis, self.value, moved)
        by_node = np.linalg.norm(mesh["displacement"], axis=1)
        drawn = panel.add_collection(PolyCollection(
            [p for p, _ in polygons], array=np.array([by_node[mesh["elements"][e]].mean() for _, e in polygons]),
            cmap="viridis", norm=self.norm, edgecolor="0.75", linewidth=0.5))
        if not by_displacement:
            drawn.set(array=None, facecolor="0.88", edgecolor="0.6")
        weight = mesh.get("weight", np.ones(len(mesh["elements"])))
        shared = [p for p, e in polygons if weight[e] < 1.0]
        if shared:
            panel.add_collection(PolyCollection(shared, facecolor="none", edgecolor="#d62728", hatch="///",
                                                linewidth=0.0, alpha=0.8, zorder=2, label="overlap"))
            panel.legend(loc="upper right", frameon=True, facecolor="white", framealpha=1.0)
        return drawn if by_displacement else None

    def draw_grains(self, panel, by_displacement):
        """Circles where the plane cuts the grains; None without grains."""
        grains = self.grains
        if not len(grains.get("position", [])):
            return None
        u = grains["displacement"]
        centre, radius = grains["position"] + self.factor * u, grains["radius"]
        off = centre[:, self.axis] - self.value
        hit = np.abs(off) < radius
        across = 2 * np.sqrt(radius[hit] ** 2 - off[hit] ** 2)
        circles = EllipseCollection(across, across, np.zeros_like(across), units="xy",
                                    offsets=centre[hit][:, self.flat], transOffset=panel.transData,
                                    edgecolor="0.15", linewidth=0.3, zorder=3)
        if by_displacement:
            circles.set(array=np.linalg.norm(u, axis=1)[hit], cmap="viridis", norm=self.norm)
        else:
            circles.set(array=grains["broken"][hit], cmap="inferno_r", clim=(0, grains["broken"].max()))
        return panel.add_collection(circles)

    def draw(self, figure, panel, by_displacement):
        mesh, grains = self.draw_mesh(panel, by_displacement), self.draw_grains(panel, by_displacement)
        figure.colorbar(grains or mesh, ax=panel, shrink=0.8, extend="both" if by_displacement and self.block else "neither",
                        label="displacement [m]" if by_displacement else "broken bonds of a grain")
        if self.block:
            faces = np.split(self.block["face_vertices"], self.block["face_ptr"][1:-1])
            outline = [self.block["vertices"][np.append(face, face[0])][:, self.flat] for face in faces]
            panel.add_collection(LineCollection(outline, color="k", linewidth=1.2, zorder=5))
        margin = 0.03 * (self.high - self.low).max()
        panel.set(xlim=(self.low[self.flat[0]] - margin, self.high[self.flat[0]] + margin),
                  ylim=(self.low[self.flat[1]] - margin, self.high[self.flat[1]] + margin), aspect="equal",
                  xlabel=f"{AXES[self.flat[0]]} [m]", ylabel=f"{AXES[self.flat[1]]} [m]")


def section(run, plane=None):
    """Grains as circles, the mesh as a grid, the overlap shaded, the block: by displacement, and where bonds broke by
    them too, one below the other."""
    cut = Section(run, plane)
    if cut.empty:
        return None
    broken = np.any(cut.grains.get("broken", np.zeros(1)) > 0)
    width, height = (cut.high - cut.low)[cut.flat]
    inches = np.clip(6.0 * height / width, 2.4, 7.0)  # of one panel, 6 wide where it is not too tall
    figure, panels = plt.subplots(1 + broken, 1, squeeze=False,
                                  figsize=(max(4.6, min(6.0, inches * width / height) + 1.9), (inches + 0.5) * (1 + broken) + 0.6))
    for panel, by_displacement in zip(panels[:, 0], (True, False)):
        cut.draw(figure, panel, by_displacement)
    drawn = "displacements as they are" if cut.factor == 1.0 else f"displacements drawn {cut.factor:g} times larger"
    if cut.beyond:
        drawn += f", {cut.beyond} grains beyond the frame"
    where = f"Section at {AXES[cut.axis]} = {cut.value:.4g} m, t = {run.state_times()[-1]:.4g} s"
    panels[0, 0].set_title(title(run, where) + "\n" + drawn)
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
