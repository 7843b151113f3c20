"""What zone = auto makes of what a quick run showed, and the points of the benchmark."""

import math
import sys
import unittest
from pathlib import Path
from types import SimpleNamespace

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "scripts"))

import numpy as np  # noqa: E402

from gabion_tools import bench_points, zone_size, zone_yield  # noqa: E402


def sizing(target=0.03, fills=(), block=None, model="bridging", half=10.0):
    """A ground of 20 x 20 x 10 m with grains of 0.2 m."""
    one = zone_size.Sizing.__new__(zone_size.Sizing)
    one.model, one.diameter, one.target, one.density = model, 0.2, target, 120.0
    one.places = 4
    one.ground = [[-half, -half, -half], [half, half, 0.0]]
    one.values = {"fills": [{"box": b} for b in fills], "block": block}
    return one


def seen(box=None, frequency=None):
    return {"box": box, "diameter": 0.3, "grains": 30000, "yielded": 0.1, "frequency": frequency, "shear_speed": 350.0}


YIELDS = [[-2.0, -2.0, -2.0], [2.0, 2.0, 0.0]]


class ZoneChoice(unittest.TestCase):
    def test_covers_what_yields_with_a_margin_and_the_overlap(self):
        choice = sizing().choose(seen(YIELDS))
        self.assertAlmostEqual(choice["element"], 0.5)
        self.assertAlmostEqual(choice["overlap"], 1.0)
        self.assertAlmostEqual(choice["zone"][0][0], -3.2)
        self.assertAlmostEqual(choice["zone"][0][2], -3.2)
        self.assertEqual(choice["zone"][1][2], 0.0)  # the free surface

    def test_a_finer_target_has_a_wider_overlap(self):
        self.assertAlmostEqual(sizing(target=0.01).choose(seen(YIELDS))["overlap"], 2.0)

    def test_an_impact_needs_less_overlap_than_other_loads(self):
        block = {"side": "1 m", "position": ["0 m", "0 m"], "velocity": "10 m/s"}
        self.assertAlmostEqual(sizing(block=block).choose(seen(YIELDS))["overlap"], 0.5)
        self.assertAlmostEqual(sizing(block=block, target=0.02).choose(seen(YIELDS))["overlap"], 1.0)

    def test_fills_are_covered_where_nothing_yields(self):
        choice = sizing(fills=[[["-3 m", "-1 m", "-1 m"], ["3 m", "1 m", "0 m"]]]).choose(seen())
        self.assertAlmostEqual(choice["zone"][0][0], -3.0 - 0.2 - 1.0)
        self.assertAlmostEqual(choice["zone"][0][1], -1.0 - 0.2 - 1.0)

    def test_edge_has_no_overlap(self):
        choice = sizing(model="edge").choose(seen(YIELDS))
        self.assertAlmostEqual(choice["zone"][1][0], 2.2)
        self.assertNotIn("coupling.edge.overlap", " ".join(choice["changes"]))

    def test_nothing_that_needs_grains_becomes_a_mesh(self):
        self.assertEqual(sizing().choose(seen())["changes"], ["model=continuum"])

    def test_a_zone_as_large_as_the_ground_becomes_all_grains(self):
        self.assertEqual(sizing(half=3.5).choose(seen(YIELDS))["changes"], ["model=dem"])

    def test_means_of_a_grain_size_curve_count_grains(self):
        curve = {"sieve": [["0.1 m", 0], ["0.14 m", 0.7], ["0.2 m", 1]]}
        radius = np.linspace(0.1, 0.2, 200001)
        number = np.where(radius < 0.14, 0.7 / 0.04, 0.3 / 0.06) / radius ** 3
        self.assertAlmostEqual(zone_size.mean_radius(curve), np.average(radius, weights=number), 6)
        self.assertAlmostEqual(zone_size.mean_cube(curve), np.average(radius ** 3, weights=number), 7)
        self.assertAlmostEqual(zone_size.mean_cube({"uniform": ["0.1 m", "0.2 m"]}), np.mean(radius ** 3), 7)

    def test_far_places_and_odd_diameters_keep_their_digits(self):
        one = sizing(model="edge")
        one.ground = [[4468190.0, -10.0, -10.0], [4468210.0, 10.0, 0.0]]
        one.diameter = 0.33333335
        choice = one.choose(seen([[4468198.0, -2.0, -2.0], [4468202.0, 2.0, 0.0]]))
        self.assertAlmostEqual(choice["zone"][0][0], 4468198.0 - one.diameter, 3)
        self.assertIn("4468197.6667 m", choice["changes"][0])
        self.assertGreaterEqual(choice["element"], 2.5 * one.diameter)


