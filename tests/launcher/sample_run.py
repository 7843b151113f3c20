"""A made-up run folder with every file that a run can leave: for tests of plots and reports."""

import csv
import json

import h5py
import numpy as np

STEPS = 200


def write_csv(path, columns):
    with open(path, "w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file)
        writer.writerow(columns)
        writer.writerows(zip(*columns.values()))


def histories(folder):
    time = np.linspace(0.0, 0.06, STEPS)
    swing = np.sin(2 * np.pi * time / 0.03) ** 2
    energy = {"time [s]": time}
    for engine, share in (("grains", 0.7), ("continuum", 0.3)):
        energy[f"{engine} kinetic [J]"] = 850e3 * share * (1 - time / 0.06) * (1 - 0.5 * swing)
        energy[f"{engine} elastic [J]"] = 850e3 * share * (1 - time / 0.06) * 0.5 * swing
        energy[f"{engine} dashpots [J]"] = 850e3 * share * time / 0.06 * 0.2
    energy["grains friction [J]"] = 850e3 * time / 0.06 * 0.8
    energy["grains loads [J]"] = 5e4 * time / 0.06
    energy["balance [J]"] = 850e3 * (1 + 1e-5 * np.sin(400 * time))
    energy["balance error [J]"] = energy["balance [J]"] - 850e3
    write_csv(folder / "energy.csv", energy)
    probes = {"time [s]": time}
    for name, size in (("A", 1e-4), ("B", 6e-5)):
        for axis, share in zip("xyz", (0.2, 0.0, 1.0)):
            probes[f"{name}.{axis} [m]"] = -size * share * np.sin(2 * np.pi * time / 0.04)
    write_csv(folder / "probes.csv", probes)
    write_csv(folder / "reactions.csv", {"time [s]": time, "grains zmin.x [N]": 0 * time, "grains zmin.y [N]": 0 * time,
                                         "grains zmin.z [N]": 9e4 * swing})
    write_csv(folder / "monitor.csv", {"step": np.arange(STEPS), "time [s]": time,
                                       "unbalanced": np.exp(-np.arange(STEPS) / 20.0), "largest speed [m/s]": 13 * (1.01 - swing),
                                       "interface displacement [m]": 1e-3 * swing})
    write_csv(folder / "interface.csv", {"time [s]": time, "largest jump [m]": 1e-12 * (1 + swing),
                                         "largest force [N]": 3e4 * swing})
    block = {"time [s]": time, "penetration [m]": 0.64 * np.sin(np.pi * time / 0.12)}
    for axis, share in zip("xyz", (0.02, 0.01, 1.0)):
        block[f"force.{axis} [N]"] = 2e6 * share * swing * (1 + 0.2 * np.sin(2e3 * time))
    block["force_filtered [N]"] = 2e6 * swing
    write_csv(folder / "block.csv", block)


def grains(generator):
    n = 14
    grid = np.stack(np.meshgrid(*[np.arange(n)] * 2, np.arange(9), indexing="ij"), -1).reshape(-1, 3)
    position = (grid - [6.5, 6.5, 9.0]) * 0.3 + generator.uniform(-0.05, 0.05, (len(grid), 3))
    return position, generator.uniform(0.1, 0.17, len(grid))


def mesh():
    """Bricks of 0.75 m round a hole that the grains fill, overlapping them by one layer."""
    n = (8, 8, 6)
    index = np.arange(np.prod(np.add(n, 1))).reshape(np.add(n, 1))
    nodes = np.stack(np.meshgrid(*[np.arange(k + 1) for k in n], indexing="ij"), -1).reshape(-1, 3) * 0.75
    nodes -= [3.0, 3.0, 4.5]
    elements, weights = [], []
    for i, j, k in np.ndindex(*n):
        if 2 < i < 5 and 2 < j < 5 and k > 3:
            continue
        corner = [index[i + a, j + b, k + c] for c in (0, 1) for a, b in ((0, 0), (1, 0), (1, 1), (0, 1))]
        elements.append(corner)
        weights.append(0.5 if 1 < i < 6 and 1 < j < 6 and k > 2 else 1.0)
    return nodes, np.array(elements), np.array(weights)


def sink(points):
    """A dent under the origin, m."""
    far = np.linalg.norm(points, axis=1)
    return np.array([0.0, 0.0, -0.15]) * np.exp(-(far / 1.5)[:, None] ** 2) + 1e-9


def results(path, block):
    generator = np.random.default_rng(1)
    position, radius = grains(generator)
    nodes, elements, weight = mesh()
    with h5py.File(path, "w") as file:
        file["states/time"], file["states/step"] = [0.0, 0.06], [0, STEPS]
        for name, value in (("position", position), ("radius", radius),
                            ("weight", np.clip(1.2 - np.abs(position[:, 0]), 0.01, 1))):
            file["grains/" + name] = value
        for name, value in (("nodes", nodes), ("elements", elements), ("weight", weight)):
            file["mesh/" + name] = value
        rows = nodes[np.unique(elements[weight < 1])]
        file["interface/position"] = rows
        for k, share in enumerate((0.0, 1.0)):
            state = f"state_{k:06d}/"
            file["grains/" + state + "displacement"] = share * sink(position)
            file["mesh/" + state + "displacement"] = share * sink(nodes)
            file["interface/" + state + "multiplier_force"] = share * 1e6 * sink(rows)
            file["interface/" + state + "jump"] = share * 1e-12 * sink(rows)
            if block:
                broken = np.where(np.linalg.norm(position, axis=1) < 1, 4.0, 0.0)
                file["grains/" + state + "broken"] = share * broken
        if block:
            corners = np.array([[x, y, z] for z in (0, 1.5) for x, y in ((-1, -1), (1, -1), (1, 1), (-1, 1))]) * [.7, .7, 1]
            faces = [[0, 3, 2, 1], [4, 5, 6, 7], [0, 1, 5, 4], [1, 2, 6, 5], [2, 3, 7, 6], [3, 0, 4, 7]]
            file["block/vertices"] = corners
            file["block/face_ptr"], file["block/face_vertices"] = np.arange(0, 25, 4), np.ravel(faces)
            file["block/state_000001/vertices"] = corners - [0, 0, 0.3]


def write(folder, model="bridging", block=True):
    folder.mkdir(parents=True, exist_ok=True)
    summary = {"scene": "sample", "title": "A made-up run", "model": model,
               "state_hash": {"dem": "1f", "continuum": "2e"}, "sizes": {"grains": 1764, "nodes": 567, "condition": 63.4},
               "step": {"dt": 1e-5, "count": STEPS}, "wall": {"total": 1.5},
               "stages": [{"name": "impact", "steps": STEPS, "time": 0.06, "unbalanced": 0.1}],
               "figures": {"penetration": 0.64}, "warnings": ["0.5 % of the contacts of the overlap slide <&>"]}
    (folder / "summary.json").write_text(json.dumps(summary), encoding="utf-8")
    (folder / "scene.effective.json").write_text('{"title": "A made-up run"}', encoding="utf-8")
    (folder / "run.log").write_text("     0.001 s  begun\n", encoding="utf-8")
    histories(folder)
    results(folder / "results.h5", block)
