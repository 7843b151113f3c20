"""Checkpoints: a run that was killed goes on from one and ends with the bits of the run that nobody disturbed."""

import json

import unittest

from programs import NOWHERE, SystemTest

SETTLED, STEPS = 1000, 9000
# Everything a checkpoint must carry: faces that let go and absorb, dead loads, zeroed displacements, a block.
STAGES = [
    {"name": "settle", "damping": 0.69, "steps": SETTLED},
    {"name": "impact", "damping": 0, "steps": STEPS, "zero_displacements": True,
     "faces": {"zmin": "absorbing", "xmin": "absorbing"}},
]
BLOCK = {"side": "0.3 m", "mass": "40 kg", "velocity": "2 m/s", "position": ["0.4 m", "0.4 m"]}
CHANGES = ["gravity=[\"0\", \"0\", \"-9.81 m/s2\"]", "faces.zmax=free", f"stages={json.dumps(STAGES)}",
           "output={\"monitor_steps\": 50, \"every\": \"2 ms\"}", "run.checkpoint_every=0.05 s", "run.energy_tolerance=1"]

WEAK = {"normal_stiffness": "3.78e9 N/m2", "shear_stiffness": "1.13e9 N/m2", "friction": 0.4, "rolling_stiffness": 0.5,
        "normal_strength": "1e4 N/m2", "shear_strength": "1e4 N/m2", "rolling_friction": 0.1, "restitution": 0.5}


class Resume(SystemTest):
    material = []

    def changes(self, model):
        block = [f"block={json.dumps(BLOCK)}"] if model == "dem" else []  # the tiny zone's top is the mesh's in the others
        return [*CHANGES, f"model={model}", *block, *self.material]

    def kill_one(self, model):
        """A run killed in its second stage, at some time after a checkpoint; its folder."""
        self.out = self.folder / "killed"
        addresses = self.engines()
        sets = [word for change in self.changes(model) for word in ("--set", change)]
        process = self.coupler("tiny.json", *addresses, *sets)
        self.wait_for_steps(process, SETTLED + 1500)
        process.kill()
        self.ended(process)
        self.assertTrue((self.out / "checkpoint").is_file())
        self.assertEqual([p.name for p in self.out.glob("*.tmp") if p.name != "checkpoint.tmp"], [])
        return self.out

    def go_on(self, killed, *arguments, status=0):
        self.out = self.folder / "resumed"
        ended = self.ended(self.coupler(killed / "scene.effective.json", *self.engines(), "--resume", killed, *arguments), 60)
        self.assertEqual(ended.status, status, ended)
        return ended

    def check(self, model):
        whole = self.run_scene("tiny.json", *self.changes(model), out="whole")
        killed = self.kill_one(model)
        self.go_on(killed)
        resumed = json.loads((self.out / "summary.json").read_text())
        self.assertGreater(resumed["resumed"]["step"], SETTLED)
        self.assertLess(resumed["resumed"]["step"], SETTLED + STEPS)
        for key in ("state_hash", "scene", "stages", "figures", "energy", "counters"):
            self.assertEqual(resumed.get(key), whole.get(key), key)
        tail = (self.out / "probes.csv").read_text().splitlines()[1:]
        self.assertTrue((self.folder / "whole" / "probes.csv").read_text().endswith("\n".join(tail) + "\n"))

    def test_bridging(self):
        self.check("bridging")

    def test_edge(self):
        self.check("edge")

    def test_grains_alone_with_a_block(self):
        self.check("dem")

    def test_grains_that_break_roll_and_bounce(self):
        self.material = [f"materials={json.dumps({'weak': WEAK})}", "ground.material=weak"]
        self.check("dem")

    def test_an_interrupted_run_says_where_to_go_on(self):
        self.out = self.folder / "stopped"
        process = self.coupler("tiny.json", *self.engines(), "--set", "stages[0].duration=1000 s")
        self.wait_for_steps(process)
        process.terminate()
        ended = self.ended(process)
        self.assertEqual(ended.status, 130, ended)
        self.assertRegex(ended.error, r"last checkpoint: step \d+ in .*checkpoint; go on with gabion resume")
        self.assertTrue((self.out / "checkpoint").is_file())

    def test_what_cannot_be_resumed(self):
        killed = self.kill_one("bridging")
        for scene, *changes in (["tiny.json"], [killed / "scene.effective.json", "--set", "grains.seed=2"]):
            self.out = self.folder / "other"
            ended = self.ended(self.coupler(scene, "--dem", NOWHERE, "--continuum", NOWHERE, "--resume", killed, *changes))
            self.assertEqual(ended.status, 2, ended)
            self.assertIn("is of another scene", ended.error)
        (killed / "checkpoint").write_bytes(b"no checkpoint")
        ended = self.go_on(killed, status=2)
        self.assertIn("is not a checkpoint", ended.error)
        (killed / "checkpoint").unlink()
        ended = self.go_on(killed, status=2)
        self.assertIn("no checkpoint at", ended.error)


if __name__ == "__main__":
    unittest.main()
