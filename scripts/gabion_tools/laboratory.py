"""Virtual laboratory: periodic samples of a material, their elasticity and triaxial tests, over several seeds."""

import json
import math

from gabion_tools import processes, run, strength
from gabion_tools.errors import Failure, UserError

MEAN_CUBE = 3.75  # mean of r^3 over the cube of the smallest radius, uniform by number between r and 2 r
RADIUS = (0.05, 0.1)  # m; results do not depend on it, for stiffness goes with r and strength with r^2


class Plan:
    """What is tested, apart from the material: sizes, seeds, confinements."""

    def __init__(self, options):
        self.grains, self.seeds, self.contacts = options.grains, options.seeds, options.contacts_per_grain
        self.solid_fraction, self.min_contacts = options.solid_fraction, options.min_contacts
        self.confinements, self.tests = options.confinements, options.tests
        self.laboratory = {key: value for key, value in (
            ("axial_strain", options.axial_strain), ("inertial_number", options.inertial_number),
            ("peak_inertial_number", options.peak_inertial_number), ("damping", options.damping)) if value is not None}
        self.threads = options.threads
        self.rotations = options.rotations

    def side(self):
        """Of the cube, m, for the wanted number of grains before those that nothing holds are taken out."""
        return (self.grains * 4.0 / 3.0 * math.pi * MEAN_CUBE * RADIUS[0] ** 3 / self.solid_fraction) ** (1.0 / 3.0)

    def scene(self, name, material, seed):
        side = f"{self.side():.6g} m"
        return {
            "gabion": 1, "title": f"Periodic sample of {name}, seed {seed}", "model": "dem",
            "ground": {"box": [["0 m"] * 3, [side] * 3], "material": name, "periodic": ["x", "y", "z"]},
            "materials": {name: material},
            "grains": {"radius": {"uniform": [f"{r} m" for r in RADIUS]}, "solid_fraction": self.solid_fraction,
                       "contacts_per_grain": self.contacts, "min_contacts": self.min_contacts, "seed": seed, "rotations": self.rotations},
            "stages": [{"name": "none", "steps": 1}],
            "laboratory": {"confinements": [f"{p!r} Pa" for p in self.confinements] if "triaxial" in self.tests else [],
                           **self.laboratory},
        }

    def description(self):
        return {"grains": self.grains, "seeds": self.seeds, "contacts_per_grain": self.contacts, "solid_fraction": self.solid_fraction,
                "min_contacts": self.min_contacts,
                "radius_ratio": RADIUS[1] / RADIUS[0], "rotations": self.rotations, "confinements": self.confinements,
                "tests": self.tests, **self.laboratory}


def sample(plan, name, material, seed, folder, quiet=False):
    """laboratory.json of one sample, curves read and figures added."""
    path = folder.parent / f"{folder.name}.json"
    path.write_text(json.dumps(plan.scene(name, material, seed), indent=2) + "\n", encoding="utf-8")
    folder.mkdir()
    code = processes.couple(path, ["--laboratory"], folder, run.engines("dem", plan.threads), quiet=quiet)
    if code != 0:
        kind = UserError if code == 2 else Failure
        text = "\n" + processes.tail(folder / "coupler.log") if quiet else ""
        raise kind(f"the test of {name}, seed {seed}, ended with code {code}; see {path}{text}")
    found = json.loads((folder / "laboratory.json").read_text(encoding="utf-8"))
    for test in found["tests"]:
        test["figures"] = strength.figures(strength.read(folder / test["curve"]))
    return found


def strength_of(samples, kind):
    """Envelope over the confinements for every seed: kind is peak or residual."""
    fits = []
    for one in samples:
        fits.append(strength.envelope([(test["figures"][kind]["sigma_3"], test["figures"][kind]["sigma_1"]) for test in one["tests"]]))
    return {name: strength.spread([fit[name] for fit in fits]) for name in ("friction_angle", "cohesion", "misfit")}


def summary(samples):
    """Figures over the seeds."""
    found = {name: strength.spread([one["elasticity"][name] for one in samples]) for name in ("young", "poisson", "density")}
    found["contacts_per_grain"] = strength.spread([one["sample"]["contacts_per_grain"] for one in samples])
    if not samples[0]["tests"]:
        return found
    found["peak"], found["residual"] = strength_of(samples, "peak"), strength_of(samples, "residual")
    found["tests"] = []
    for k, first in enumerate(samples[0]["tests"]):
        tests = [one["tests"][k] for one in samples]
        found["tests"].append({
            "confinement": first["confinement"],
            **{f"{kind}_deviator": strength.spread([t["figures"][kind]["q"] for t in tests]) for kind in ("peak", "residual")},
            "peak_strain": strength.spread([t["figures"]["peak"]["axial_strain"] for t in tests]),
            "dilation_angle": strength.spread([t["figures"]["dilation_angle"] for t in tests]),
            "residual_is_steady": all(t["figures"]["residual"]["steady"] for t in tests),
            "largest_energy_error": max(t["energy_error"] for t in tests),
        })
    return found


def measure(plan, name, material, folder, quiet=False):
    """(summary, samples) of a material; every seed in a folder of its own under folder."""
    folder.mkdir(parents=True, exist_ok=True)
    samples = []
    for seed in plan.seeds:
        if not quiet:
            print(f"sample of {name}, seed {seed}", flush=True)
        samples.append(sample(plan, name, material, seed, folder / f"seed-{seed}", quiet))
    return summary(samples), samples


def _text(found, scale=1.0, digits=1):
    text = f"{found['mean'] / scale:.{digits}f}"
    return text if found["deviation"] is None else f"{text} +- {found['deviation'] / scale:.{digits}f}"


def table(found):
    """Lines for the terminal."""
    count = len(found["young"]["values"])
    lines = [f"means and standard deviations over {count} seeds" if count > 1 else "one seed: no scatter known",
             f"  E                  {_text(found['young'], 1e6)} MPa",
             f"  nu                 {_text(found['poisson'], digits=3)}",
             f"  bulk density       {_text(found['density'], digits=0)} kg/m3",
             f"  contacts per grain {_text(found['contacts_per_grain'], digits=2)}"]
    if "peak" not in found:
        return lines
    places = ", ".join(f"{test['confinement'] / 1e3:g}" for test in found["tests"])
    several = len(found["tests"]) > 1
    how = "least squares of sigma_1 against sigma_3" if several else "one confinement: angle of a material without cohesion"
    lines.append(f"  strength, {how}, confinements {places} kPa")
    for kind in ("peak", "residual"):
        line = f"    {kind:8} phi {_text(found[kind]['friction_angle'])} degrees"
        if several:
            line += f"   c {_text(found[kind]['cohesion'], 1e3)} kPa   misfit {_text(found[kind]['misfit'], 1e3)} kPa"
        lines.append(line)
    lines.append("    confinement   peak q [kPa]     at strain [%]    residual q [kPa]  dilation [degrees]  energy error")
    for test in found["tests"]:
        lines.append(f"    {test['confinement'] / 1e3:7g} kPa   {_text(test['peak_deviator'], 1e3):15}  "
                     f"{_text(test['peak_strain'], 1e-2, 3):15}  {_text(test['residual_deviator'], 1e3):15}"
                     f"{' ' if test['residual_is_steady'] else '*'}  "
                     f"{_text(test['dilation_angle']):18}  {test['largest_energy_error']:.1e}")
    if not all(test["residual_is_steady"] for test in found["tests"]):
        lines.append("    * still changes by more than 10 % at the end: raise --axial-strain")
    return lines
