"""gabion plot: the plots of one run folder, or of several over one another."""

from pathlib import Path

from gabion_tools import drawing, packages
from gabion_tools.errors import UserError


def arguments(parser):
    parser.add_argument("run", nargs="+", type=Path, help="run folder; several are compared")
    parser.add_argument("--section", metavar="AXIS=VALUE", help="plane of the section, as in y=0.5 (m)")
    parser.add_argument("--out", type=Path, help="where a comparison goes (default: beside the first run)")
    parser.add_argument("--yes", action="store_true", help="install missing packages without asking")


def run_folder(path):
    if not (path / "summary.json").is_file():
        raise UserError(f"{path} is not a run folder: it has no summary.json")
    return path.resolve()


def main(options):
    runs = [run_folder(path) for path in options.run]
    packages.ensure(options.yes)
    if len(runs) == 1:
        return 0 if drawing.draw(runs[0], options.section) else 1
    out = (options.out or runs[0].parent).resolve()
    out.mkdir(parents=True, exist_ok=True)
    return 0 if drawing.compare(out, runs) else 1
