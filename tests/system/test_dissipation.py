"""Rolling resistance, contact damping and locked grains by the keys of a material, in whole runs of the tiny scene."""

import csv
import json
import unittest

from programs import SystemTest

WEAK = {"normal_stiffness": "3.78e9 N/m2", "shear_stiffness": "1.13e9 N/m2", "friction": 0.4,
        "normal_strength": "1e4 N/m2", "shear_strength": "1e4 N/m2"}
LOSSY = WEAK | {"rolling_stiffness": 0.5, "rolling_friction": 0.1, "restitution": 0.5}
LOCKED = LOSSY | {"rotation": "locked"}
FILL = 'fills=[{"box": [["0 m","0 m","0 m"],["0.4 m","0.8 m","2.4 m"]], "material": "locked"}]'


def changes(model, soil, **others):
    materials = {"soil": soil} | others
    return [f"model={model}", "materials=" + json.dumps(materials), "ground.material=soil",
            'output={"monitor_steps": 20, "every": "5 ms"}']


class Dissipation(SystemTest):
    def losses(self):
        with open(self.out / "energy.csv", newline="") as file:
            last = list(csv.DictReader(file))[-1]
        return {name: float(last[f"grains {name} [J]"]) for name in ("friction", "rolling", "contact_damping", "broken_bonds")}

    def test_all_three_in_every_model_with_grains(self):
        for model in ("dem", "bridging", "edge"):
            with self.subTest(model=model):
                summary = self.run_scene("tiny.json", *changes(model, LOSSY, locked=LOCKED), FILL, out=model)
                self.assertLess(summary["energy"]["balance_error"], 1e-3)
                largest = summary["energy"]["largest"] if "largest" in summary["energy"] else 0.0
                for name, loss in self.losses().items():
                    self.assertGreater(loss, 1e-4 * largest, name)
                self.assertGreater(summary["counters"]["broken"], 100)

    def test_same_bits_with_two_threads_and_none_of_it_by_default(self):
        lossy = changes("bridging", LOSSY, locked=LOCKED) + [FILL]
        one = self.run_scene("tiny.json", *lossy, out="one")
        two = self.run_scene("tiny.json", *lossy, threads=2, out="two")
        self.assertEqual(one["state_hash"], two["state_hash"])
        off = WEAK | {"rolling_stiffness": 0.5, "rolling_friction": 0, "restitution": 1, "rotation": "free"}
        plain = self.run_scene("tiny.json", *changes("bridging", WEAK), out="plain")
        self.assertEqual(self.losses()["rolling"], 0.0)
        self.assertEqual(self.losses()["contact_damping"], 0.0)
        self.assertEqual(self.run_scene("tiny.json", *changes("bridging", off), out="off")["state_hash"], plain["state_hash"])
        self.assertNotEqual(one["state_hash"], plain["state_hash"])


if __name__ == "__main__":
    unittest.main()
