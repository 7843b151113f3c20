"""gabion report: report.html of one run folder, with its plots drawn again."""

from gabion_tools import drawing, packages, plot


def arguments(parser):
    parser.add_argument("run", type=plot.Path, help="run folder")
    parser.add_argument("--yes", action="store_true", help="install missing packages without asking")


def main(options):
    folder = plot.run_folder(options.run)
    packages.ensure(options.yes)
    return 0 if drawing.draw(folder) else 1
