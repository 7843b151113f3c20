"""Whole runs of the tiny scenes: every model runs, the run folder is complete, the bits do not depend on chance."""

import csv
import json
import unittest

import h5py
import numpy

from programs import SCENARIOS, SystemTest, figure

MODELS = ("dem", "continuum", "bridging", "edge")
ALWAYS = ("summary.json", "scene.effective.json", "run.log", "monitor.csv", "energy.csv", "probes.csv", "reactions.csv",
          "results.h5", "results.xdmf")


def rows_of(path):
    with open(path, newline="") as file:
        return list(csv.reader(file))


class Models(SystemTest):
    def check_folder(self, summary, model):
        grains, mesh = model != "continuum", model != "dem"
        for name in ALWAYS + ("counters.csv", "grains.vtkhdf") * grains + ("mesh.vtkhdf",) * mesh:
            self.assertTrue((self.out / name).is_file(), name)
        self.assertEqual([p.name for p in self.out.glob("*.tmp")], [])
        for path in self.out.glob("*.csv"):
            head, *rows = rows_of(path)
            self.assertTrue(rows, path.name)
            self.assertEqual({len(row) for row in rows}, {len(head)}, path.name)
            if path.name != "monitor.csv":
                self.assertTrue(numpy.isfinite([[float(x) for x in row] for row in rows]).all(), path.name)
        with h5py.File(self.out / "results.h5") as file:
            last = len(file["states/time"]) - 1
            self.assertAlmostEqual(file["states/time"][last], summary["step"]["time"], delta=1e-12)
            self.assertEqual(file["states/step"][last], summary["step"]["count"])
            for part, points, there in (("grains", "position", grains), ("mesh", "nodes", mesh)):
                self.assertEqual(part in file, there)
                if there:
                    u = file[f"{part}/state_{last:06d}/displacement"][:]
                    self.assertEqual(u.shape, file[f"{part}/{points}"].shape)
                    self.assertTrue(numpy.isfinite(u).all() and numpy.abs(u).max() > 0)
        self.assertEqual(summary["model"], model)
        self.assertEqual(summary["sizes"]["grains"] > 0, grains)
        self.assertEqual(summary["sizes"]["elements"] > 0, mesh)

    def check_scene(self, scene, tolerance):
        for model in MODELS:
            with self.subTest(model=model):
                summary = self.run_scene(scene, f"model={model}", out=model)
                self.check_folder(summary, model)
                self.assertLess(summary["energy"]["balance_error"], tolerance)
                if model in ("bridging", "edge"):
                    self.assertLess(summary["energy"]["multiplier_work_residual"], 1e-12)
                    self.assertEqual(summary["interface"]["rank"], summary["interface"]["rows"])

    def test_every_model_of_the_lattice(self):
        # frozen contacts and bricks are linear: the leapfrog conserves their energy to round-off
        self.check_scene("tiny_lattice.json", 1e-9)

    def test_every_model_of_the_random_packing(self):
        self.check_scene("tiny.json", 1e-4)

    def test_effective_scene_gives_the_same_bits(self):
        first = self.run_scene("tiny_lattice.json", out="first")
        again = self.run_scene(self.out / "scene.effective.json", out="again")
        self.assertEqual(first["state_hash"], again["state_hash"])

    def test_same_bits_again_and_with_two_threads(self):
        for scene in ("tiny.json", "tiny_lattice.json"):
            for model in ("bridging", "edge"):
                with self.subTest(scene=scene, model=model):
                    runs = [self.run_scene(scene, f"model={model}", "stages[0].duration=6 ms", threads=threads,
                                           out=f"{scene}-{model}-{k}") for k, threads in enumerate((1, 1, 2))]
                    hashes = [json.dumps(run["state_hash"], sort_keys=True) for run in runs]
                    self.assertEqual(set(hashes), {hashes[0]})

    def test_the_hash_sees_a_small_change(self):
        change = 'faces.zmax={"pressure": {"half_sine": {"amplitude": "100.000000001 kPa", "duration": "6 ms"}}}'
        plain, changed = self.run_scene("tiny_lattice.json", out="plain"), self.run_scene("tiny_lattice.json", change, out="changed")
        self.assertNotEqual(plain["state_hash"]["continuum"], changed["state_hash"]["continuum"])

    def test_grains_begin_where_another_run_left_them(self):
        # displacements and rotations of a strained lattice, brought back: the contacts bear the same forces
        still = 'stages=[{"name": "look", "steps": 1}]'
        fields = 'output={"fields": ["rotation", "contact_force", "jump", "multiplier"]}'
        changes = ["initial={\"strain\": [0, 0, 1e-5, 0, 0, 0]}", "faces={}", still, fields]
        self.run_scene("tiny_lattice.json", "model=dem", *changes, out="first")
        first = self.out / "results.h5"
        changes[0] = f'initial={{"strain": [0, 0, 1e-5, 0, 0, 0], "state": "{first}"}}'
        self.run_scene("tiny_lattice.json", *changes, out="second")
        with h5py.File(first) as old, h5py.File(self.out / "results.h5") as new:
            known = dict(zip(old["grains/origin_id"][:], old["grains/state_000001/displacement"][:]))
            for name, u in zip(new["grains/origin_id"][:], new["grains/state_000000/displacement"][:]):
                self.assertTrue((known[name] == u).all())
            contacts = new["contacts/state_000000"]
            self.assertEqual(contacts["force"].shape, contacts["normal"].shape)
            self.assertEqual(len(contacts["grains"]), len(contacts["force"]))
            rows = len(new["interface/position"])
            for field in ("jump", "multiplier_force"):
                self.assertEqual(new[f"interface/state_000001/{field}"].shape, (rows, 3))
            # the mesh is strained alike: after one step grains and mesh are still together
            self.assertLess(numpy.abs(new["interface/state_000001/jump"][:]).max(), 1e-9)
        # a path in a scene counts from the scene's folder, and the effective scene can be run from its own
        scene = self.folder / "scenes" / "tiny_lattice.json"
        scene.parent.mkdir()
        scene.write_text((SCENARIOS / "tiny_lattice.json").read_text())
        changes[0] = changes[0].replace(str(first), "../first/results.h5")
        relative = self.run_scene(scene.relative_to(self.folder), *changes, out="relative")
        again = self.run_scene(self.out / "scene.effective.json", out="again")
        self.assertEqual(relative["state_hash"], again["state_hash"])
        self.out = self.folder / "third"
        ended = self.ended(self.coupler("tiny_lattice.json", "--check", "--set", 'initial.state="nowhere.h5"'))
        self.assertEqual(ended.status, 2, ended)
        self.assertIn("initial.state", ended.error)

    def test_displacements_are_zeroed(self):
        stages = 'stages=[{"name": "one", "steps": 100}, {"name": "two", "steps": 1, "zero_displacements": true}]'
        self.run_scene("tiny_lattice.json", stages, "output={}")
        with h5py.File(self.out / "results.h5") as file:
            for part in ("grains", "mesh"):
                before, after = (file[f"{part}/state_{k:06d}/displacement"][:] for k in (1, 2))
                self.assertTrue((file[f"{part}/state_000002/zeroed_displacement"][:] == before).all())
                self.assertLess(numpy.abs(after).max(), 0.1 * numpy.abs(before).max())
        last = [float(x) for x in rows_of(self.out / "probes.csv")[-1]]
        self.assertEqual(set(last[1:]), {0.0}, "the first sample of the stage is its zero")

    def test_probes_now_and_then(self):
        self.run_scene("tiny_lattice.json", 'stages=[{"name": "one", "steps": 100}]', "output.probe_every=1 ms", out="rare")
        times = [float(row[0]) for row in rows_of(self.out / "probes.csv")[1:]]
        self.assertGreater(len(times), 5)
        self.assertTrue(all(0.8e-3 < b - a < 1.2e-3 for a, b in zip(times, times[1:])), times)

    def test_a_damaged_overlap_is_reported(self):
        sound = self.run_scene("tiny.json", out="sound")
        self.assertEqual((sound["warnings"], sound["interface"]["largest_damaged_share"]), ([], 0))
        weak = self.run_scene("tiny.json", "ground.material=seed_gravel", "faces.zmax.pressure.half_sine.amplitude=300 kPa", out="weak")
        self.assertGreater(weak["interface"]["largest_damaged_share"], 0.01)
        figure("damaged_share", weak["interface"]["largest_damaged_share"])
        self.assertIn("slid or broke", weak["warnings"][0])

    def test_two_stages_follow_one_another(self):
        stages = 'stages=[{"name": "still", "damping": 0.7, "steps": 30}, {"name": "free", "steps": 20}]'
        summary = self.run_scene("tiny_lattice.json", stages)
        self.assertEqual([(s["name"], s["steps"]) for s in summary["stages"]], [("still", 30), ("free", 20)])
        self.assertEqual(summary["step"]["count"], 50)


if __name__ == "__main__":
    unittest.main()
