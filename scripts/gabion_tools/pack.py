"""gabion pack: makes the packing of a scene's whole ground, says what it is like and writes it down."""

from pathlib import Path

from gabion_tools import build, measuring, scenes
from gabion_tools.errors import UserError
from gabion_tools.places import short


def arguments(parser):
    parser.add_argument("scene", help="scene file, or the name of one of scenarios/")
    parser.add_argument("--set", action="append", default=[], metavar="KEY=VALUE", dest="overrides",
                        help="change one value of the scene; may be repeated")
    parser.add_argument("--out", type=Path, help="text file for the grains: x y z radius, one a line, m")
    parser.add_argument("--threads", type=int, help="threads of the engine")
    parser.add_argument("--yes", action="store_true", help="install missing packages without asking")


def main(options):
    scene = scenes.find(options.scene)
    scenes.override_arguments(options.overrides)
    if options.out and not options.out.resolve().parent.is_dir():
        raise UserError(f"--out {options.out}: there is no folder {options.out.parent}")
    build.ensure(options.yes)

    def look(folder, content):
        for name, value in content.get("packing", {}).items():
            print(f"  {name.replace('_', ' '):20} {value:.6g}")
        if options.out:
            from gabion_tools.run_data import Run
            grains = Run(folder).state("grains", 0)
            with open(options.out, "w", encoding="ascii") as file:
                for (x, y, z), radius in zip(grains["position"], grains["radius"]):
                    file.write(f"{x!r} {y!r} {z!r} {radius!r}\n")
            print(f"{len(grains['radius'])} grains in {short(options.out)}")
        return 0

    return measuring.prepared(scene, ["model=dem", *options.overrides], look, options.threads)
