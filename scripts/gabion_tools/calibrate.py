"""gabion calibrate: what a material gives in virtual tests, and values of its parameters that give what is wanted.

With a scene, --young and --poisson: contact stiffnesses, measured on the scene's packing. With a material: see
calibrate_material. Contact stiffnesses are not constants of a material: they hold for the packing that they were found on.
"""

import json

from gabion_tools import build, calibrate_material, measuring, scenes
from gabion_tools.errors import UserError
from gabion_tools.quantities import pressure
from gabion_tools.stiffness_search import search


def arguments(parser):
    parser.add_argument("subject", metavar="MATERIAL|SCENE",
                        help="material to test: built-in name or file; or, with --young and --poisson, a scene whose ground is packed")
    parser.add_argument("--young", metavar="PRESSURE", help="with a scene: wanted modulus, as in '500 MPa'")
    parser.add_argument("--poisson", type=float, help="with a scene: wanted Poisson's ratio")
    parser.add_argument("--set", action="append", default=[], metavar="KEY=VALUE", dest="overrides",
                        help="change one value of the scene, or of the material as in friction=0.5; may be repeated")
    calibrate_material.arguments(parser)
    parser.add_argument("--threads", type=int, help="threads of the engine")
    parser.add_argument("--yes", action="store_true", help="install missing packages without asking")


def main(options):
    if options.young is None and options.poisson is None:
        return calibrate_material.main(options)
    if options.young is None or options.poisson is None:
        raise UserError("with a scene both --young and --poisson are needed; for a material use --target young=...,poisson=...")
    return calibrate_scene(options)


def calibrate_scene(options):
    scene = scenes.find(options.subject)
    scenes.override_arguments(options.overrides)
    young = pressure(options.young, "--young")
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
