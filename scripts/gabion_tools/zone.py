"""gabion zone: what coupling.zone = auto would choose for a scene, and why."""

import json

from gabion_tools import build, packages, scenes, zone_size
from gabion_tools.errors import UserError


def arguments(parser):
    parser.add_argument("scene", help="scene file, or the name of one of scenarios/")
    parser.add_argument("--set", action="append", default=[], metavar="KEY=VALUE", dest="overrides",
                        help="change one value of the scene; may be repeated")
    parser.add_argument("--target-error", type=float, metavar="SHARE", help="error against all grains to aim at, such as 0.03")
    parser.add_argument("--threads", type=int, help="threads of the engine")
    parser.add_argument("--yes", action="store_true", help="install missing packages without asking")


def main(options):
    scene = scenes.find(options.scene)
    scenes.override_arguments(options.overrides)
    if options.threads is not None and options.threads < 1:
        raise UserError(f"--threads {options.threads}: at least 1")
    packages.ensure(options.yes)
    build.ensure(options.yes)
    changes = list(options.overrides)
    if options.target_error is not None:
        changes.append(f"coupling.target_error={options.target_error!r}")
    changes += ['coupling.bridging.zone="auto"', 'coupling.edge.zone="auto"']
    _, choice = zone_size.resolve(scene, changes, options.threads)
    if choice is None:
        raise UserError("this model has no zone; choose one with --set model=bridging or --set model=edge")
    print("as words for gabion run: " + " ".join(f"--set '{change}'" for change in choice["changes"]))
    print(json.dumps({key: choice[key] for key in ("zone", "overlap", "element", "volume", "cost_share") if key in choice}))
    return 0