class YieldBox(unittest.TestCase):
    def test_finds_the_box(self):
        random = np.random.default_rng(1)
        place = random.uniform([-6, -6, -6], [6, 6, 0], (40000, 3))
        inside = np.all((place > [-2, -1, -2]) & (place < [2, 1, 0]), axis=1)
        low, high = zone_yield.yield_box(place, np.where(inside, 0.9, 0.0), 0.3, 0.01)
        for found, true in zip(low + high, [-2, -1, -2, 2, 1, 0]):
            self.assertLess(abs(found - true), 0.16)

    def test_a_load_on_few_grains_is_followed(self):
        random = np.random.default_rng(2)
        place = random.uniform([-3, -3, -3], [3, 3, 0], (2000, 3))  # slabs of half a diameter under the load hold few grains
        reach = np.linalg.norm(place, axis=1)
        for top in (0.9, 0.3):  # the second: no grain loses half of its contacts
            low, high = zone_yield.yield_box(place, np.where(reach < 1.0, top * (1.0 - reach), 0.0), 0.4, 0.01)
            for found in (*low, *high[:2]):
                self.assertTrue(0.35 < abs(found) < 1.5, (low, high))

    def test_none_where_nothing_yields(self):
        self.assertIsNone(zone_yield.yield_box(np.zeros((10, 3)), np.zeros(10), 0.3, 0.01))

    def test_frequency_of_a_half_sine(self):
        time = np.arange(0.0, 0.4, 1e-3)
        slow = zone_yield.frequency(time, np.sin(2 * np.pi * 10 * time))
        self.assertAlmostEqual(slow, 10.0, delta=5.0)


def point(label, error, counts, wall=1.0, model="bridging"):
    return bench_points.Point("scene", label, "knob", model, {"error": [error]}, counts, 0, counts, wall, 1, 0, 1)


class Points(unittest.TestCase):
    def test_steps_are_counted_as_the_run_says(self):
        run = SimpleNamespace(model="edge", summary={"sizes": {"grains": 10, "elements": 100, "element_steps": 300}, "step": {"count": 5},
                                                     "wall": {"stepping": 2.0}})
        one = bench_points.measured("scene", "label", "knob", [run], {"force": [-0.02]}, 0.5)
        self.assertEqual(one.counts, 10 * 5 + 0.5 * 300)
        self.assertEqual(one.error, 0.02)

    def test_the_worst_part_and_its_standard_error_count(self):
        one = bench_points.Point("s", "l", "k", "edge", {"a": [0.01, -0.01], "b": [0.02, 0.04]}, 1, 0, 1, 1, 1, 0, 1)
        self.assertAlmostEqual(one.error, 0.03)
        self.assertAlmostEqual(one.uncertainty, 0.01)

    def test_front_and_speedup(self):
        points = [point("cheap", 0.1, 1), point("best", 0.005, 5), point("beaten", 0.02, 6), point("middle", 0.02, 2)]
        cost = lambda p: p.counts  # noqa: E731
        self.assertEqual([p.label for p in bench_points.front(points, cost)], ["cheap", "middle", "best"])
        whole = point("all grains", 0.0, 100, model="dem")
        factor, chosen = bench_points.speedup([whole, *points], whole, 0.03, cost)
        self.assertEqual((factor, chosen.label), (50.0, "middle"))
        self.assertEqual(bench_points.speedup([whole], whole, 0.03, cost), (None, None))
        self.assertEqual(bench_points.speedup(points, whole, 0.03, cost, ("edge",)), (None, None))

    def test_one_packing_has_no_standard_error(self):
        self.assertTrue(math.isnan(point("one", 0.1, 1).uncertainty))


if __name__ == "__main__":
    unittest.main()
