"""gabion resume: a run that was broken off goes on from its checkpoint, in a folder of its own."""

import re
from pathlib import Path

from gabion_tools import build, run, scenes
from gabion_tools.errors import UserError
from gabion_tools.places import short


def arguments(parser):
    parser.add_argument("run", type=Path, help="run folder with a checkpoint")
    parser.add_argument("--out", type=Path, help="folder of the rest of the run (default: a new one in runs/)")
    parser.add_argument("--overwrite", action="store_true", help="replace an earlier run in that folder")
    parser.add_argument("--threads", type=int, help="threads of each engine (default: the cores shared out)")
    parser.add_argument("--yes", action="store_true", help="install missing packages without asking")
    parser.add_argument("--no-plots", action="store_true", help="leave out plots and report")


def main(options):
    folder = options.run
    scene = folder / "scene.effective.json"
    for needed in (scene, folder / "checkpoint"):
        if not needed.is_file():
            raise UserError(f"{short(folder)} holds no {needed.name}; runs write checkpoints where "
                            "run.checkpoint_every is set, and when they are interrupted")
    build.ensure(options.yes)
    model = scenes.model(scene, [])
    out = (run.prepare(options.out, options.overwrite) if options.out
           else run.free_folder(re.sub(r"-\d+$", "", folder.resolve().name)))
    return run.carry_out(scene, [], model, out, options, ["--resume", str(folder.resolve())])
