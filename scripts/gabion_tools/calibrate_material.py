"""gabion calibrate MATERIAL: elasticity and strength of a material's periodic samples, and parameters for given ones.

Figures hold for the packing they were found on: its contacts per grain, its solid fraction, its radii's ratio.
"""

import json
from pathlib import Path

from gabion_tools import build, drawing, laboratory, material_files, material_search, run, scenes
from gabion_tools.errors import UserError, advice
from gabion_tools.places import short
from gabion_tools.quantities import number, pressure

TESTS = ("elastic", "triaxial")
CONFINEMENTS = "20 kPa,50 kPa,100 kPa"
TARGETS = {"young": "Pa", "poisson": "", "friction_angle": "degrees", "residual_friction_angle": "degrees", "cohesion": "Pa"}


def arguments(parser):
    group = parser.add_argument_group("with a material")
    group.add_argument("--tests", default="elastic,triaxial", help="elastic, triaxial or both (default)")
    group.add_argument("--confinements", default=CONFINEMENTS, help=f"of the triaxial tests (default '{CONFINEMENTS}')")
    group.add_argument("--grains", type=int, default=3000, help="grains of a sample (default 3000)")
    group.add_argument("--seeds", type=int, default=3, help="samples, each with a packing of its own (default 3)")
    group.add_argument("--contacts-per-grain", type=float, default=5.7, help="mean number of bonds of a grain (default 5.7)")
    group.add_argument("--solid-fraction", type=float, default=0.63, help="of the packing before grains are taken out (default 0.63)")
    group.add_argument("--min-contacts", type=int, default=3, help="grains with fewer bonds are taken out (default 3; 0 keeps all)")
    group.add_argument("--rotations", choices=("free", "locked"), default="free", help="whether grains rotate")
    group.add_argument("--axial-strain", type=float, help="end of a test (default 0.1)")
    group.add_argument("--inertial-number", type=float, help="rate beyond the peak (default 5e-4)")
    group.add_argument("--peak-inertial-number", type=float, help="rate up to 0.2 %% of strain (default 1e-4)")
    group.add_argument("--damping", type=float, help="local damping (default 0.2)")
    group.add_argument("--target", metavar="NAME=VALUE,...",
                       help="figures to reach: young=196 MPa, poisson=0.3, and one of friction_angle, residual_friction_angle, cohesion")
    group.add_argument("--vary", metavar="PARAMETER",
                       help="parameter of the material for the angle or cohesion (default friction, or bond_strength for cohesion)")
    group.add_argument("--between", metavar="LOW,HIGH", help="values of the varied parameter that are tried")
    group.add_argument("--most-tests", type=int, default=8, help="measurements of a search at most (default 8)")
    group.add_argument("--out", type=Path, help="folder for everything, or NAME.json for the material found")
    group.add_argument("--overwrite", action="store_true", help="replace an earlier material file")
    group.add_argument("--no-plots", action="store_true", help="leave out the plot")


def listed(text, known, option):
    words = [word.strip() for word in text.split(",") if word.strip()]
    for word in words:
        if word not in known:
            raise UserError(f"{option} '{word}': {advice(word, known)}")
    if not words:
        raise UserError(f"{option} is empty; known: " + ", ".join(known))
    return words


def targets(text):
    """{name: value} of --target."""
    wanted = {}
    for part in text.split(","):
        name, equals, value = (piece.strip() for piece in part.partition("="))
        if not equals:
            raise UserError(f"--target '{part.strip()}': expected NAME=VALUE, as in friction_angle=35")
        listed(name, TARGETS, "--target")
        if name in wanted:
            raise UserError(f"--target {name}: given twice")
        option = f"--target {name}"
        wanted[name] = pressure(value, option) if TARGETS[name] == "Pa" else number(value, option)
    if "poisson" in wanted and not 0.0 < wanted["poisson"] < 0.5:
        raise UserError(f"--target poisson={wanted['poisson']:g}: must lie between 0 and 0.5")
    for name in ("friction_angle", "residual_friction_angle"):
        if name in wanted and not 0.0 < wanted[name] < 80.0:
            raise UserError(f"--target {name}={wanted[name]:g}: must lie between 0 and 80 degrees")
    if len(strengths(wanted)) > 1:
        raise UserError("--target: one of friction_angle, residual_friction_angle and cohesion, for one parameter is varied")
    if "poisson" in wanted and "young" not in wanted:
        raise UserError("--target poisson needs young beside it: both stiffnesses change")
    return wanted


def strengths(wanted):
    return [name for name in wanted if name not in ("young", "poisson")]


