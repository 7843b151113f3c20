"""Runs with elements of several rates: what is counted, where things happen, stages, refusals, resuming."""

import csv
import json
import unittest

from programs import SystemTest

# a column: grains of 0.1 m in 0.8 m, then 22 layers of elements of 0.4 m: 2 of rate 1 beyond the border, 4 each of 2 and 4
COLUMN = ['ground.box=[["0 m", "0 m", "0 m"], ["0.8 m", "0.8 m", "9.6 m"]]', "grains.packing=sc", "grains.radius=0.05 m",
          'materials={"even": {"normal_stiffness": "4e9 N/m2", "shear_stiffness": "4e9 N/m2"}}', "ground.material=even",
          'coupling.edge.zone=[["0 m", "0 m", "0 m"], ["0.8 m", "0.8 m", "0.8 m"]]',
          'coupling.bridging.zone=[["0 m", "0 m", "0 m"], ["0.8 m", "0.8 m", "1.2 m"]]', "coupling.bridging.overlap=0.8 m",
          'probes=[{"name": "middle", "at": ["0.4 m", "0.4 m", "4.8 m"]}]', "output=null"]
RATES = 'mesh.rates={"largest": 8, "layers": 4}'


def stages(*stages):
    return f"stages={json.dumps(list(stages))}"


class Rates(SystemTest):
    def rows(self, name):
        with open(self.out / name, newline="") as file:
            return list(csv.DictReader(file))

    def test_counts_and_moments(self):
        for model, per_rate in (("edge", [12, 16, 16, 44]), ("bridging", [16, 16, 16, 44])):
            summary = self.run_scene("tiny_lattice.json", *COLUMN, RATES, f"model={model}", stages({"name": "free", "steps": 203}), out=model)
            self.assertEqual(summary["step"]["count"], 208)  # a multiple of the largest rate
            self.assertEqual(list(summary["rates"]["elements"].values()), per_rate)
            self.assertEqual(summary["sizes"]["element_steps"], sum(208 // rate * count for rate, count in zip((1, 2, 4, 8), per_rate)))
            self.assertEqual(summary["sizes"]["grain_steps"], 208 * summary["sizes"]["grains"])
            self.assertLess(summary["rates"]["energy_excursion"], 0.1)
            self.assertGreater(summary["energy"]["largest"], 0.0)
            dt = summary["step"]["dt"]
            for name in ("probes.csv", "energy.csv"):
                for row in self.rows(name):
                    self.assertAlmostEqual(float(row["time [s]"]) / dt / 8, round(float(row["time [s]"]) / dt / 8), 6, name)
            self.assertEqual({int(float(row["step"])) % 8 for row in self.rows("monitor.csv")}, {0})

    def test_near_the_answer_of_one_rate(self):
        end = stages({"name": "free", "duration": "14 ms"})  # the pulse of 6 ms has passed the middle
        one = self.run_scene("tiny_lattice.json", *COLUMN, end, "model=edge", out="one")
        several = self.run_scene("tiny_lattice.json", *COLUMN, RATES, end, "model=edge", out="several")
        self.assertAlmostEqual(several["figures"]["middle"]["largest_z"] / one["figures"]["middle"]["largest_z"], 1.0, 1)
        self.assertNotEqual(several["state_hash"], one["state_hash"])
        self.assertNotIn("rates", one)

    def test_damped_stages_keep_one_rate(self):
        damped = {"name": "still", "damping": 0.7, "steps": 30}
        summary = self.run_scene("tiny_lattice.json", *COLUMN, RATES, "model=edge", stages(damped), out="damped")
        self.assertNotIn("rates", summary)
        self.assertEqual(summary["sizes"]["element_steps"], 32 * summary["sizes"]["elements"])
        both = self.run_scene("tiny_lattice.json", *COLUMN, RATES, "model=edge", stages(damped, {"name": "free", "steps": 40}), out="both")
        self.assertEqual([s["steps"] for s in both["stages"]], [32, 40])
        self.assertEqual(both["sizes"]["element_steps"], 32 * 88 + sum(40 // rate * count for rate, count in zip((1, 2, 4, 8), (12, 16, 16, 44))))

    def test_a_rate_that_is_too_large_is_refused_with_one_that_fits(self):
        for largest, fits in ((16, "the largest rate that fits is 8"), (32, "the largest rate that fits is 8")):
            self.out = self.folder / f"large-{largest}"
            rates = json.dumps({"largest": largest, "layers": 2})
            sets = [word for change in (*COLUMN, "model=edge", f"mesh.rates={rates}") for word in ("--set", change)]
            ended = self.ended(self.coupler("tiny_lattice.json", *self.engines(), *sets))
            self.assertEqual(ended.status, 2, ended)
            self.assertIn("mesh.rates.largest", ended.error)
            self.assertIn(fits, ended.error)
        summary = self.run_scene("tiny_lattice.json", *COLUMN, 'mesh.rates={"layers": 2}', "model=edge", stages({"name": "free", "steps": 8}), out="auto")
        self.assertEqual(summary["rates"]["largest"], 8)

    def test_a_killed_run_goes_on_bit_for_bit(self):
        changes = [*COLUMN, RATES, "model=edge", 'output={"monitor_steps": 48, "every": "3 ms"}', "run.checkpoint_every=0.05 s",
                   stages({"name": "still", "damping": 0.7, "steps": 1000}, {"name": "free", "steps": 9000})]
        whole = self.run_scene("tiny_lattice.json", *changes, out="whole")
        self.out = killed = self.folder / "killed"
        sets = [word for change in changes for word in ("--set", change)]
        process = self.coupler("tiny_lattice.json", *self.engines(), *sets)
        self.wait_for_steps(process, 2500)
        process.kill()
        self.ended(process)
        self.out = self.folder / "resumed"
        ended = self.ended(self.coupler(killed / "scene.effective.json", *self.engines(), "--resume", killed), 60)
        self.assertEqual(ended.status, 0, ended)
        resumed = json.loads((self.out / "summary.json").read_text())
        self.assertGreater(resumed["resumed"]["step"], 1000)
        for key in ("state_hash", "stages", "figures", "energy", "rates", "sizes"):
            self.assertEqual(resumed[key], whole[key], key)


if __name__ == "__main__":
    unittest.main()
