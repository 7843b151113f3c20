"""The search for stiffnesses, on a made-up packing with a known answer."""

import unittest

from fixture import LauncherTest  # noqa: F401  (puts scripts/ on the path)

from gabion_tools import calibrate_material, material_files, material_search, strength
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


if __name__ == "__main__":
    unittest.main()
