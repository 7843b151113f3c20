"""Hard cases that take whole runs: a scene a thousand kilometres away, an element that turns inside out, limits."""

import csv
import json
import re
import unittest
from decimal import Decimal

import h5py
import numpy

from programs import NOWHERE, SCENARIOS, SystemTest, figure

FAR = (10**6, -(10**6), 10**6)  # m


def moved(coordinates, by):
    """['0.8 m', ...] moved, written with as many digits as it takes."""
    return [f"{Decimal(text.split()[0]) + Decimal(shift)} m" for text, shift in zip(coordinates, by)]


def moved_scene(name, by):
    scene = json.loads(re.sub(r"^//.*$", "", (SCENARIOS / name).read_text(), flags=re.MULTILINE))
    scene["ground"]["box"] = [moved(corner, by) for corner in scene["ground"]["box"]]
    for model in ("bridging", "edge"):
        scene["coupling"][model]["zone"] = [moved(corner, by) for corner in scene["coupling"][model]["zone"]]
    for probe in scene["probes"]:
        probe["at"] = moved(probe["at"], by)
    return scene


class Far(SystemTest):
    def displacements(self):
        with h5py.File(self.out / "results.h5") as file:
            last = f"state_{len(file['states/time']) - 1:06d}"
            return {part: (file[f"{part}/{places}"][:], file[f"{part}/{last}/displacement"][:])
                    for part, places in (("grains", "position"), ("mesh", "nodes")) if part in file}

    def test_a_scene_moved_by_a_thousand_kilometres(self):
        worst = 0.0
        for scene in ("tiny.json", "tiny_lattice.json"):
            path = self.folder / f"far_{scene}"
            path.write_text(json.dumps(moved_scene(scene, FAR)))
            for model in ("bridging", "edge", "dem", "continuum"):
                with self.subTest(scene=scene, model=model):
                    short = "stages[0].duration=6 ms"
                    self.run_scene(scene, f"model={model}", short, out=f"near-{scene}-{model}")
                    near = self.displacements()
                    self.run_scene(path, f"model={model}", short, out=f"far-{scene}-{model}")
                    far = self.displacements()
                    self.assertEqual(near.keys(), far.keys())
                    for part, (places, u) in near.items():
                        self.assertEqual(u.shape, far[part][1].shape)
                        worst = max(worst, numpy.abs(far[part][1] - u).max() / numpy.abs(u).max())
                        self.assertLess(numpy.abs(far[part][0] - places - FAR).max(), 1e-9)  # the user's coordinates
        self.assertLess(worst, 1e-9)
        figure("moved_difference", worst)


    def test_a_scene_too_far_away_is_refused(self):
        for far in (10**9, 10**15):
            path = self.folder / "too_far.json"
            path.write_text(json.dumps(moved_scene("tiny_lattice.json", (0, 0, far))))
            self.out = self.folder / f"too-far-{far}"
            ended = self.ended(self.coupler(path, "--dem", NOWHERE, "--continuum", NOWHERE))
            self.assertEqual(ended.status, 2, ended)
            for words in ("ground.box", "nearer to 0 in z", "move the scene"):
                self.assertIn(words, ended.error)


class Steps(SystemTest):
    def test_the_balance_goes_on_from_stage_to_stage(self):
        # damped and undamped stages have different steps; faces let go, and dead loads take their place
        stages = [{"name": "damped", "damping": 0.5, "steps": 60}, {"name": "free", "steps": 60},
                  {"name": "absorbing", "steps": 60, "faces": {"zmin": "absorbing"}}, {"name": "again", "damping": 0.3, "steps": 60}]
        worst = 0.0
        for model in ("bridging", "edge", "dem", "continuum"):
            with self.subTest(model=model):
                summary = self.run_scene("tiny_lattice.json", f"model={model}", f"stages={json.dumps(stages)}",
                                         'initial={"noise": "1e-3 m/s"}', out=model)
                worst = max(worst, summary["energy"]["balance_error"])
                with open(self.out / "energy.csv", newline="") as file:
                    head, *rows = csv.reader(file)
                jumps = [k for k, name in enumerate(head) if "step_change" in name]
                self.assertTrue(any(float(rows[-1][k]) for k in jumps))
        self.assertLess(worst, 1e-10)
        figure("stages_balance", worst)


class Limits(SystemTest):
    def test_an_element_that_turns_inside_out_is_named(self):
        # the head of the mesh is driven down through its own elements, with and without the energy ledger
        push = 'faces.zmax={"velocity": ["0 m/s", "0 m/s", "-90 m/s"]}'
        named = 0
        for measure in ("true", "false"):
            with self.subTest(measure=measure):
                self.out = self.folder / f"inverted-{measure}"
                _, address = self.engine("continuum_server")
                dem, dem_address = self.engine("dem_server")
                process = self.coupler("tiny_lattice.json", "--dem", dem_address, "--continuum", address, "--set", "model=continuum",
                                       "--set", push, "--set", f"run.measure_energy={measure}", "--set", "run.energy_tolerance=1e9",
                                       "--set", "stages[0].duration=50 ms")
                ended = self.ended(process)
                self.assertEqual(ended.status, 3, ended)
                self.assertRegex(ended.error, r"element \d+")
                self.assertIn("turned inside out", ended.error)
                named += 1
        figure("inverted_element_named", int(named == 2))

    def test_a_floor_of_zero_is_refused(self):
        refused = 0
        for floor in ("0", "-0.1", "0.6"):
            self.out = self.folder / f"floor-{floor}"
            ended = self.ended(self.coupler("tiny_lattice.json", "--dem", NOWHERE, "--continuum", NOWHERE, "--set",
                                            f"coupling.weight_floor={floor}"))
            self.assertEqual(ended.status, 2, ended)
            self.assertIn("coupling.weight_floor", ended.error)
            refused += 1
        figure("refused_floor", int(refused == 3))


if __name__ == "__main__":
    unittest.main()
