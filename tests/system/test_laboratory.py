"""Laboratory tests by the coupler and dem_server: what is written, same bits again, mistakes."""

import json
import unittest

from programs import NOWHERE, SystemTest

SCENE = {
    "gabion": 1, "model": "dem",
    "ground": {"box": [["0 m"] * 3, ["0.8 m"] * 3], "material": "seed_gravel", "periodic": ["x", "y", "z"]},
    "grains": {"radius": {"uniform": ["0.05 m", "0.1 m"]}},
    "stages": [{"name": "none", "steps": 1}],
    "laboratory": {"confinements": ["50 kPa"], "axial_strain": 0.004, "peak_inertial_number": 2e-3},
}


class Laboratory(SystemTest):
    def carry_out(self, changes=(), threads=1, out="run"):
        self.out = self.folder / out
        path = self.folder / "sample.json"
        path.write_text(json.dumps(SCENE))
        process, address = self.engine("dem_server", threads=threads)
        ended = self.ended(self.coupler(path, "--laboratory", "--dem", address, *changes), 60)
        if ended.status == 0:
            self.assertEqual(self.ended(process, 5).status, 0)
        return ended

    def test_curve_and_sample_are_written_and_come_again(self):
        ended = self.carry_out()
        self.assertEqual(ended.status, 0, ended)
        found = json.loads((self.out / "laboratory.json").read_text())
        self.assertGreater(found["elasticity"]["young"], 100e6)
        self.assertEqual(len(found["elasticity"]["stiffness"]), 6)
        (test,) = found["tests"]
        self.assertEqual(test["confinement"], 50e3)
        self.assertLess(test["energy_error"], 1e-3)
        curve = (self.out / test["curve"]).read_text()
        rows = [[float(value) for value in line.split(",")] for line in curve.splitlines()[1:]]
        self.assertEqual(len(rows), 201)  # the confined sample, 100 points to the peak, 100 beyond
        self.assertEqual(rows[0][0], 0.0)
        self.assertAlmostEqual(rows[-1][0], 0.004, delta=4e-5)
        self.assertGreater(max(row[2] for row in rows), 100e3)
        self.assertGreater(rows[-1][5], 0.0)
        again = self.carry_out(threads=2, out="again")
        self.assertEqual(again.status, 0, again)
        self.assertEqual((self.out / test["curve"]).read_text(), curve)

    def test_what_cannot_be_tested(self):
        for change, words in (("laboratory=null", "laboratory: missing"), ("ground.periodic=[\"x\"]", "ground.periodic"),
                              ("model=continuum", "model: 'continuum'"), ("gravity=[0,0,\"-9.81 m/s2\"]", "gravity"),
                              ("laboratory.confinements=[\"50\"]", "laboratory.confinements[0]")):
            with self.subTest(change=change):
                path = self.folder / "sample.json"
                path.write_text(json.dumps(SCENE | {"mesh": {"size": "0.4 m"}}))
                ended = self.ended(self.coupler(path, "--laboratory", "--dem", NOWHERE, "--set", change))
                self.assertEqual(ended.status, 2, ended)
                self.assertIn(words, ended.error)
                self.assertFalse(self.out.exists())

    def test_a_confinement_that_the_steps_do_not_reach(self):
        ended = self.carry_out(["--set", "laboratory.max_steps=400"])
        self.assertEqual(ended.status, 3, ended)
        self.assertIn("off the confinement after 400 steps", ended.error)


if __name__ == "__main__":
    unittest.main()
