"""The search for stiffnesses, on a made-up packing with a known answer."""

import math
import tempfile
import unittest
from pathlib import Path

from fixture import LauncherTest  # noqa: F401  (puts scripts/ on the path)

from gabion_tools import material_files, material_search, strength
from gabion_tools import stiffness_search as search
from gabion_tools.errors import Failure, UserError
from gabion_tools.quantities import pressure


def packing(normal, shear):
    """Walton's estimate of nu for a random packing, and a modulus in proportion to k_n."""
    ratio = shear / normal
    return 0.11 * normal * (2 + 3 * ratio) / (4 + ratio), (1 - ratio) / (4 + ratio)


class CalibrateTest(unittest.TestCase):
    def test_both_targets_are_met(self):
        for young, poisson in ((500e6, 0.2), (196e6, 0.1), (80e6, 0.235)):
            with self.subTest(young=young, poisson=poisson):
                normal, shear, found = search.search(packing, young, poisson)
                self.assertAlmostEqual(found[0] / young, 1.0, delta=search.YOUNG_TOLERANCE)
                self.assertAlmostEqual(found[1], poisson, delta=search.POISSON_TOLERANCE)
                self.assertEqual(packing(normal, shear), found)

    def test_a_ratio_out_of_reach_says_what_is_in_reach(self):
        with self.assertRaisesRegex(Failure, "0.36 is out of reach of this packing: 0.0000 .* 0.2438"):
            search.search(packing, 500e6, 0.36)

    def test_pressures(self):
        self.assertEqual(pressure("500 MPa"), 500e6)
        self.assertEqual(pressure("1.5e2kPa"), 150e3)
        for text in ("500", "x MPa", "-3 MPa", "5 MN"):
            with self.assertRaises(UserError):
                pressure(text)


def curve(confinement, peak, residual, end=0.1, points=201):
    """A made-up test: peak at 0.1 % of strain, residual from 1 %, volume strain -0.6 of the axial one beyond the peak."""
    made = []
    for k in range(points):
        strain = end * k / (points - 1)
        fall = min(1.0, max(0.0, (strain - 0.001) / 0.009))
        q = peak * strain / 0.001 if strain < 0.001 else peak + (residual - peak) * fall
        made.append({"axial_strain": strain, "volume_strain": -0.6 * max(0.0, strain - 0.001), "q": q, "sigma_1": confinement + q,
                     "sigma_3": confinement, "broken_bonds": float(k)})
    return made


class StrengthTest(unittest.TestCase):
    def test_figures_of_a_curve(self):
        found = strength.figures(curve(50e3, 140e3, 110e3))
        self.assertAlmostEqual(found["peak"]["q"], 140e3, delta=1e3)
        self.assertAlmostEqual(found["residual"]["q"], 110e3, delta=1.0)
        self.assertTrue(found["residual"]["steady"])
        # sin psi = 0.6/2.6
        self.assertAlmostEqual(found["dilation_angle"], 13.342, delta=0.01)
        self.assertAlmostEqual(found["secant_modulus_at_half_peak"], 140e6, delta=1e6)

    def test_a_residual_that_still_falls_is_not_steady(self):
        falling = curve(50e3, 140e3, 110e3)
        for point in falling:
            point["q"] *= 1.0 - 6.0 * point["axial_strain"]
        self.assertFalse(strength.figures(falling)["residual"]["steady"])

    def test_envelope_of_a_mohr_coulomb_material(self):
        phi, c = math.radians(31.0), 12e3
        ratio = (1 + math.sin(phi)) / (1 - math.sin(phi))
        found = strength.envelope([(s3, ratio * s3 + 2 * c * math.sqrt(ratio)) for s3 in (20e3, 50e3, 100e3)])
        self.assertAlmostEqual(found["friction_angle"], 31.0, places=9)
        self.assertAlmostEqual(found["cohesion"], 12e3, places=5)
        # the reference study's own points: 27.4 degrees and 16.1 kPa
        found = strength.envelope([(20e3, 114e3), (50e3, 177.5e3), (100e3, 328e3)])
        self.assertAlmostEqual(found["friction_angle"], 27.4, delta=0.05)
        self.assertAlmostEqual(found["cohesion"], 16.1e3, delta=50.0)
        self.assertAlmostEqual(strength.envelope([(50e3, 150e3)])["friction_angle"], 30.0, places=9)