def read(options):
    """Checks the options and completes them in place."""
    options.tests = listed(options.tests, TESTS, "--tests")
    options.confinements = sorted(pressure(text, "--confinements") for text in options.confinements.split(",") if text.strip())
    if "triaxial" in options.tests and not options.confinements:
        raise UserError("--confinements: give at least one, as in '50 kPa'")
    if len(set(options.confinements)) != len(options.confinements):
        raise UserError("--confinements: one is given twice")
    bounds = {"grains": (100, 10 ** 6), "seeds": (1, 100), "contacts_per_grain": (3.0, 12.0), "solid_fraction": (0.1, 0.74),
              "min_contacts": (0, 12), "most_tests": (2, 100),
              "axial_strain": (1e-6, 0.89), "inertial_number": (1e-7, 0.1), "peak_inertial_number": (1e-7, 0.1),
              "damping": (0.0, 0.99), "threads": (1, 1024)}
    for name, (low, high) in bounds.items():
        value = getattr(options, name)
        if value is not None and not low <= value <= high:
            raise UserError(f"--{name.replace('_', '-')} {value:g}: expected {low:g} to {high:g}")
    options.wanted = targets(options.target) if options.target else {}
    if strengths(options.wanted) and "triaxial" not in options.tests:
        raise UserError(f"--target {strengths(options.wanted)[0]} needs triaxial among --tests")
    if "cohesion" in options.wanted and len(options.confinements) < 2:
        raise UserError("--target cohesion needs two confinements or more")
    for option in ("vary", "between"):
        if getattr(options, option) and not strengths(options.wanted):
            raise UserError(f"--{option} needs a --target friction_angle, residual_friction_angle or cohesion")
    options.seeds = list(range(1, options.seeds + 1))


def material_of(options):
    """(name, values) with the changes of --set."""
    name, material = material_files.load(options.subject)
    if not name.replace("_", "").replace("-", "").isalnum():
        raise UserError(f"material name '{name}': letters, digits, _ and - only")
    for change in options.overrides:
        scenes.override_arguments([change])
        key, _, value = (piece.strip() for piece in change.partition("="))
        try:
            material[key] = json.loads(value)
        except ValueError:
            material[key] = value
    return name, material


def folder_of(options, name):
    """(folder, path of the material file or None)."""
    if options.out is None:
        folder = run.free_folder(f"calibrate-{name}")
        return folder, folder / f"{name}_calibrated.json"
    if options.out.suffix == ".json":
        if options.out.exists() and not options.overwrite:
            raise UserError(f"--out {short(options.out)} exists; add --overwrite to replace it")
        if not options.out.resolve().parent.is_dir():
            raise UserError(f"--out {options.out}: there is no folder {options.out.parent}")
        if not options.wanted:
            raise UserError(f"--out {options.out}: a material file is written where --target is given; name a folder")
        return run.free_folder(f"calibrate-{name}"), options.out.resolve()
    folder = run.prepare(options.out, False)
    return folder, folder / f"{name}_calibrated.json"


def main(options):
    read(options)
    name, material = material_of(options)
    for key in material_search.parameter(options.wanted, options.vary):
        material_files.changed(material, key, material_search.between(options.between, key, material)[0])
    build.ensure(options.yes)
    plan = laboratory.Plan(options)
    folder, file = folder_of(options, name)
    print(f"folder {short(folder)}", flush=True)
    trail = []
    if options.wanted:
        material, trail = material_search.search(plan, name, material, options, folder)
    found, samples = laboratory.measure(plan, name, material, folder / "final" if trail else folder)
    print("\n".join(laboratory.table(found)))
    record = {"material": name, "parameters": material, "plan": plan.description(), "targets": options.wanted, "search": trail,
              "found": found, "samples": samples}
    (folder / "calibration.json").write_text(json.dumps(record, indent=1) + "\n", encoding="utf-8")
    missed = material_search.missed(options.wanted, found)
    if options.wanted:
        material_files.write(file, described(material, found), provenance(name, plan, options, found, trail))
        print(f"material {short(file)}")
        for line in missed:
            print(f"  not within the tolerance: {line}")
    if samples[0]["tests"] and not options.no_plots:
        drawing.call("laboratory_plot", folder)
        print(f"plot {short(folder / 'plots' / 'triaxial.png')}")
    print(f"all figures {short(folder / 'calibration.json')}")
    return 1 if missed else 0


def described(material, found):
    """With the moduli that were measured, for mesh.stiffness = material."""
    return {**material, "young": f"{found['young']['mean'] / 1e6:.4g} MPa", "poisson": round(found["poisson"]["mean"], 4),
            "bulk_density": f"{found['density']['mean']:.4g} kg/m3"}


def provenance(name, plan, options, found, trail):
    """Lines of the material file's comment."""
    asked = ", ".join(f"{key} = {value:g} {TARGETS[key]}".strip() for key, value in options.wanted.items())
    lines = [f"Found by gabion calibrate from {name} for {asked}.",
             f"Periodic samples of about {plan.grains} grains, radii 1 to {laboratory.RADIUS[1] / laboratory.RADIUS[0]:g}, solid fraction "
             f"{plan.solid_fraction:g}, {plan.contacts:g} contacts per grain, grains with fewer than {plan.min_contacts} taken out, "
             f"rotations {plan.rotations}, "
             f"seeds {', '.join(map(str, plan.seeds))}; {len(trail)} measurements in the search.",
             "Contact parameters are no material constants: these hold for such packings. Measured with them:"]
    return lines + [line.strip() for line in laboratory.table(found)]
