"""Contact stiffnesses for a wanted modulus and Poisson's ratio."""

from gabion_tools.errors import Failure

FIRST_NORMAL = 3.78e9           # N/m2, only a start
RATIOS = (0.02, 1.0)            # k_s over k_n that are tried
POISSON_TOLERANCE = 0.002
YOUNG_TOLERANCE = 0.002         # relative
MOST_MEASUREMENTS = 12


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