class MaterialSearchTest(unittest.TestCase):
    def test_root_of_a_rising_and_a_falling_function(self):
        for sign in (1.0, -1.0):
            calls = []

            def miss(x):
                calls.append(x)
                return sign * (25.0 + 12.0 * math.log(x / 0.3) - 35.0)

            value, found = material_search.root(miss, 0.1, 2.0, 0.1, 12)
            self.assertLessEqual(abs(found), 0.1)
            self.assertAlmostEqual(value, 0.3 * math.exp(10.0 / 12.0), delta=0.01)
            self.assertLessEqual(len(calls), 12)

    def test_the_number_of_measurements_is_bounded_and_the_best_is_kept(self):
        tried = []

        def miss(x):
            tried.append((abs(x ** 9 - 0.5), x))
            return x ** 9 - 0.5

        value, _ = material_search.root(miss, 0.0, 1.0, 1e-12, 5)
        self.assertEqual(len(tried), 5)
        self.assertEqual(value, min(tried)[1])

    def test_out_of_reach_says_how_far(self):
        with self.assertRaisesRegex(Failure, "missed by -3 at 0.1 and by -1.1 at 2"):
            material_search.root(lambda x: x - 3.1, 0.1, 2.0, 0.01, 8)

    def test_changed_parameters_keep_their_units(self):
        gravel = material_files.load("seed_gravel")[1]
        self.assertEqual(material_files.changed(gravel, "stiffness_ratio", 0.5)["shear_stiffness"], "8.85e+08 N/m2")
        self.assertEqual(material_files.changed(gravel, "bond_strength", 2.0)["normal_strength"], "356000 N/m2")
        self.assertEqual(material_files.changed(gravel, "friction", 0.5)["friction"], 0.5)
        self.assertEqual(material_files.changed(gravel, "density", 2700)["density"], "2700 kg/m3")

    def test_a_written_material_can_be_read(self):
        path = self.folder() / "found.json"
        material_files.write(path, {"normal_stiffness": "1e9 N/m2", "shear_stiffness": "1e8 N/m2"}, ["one", "two"])
        self.assertEqual(material_files.load(str(path)), ("found", {"normal_stiffness": "1e9 N/m2", "shear_stiffness": "1e8 N/m2"}))

    def folder(self):
        keeper = tempfile.TemporaryDirectory()
        self.addCleanup(keeper.cleanup)
        return Path(keeper.name)


class MistakeTest(LauncherTest):
    def test_one_clear_message_and_code_2(self):
        for words, text in (
                (["seed_gravle"], "did you mean seed_gravel"),
                (["triaxial"], "'triaxial' is a scene; give --young and --poisson"),
                (["seed_gravel", "--tests", "elastik"], "did you mean elastic"),
                (["seed_gravel", "--confinements", "20"], "expected a pressure"),
                (["seed_gravel", "--confinements", "20 kPa,20 kPa"], "given twice"),
                (["seed_gravel", "--grains", "10"], "--grains 10: expected 100"),
                (["seed_gravel", "--seeds", "0"], "--seeds 0"),
                (["seed_gravel", "--target", "frictionangle=30"], "did you mean friction_angle"),
                (["seed_gravel", "--target", "friction_angle"], "expected NAME=VALUE"),
                (["seed_gravel", "--target", "friction_angle=30,cohesion=1 kPa"], "one parameter is varied"),
                (["seed_gravel", "--target", "poisson=0.3"], "needs young"),
                (["seed_gravel", "--target", "friction_angle=30", "--vary", "frction"], "no number to vary"),
                (["seed_gravel", "--target", "friction_angle=30", "--between", "1"], "two rising numbers"),
                (["seed_soil", "--target", "cohesion=9 kPa", "--between", "1,2"], "'infinite', which is no number"),
                (["seed_gravel", "--vary", "friction"], "--vary needs a --target"),
                (["seed_gravel", "--tests", "elastic", "--target", "friction_angle=30"], "needs triaxial"),
                (["seed_gravel", "--young", "1 GPa"], "both --young and --poisson"),
                (["seed_gravel", "--out", "found.json"], "where --target is given"),
        ):
            with self.subTest(words=words):
                done = self.launch("calibrate", *words)
                self.assertEqual(done.returncode, 2, done.stderr)
                self.assertIn(text, done.stderr)
                self.assertEqual(len(done.stderr.strip().splitlines()), 1)
                self.assertEqual(done.stdout, "")
        self.assertEqual(self.started(), {})


if __name__ == "__main__":
    unittest.main()
