"""Parameters of a material that give wanted figures: stiffnesses for elasticity, then one parameter for the strength."""

import argparse

from gabion_tools import laboratory, material_files, stiffness_search
from gabion_tools.errors import Failure, UserError
from gabion_tools.quantities import number

# stiffness_ratio and bond_strength are made of others: material_files.changed
RANGES = {"friction": (0.1, 2.0), "rolling_friction": (0.0, 1.0), "stiffness_ratio": (0.05, 1.0), "bond_strength": (0.2, 5.0)}
TOLERANCES = {"young": 0.01, "poisson": 0.005, "friction_angle": 0.5, "residual_friction_angle": 0.5, "cohesion": 0.05}
RELATIVE = ("young", "cohesion")


def parameter(wanted, vary):
    """The parameter that is varied for the strength, in a list; empty without such a target."""
    names = [name for name in wanted if name not in ("young", "poisson")]
    if not names:
        return []
    return [vary or ("bond_strength" if names[0] == "cohesion" else "friction")]


def value_of(found, name):
    if name in ("young", "poisson"):
        return found[name]["mean"]
    kind = "residual" if name.startswith("residual") else "peak"
    return found[kind]["cohesion" if name == "cohesion" else "friction_angle"]["mean"]


def miss_of(found, name, wanted):
    """Signed, in the units of TOLERANCES."""
    value = value_of(found, name)
    return value / wanted - 1.0 if name in RELATIVE else value - wanted


def missed(wanted, found):
    return [f"{name} {value_of(found, name):.5g}, wanted {value:g}" for name, value in wanted.items()
            if abs(miss_of(found, name, value)) > TOLERANCES[name]]


def root(miss, low, high, tolerance, most):
    """(value, miss) of a function of one parameter that changes sign between low and high: Illinois method, which halves the
    weight of an end that stays. The best value is returned when most evaluations do not suffice."""
    ends = [(low, miss(low)), (high, miss(high))]
    for value, found in ends:
        if abs(found) <= tolerance:
            return value, found
    (low, at_low), (high, at_high) = ends
    if at_low * at_high > 0.0:
        raise Failure(f"out of reach: it is missed by {at_low:+.3g} at {low:g} and by {at_high:+.3g} at {high:g}. "
                      "Widen --between, or vary another parameter")
    best, last = min(ends, key=lambda end: abs(end[1])), 0.0
    for _ in range(most - 2):
        value = (low * at_high - high * at_low) / (at_high - at_low)
        found = miss(value)
        if abs(found) < abs(best[1]):
            best = value, found
        if abs(found) <= tolerance:
            break
        if found * at_low > 0.0:
            low, at_low, at_high = value, found, at_high * (0.5 if last * found > 0.0 else 1.0)
        else:
            high, at_high, at_low = value, found, at_low * (0.5 if last * found > 0.0 else 1.0)
        last = found
    return best


def search(plan, name, material, options, folder):
    """(material, trail): trail holds what was tried and found."""
    trail = []

    def measure(values, tests, label):
        reduced = argparse.Namespace(**{**vars(options), "tests": tests})
        found, _ = laboratory.measure(laboratory.Plan(reduced), name, values, folder / f"search-{len(trail) + 1}", quiet=True)
        names = ["young", "poisson"]
        if "peak" in found:
            names += ["friction_angle", "residual_friction_angle", "cohesion"]
        trail.append({"changed": label, "found": {key: value_of(found, key) for key in names}})
        text = ", ".join(f"{key} {value:.5g}" for key, value in trail[-1]["found"].items())
        print(f"{len(trail):2}  {label}: {text}", flush=True)
        return found

    if "young" in options.wanted:
        material = stiffnesses(measure, material, options.wanted)
    for key in parameter(options.wanted, options.vary):
        goal = next(target for target in options.wanted if target not in ("young", "poisson"))
        base = material

        def miss(value, key=key, goal=goal, base=base):
            found = measure(material_files.changed(base, key, value), options.tests, f"{key} = {value:.5g}")
            return miss_of(found, goal, options.wanted[goal])

        low, high = between(options.between, key, base)
        try:
            value, _ = root(miss, low, high, TOLERANCES[goal], options.most_tests)
        except Failure as error:
            raise Failure(f"{goal} = {options.wanted[goal]:g}, varying {key}: {error}") from None
        material = material_files.changed(base, key, value)
    return material, trail


def stiffnesses(measure, material, wanted):
    """Both stiffnesses for young and poisson; for young alone their ratio stays."""
    unit = material_files.quantity(material, "normal_stiffness")[1]

    def with_values(normal, shear):
        return {**material, "normal_stiffness": f"{normal:.6g} {unit}", "shear_stiffness": f"{shear:.6g} {unit}"}

    if "poisson" not in wanted:
        normal, shear = (material_files.quantity(material, key)[0] for key in ("normal_stiffness", "shear_stiffness"))
        factor = wanted["young"] / value_of(measure(material, ["elastic"], "as it is"), "young")
        return with_values(factor * normal, factor * shear)

    def elasticity(normal, shear):
        found = measure(with_values(normal, shear), ["elastic"], f"k_n {normal:.4e}, k_s/k_n {shear / normal:.4f}")
        return value_of(found, "young"), value_of(found, "poisson")

    normal, shear, _ = stiffness_search.search(elasticity, wanted["young"], wanted["poisson"])
    return with_values(normal, shear)


def between(text, key, material):
    if text:
        parts = [number(part, "--between") for part in text.split(",")]
        if len(parts) != 2 or not 0.0 <= parts[0] < parts[1]:
            raise UserError(f"--between '{text}': expected two rising numbers, as in 0.2,1.5")
        return parts
    if key in RANGES:
        return RANGES[key]
    value = material_files.quantity(material, key)[0]
    if value <= 0.0:
        raise UserError(f"--vary {key}: the material has {value:g}; say --between LOW,HIGH")
    return 0.25 * value, 4.0 * value
