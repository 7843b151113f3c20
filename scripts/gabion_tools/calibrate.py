"""gabion calibrate: contact stiffnesses for a wanted modulus and Poisson's ratio, measured on the scene's packing.

Contact stiffnesses are not constants of a material: they hold for the packing that they were found on.
"""

import json
import re

from gabion_tools import build, measuring, scenes
from gabion_tools.errors import Failure, UserError

PREFIXES = {"": 1.0, "k": 1e3, "M": 1e6, "G": 1e9}
FIRST_NORMAL = 3.78e9           # N/m2, only a start
RATIOS = (0.02, 1.0)            # k_s over k_n that are tried
POISSON_TOLERANCE = 0.002
YOUNG_TOLERANCE = 0.002         # relative
MOST_MEASUREMENTS = 12


def arguments(parser):
    parser.add_argument("scene", help="scene whose ground is packed: file, or name of one of scenarios/")
    parser.add_argument("--young", required=True, metavar="PRESSURE", help="wanted modulus, as in '500 MPa'")
    parser.add_argument("--poisson", required=True, type=float, help="wanted Poisson's ratio")
    parser.add_argument("--set", action="append", default=[], metavar="KEY=VALUE", dest="overrides",
                        help="change one value of the scene; may be repeated")
    parser.add_argument("--threads", type=int, help="threads of the engine")
    parser.add_argument("--yes", action="store_true", help="install missing packages without asking")


def pressure(text):
    found = re.fullmatch(r"\s*([-+.\deE]+)\s*([kMG]?)Pa\s*", text)
    try:
        value = float(found[1]) * PREFIXES[found[2]]
    except (TypeError, ValueError):
        raise UserError(f"--young '{text}': expected a pressure such as '500 MPa'") from None
    if value <= 0.0:
        raise UserError(f"--young '{text}': must be positive")
    return value


def search(measure, young, poisson, say=lambda *_: None):
    """(normal, shear, measured) with measure(normal, shear) -> (young, poisson) that meets both.

    Poisson's ratio depends on k_s/k_n alone and falls with it; the modulus is proportional to both. So the ratio is
    found first (Illinois method between RATIOS), then everything is scaled.
    """
    count = 0

    def at(normal, ratio):
        nonlocal count
        count += 1
        found = measure(normal, ratio * normal)
        say(count, normal, ratio, found)
        return found

    low, high = RATIOS
    at_low, at_high = at(FIRST_NORMAL, low), at(FIRST_NORMAL, high)
    if not at_high[1] <= poisson <= at_low[1]:
        raise Failure(f"Poisson's ratio {poisson:g} is out of reach of this packing: {at_high[1]:.4f} with k_s = k_n, "
                      f"{at_low[1]:.4f} with k_s = {low:g} k_n. Change contacts_per_grain or solid_fraction")
    miss_low, miss_high, last = at_low[1] - poisson, at_high[1] - poisson, 0
    while count < MOST_MEASUREMENTS:
        ratio = (low * miss_high - high * miss_low) / (miss_high - miss_low)
        found = at(FIRST_NORMAL, ratio)
        miss = found[1] - poisson
        if abs(miss) <= POISSON_TOLERANCE / 2:
            break
        if miss > 0:
            low, miss_low, miss_high = ratio, miss, miss_high * (0.5 if last > 0 else 1.0)
        else:
            high, miss_high, miss_low = ratio, miss, miss_low * (0.5 if last < 0 else 1.0)
        last = miss
    normal = FIRST_NORMAL * young / found[0]
    found = at(normal, ratio)
    if abs(found[0] / young - 1) > YOUNG_TOLERANCE or abs(found[1] - poisson) > POISSON_TOLERANCE:
        raise Failure(f"not reached after {count} measurements: E {found[0] / 1e6:.2f} MPa, nu {found[1]:.4f}")
    return normal, ratio * normal, found


def main(options):
    scene = scenes.find(options.scene)
    scenes.override_arguments(options.overrides)
    young = pressure(options.young)
    if not 0.0 < options.poisson < 0.5:
        raise UserError(f"--poisson {options.poisson:g}: must lie between 0 and 0.5")
    build.ensure(options.yes)

    def measure(normal, shear):
        found = measuring.elasticity(scene, [*options.overrides, *measuring.material("calibrated", normal, shear)],
                                     options.threads)
        return found["young"], found["poisson"]

    def say(count, normal, ratio, found):
        print(f"{count:2}  k_n {normal:.4e} R N/m  k_s/k_n {ratio:.4f}  E {found[0] / 1e6:8.2f} MPa  nu {found[1]:.4f}",
              flush=True)

    normal, shear, _ = search(measure, young, options.poisson, say)
    print(json.dumps({"normal_stiffness": f"{normal:.5g} N/m2", "shear_stiffness": f"{shear:.5g} N/m2"}))
    return 0
