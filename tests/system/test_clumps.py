"""Rigid clumps in whole runs: the same ones in every model, rigid to the end, energy accounted for, resumed bit for bit."""

import json
import unittest

import h5py
import numpy

from programs import SystemTest

SCENE = "tiny_clumps.json"
PERIOD = numpy.array([0.8, 0.8, numpy.inf])


def near(step):
    """Smallest image of differences of places."""
    return step - numpy.where(numpy.isfinite(PERIOD), PERIOD, 0) * numpy.round(step / PERIOD)


class Clumps(SystemTest):
    def clumps(self):
        """Sets of grains by their numbers in the packing, after checking that the last state left them rigid."""
        with h5py.File(self.out / "results.h5") as file:
            grains = file["grains"]
            number, clump, rest = grains["origin_id"][:], grains["clump"][:], grains["position"][:]
            last = grains[f"state_{len(file['states/time']) - 1:06d}"]
            place, spin = rest + last["displacement"][:], last["spin"][:]
        self.assertGreater(numpy.linalg.norm(place - rest, axis=1).max(), 0.003)
        for c in range(clump.max() + 1):
            members = numpy.flatnonzero(clump == c)
            self.assertGreater(len(members), 1)
            for i in members[1:]:
                before, now = near(rest[i] - rest[members[0]]), near(place[i] - place[members[0]])
                self.assertAlmostEqual(numpy.linalg.norm(before), numpy.linalg.norm(now), delta=1e-13)
                self.assertTrue((spin[i] == spin[members[0]]).all())
        return {frozenset(number[clump == c]) for c in range(clump.max() + 1)}

    def test_every_model_has_the_same_clumps(self):
        found = {}
        for model in ("dem", "bridging", "edge"):
            summary = self.run_scene(SCENE, f"model={model}", out=model)
            self.assertLess(summary["energy"]["balance_error"], 5e-3)
            self.assertGreater(summary["energy"]["dissipated"], 100)
            found[model] = self.clumps()
            self.assertEqual(summary["counters"]["clumps"], len(found[model]))
            self.assertIn(f"clumps: {len(found[model])} of ", (self.out / "run.log").read_text())
        self.assertGreater(len(found["dem"]), 20)
        self.assertEqual(found["dem"], found["bridging"])
        self.assertEqual(found["dem"], found["edge"])

    def test_same_bits_with_two_threads_and_other_bits_without_clumps(self):
        short = ("stages[0].steps=200", "stages[1].duration=5 ms")
        one, two = (self.run_scene(SCENE, *short, threads=threads, out=f"threads-{threads}") for threads in (1, 2))
        self.assertEqual(one["state_hash"], two["state_hash"])
        spheres = self.run_scene(SCENE, *short, "materials.cushion.clump_size=1", out="spheres")
        self.assertNotEqual(one["state_hash"], spheres["state_hash"])
        self.assertNotIn("clumps", spheres["counters"])
        with h5py.File(self.out / "results.h5") as file:
            self.assertNotIn("clump", file["grains"])

    def test_a_stopped_run_goes_on(self):
        long = ("stages[0].steps=6000",)
        whole = self.run_scene(SCENE, *long, out="whole")
        self.out = stopped = self.folder / "stopped"
        process = self.coupler(SCENE, *self.engines(), "--set", *long)
        self.wait_for_steps(process, 1000)
        process.terminate()
        self.assertEqual(self.ended(process).status, 130)
        self.out = self.folder / "resumed"
        ended = self.ended(self.coupler(stopped / "scene.effective.json", *self.engines(), "--resume", stopped), 60)
        self.assertEqual(ended.status, 0, ended)
        resumed = json.loads((self.out / "summary.json").read_text())
        for key in ("state_hash", "energy", "counters"):
            self.assertEqual(resumed[key], whole[key], key)

    def test_held_and_absorbing_grains_stay_single(self):
        # the whole ground of clumps, on a fixed floor that later absorbs: what touches it stays single
        changes = ["model=dem", "ground.material=cushion", "fills=[]", "block=null", "stages[0].steps=50",
                   'stages[1]={"name": "let go", "steps": 20, "faces": {"zmin": "absorbing"}}']
        summary = self.run_scene(SCENE, *changes)
        self.assertGreater(summary["counters"]["clumps"], 80)
        with h5py.File(self.out / "results.h5") as file:
            grains = file["grains"]
            floor = grains["position"][:, 2] < 1.1 * grains["radius"][:]
            self.assertTrue((grains["clump"][:][floor] == -1).all())
            self.assertGreater(floor.sum(), 10)

    def test_a_fill_at_the_border_is_refused(self):
        # whole inside the zone, but its lowest grains are tied
        self.out = self.folder / "refused"
        fill = 'fills[0].box=[["0 m","0 m","1.2 m"],["0.8 m","0.8 m","2.8 m"]]'
        ended = self.ended(self.coupler(SCENE, *self.engines(), "--set", "model=edge", "--set", fill))
        self.assertEqual(ended.status, 2, ended)
        self.assertIn("belongs to a clump", ended.error)
        self.assertIn("keep materials with clumps away from the overlap and the border", ended.error)


if __name__ == "__main__":
    unittest.main()
