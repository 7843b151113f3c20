"""gabion check: what `gabion run --check` does."""

from gabion_tools import build, run, scenes


def arguments(parser):
    parser.add_argument("scene", help="scene file, or the name of one of scenarios/")
    parser.add_argument("--set", action="append", default=[], metavar="KEY=VALUE", dest="overrides",
                        help="change one value of the scene; may be repeated")
    parser.add_argument("--yes", action="store_true", help="install missing packages without asking")


def main(options):
    scene = scenes.find(options.scene)
    scenes.override_arguments(options.overrides)
    build.ensure(options.yes)
    return run.check_scene(scene, options.overrides)
