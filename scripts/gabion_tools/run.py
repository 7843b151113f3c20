"""gabion run: one scene, one model or several, then summary, plots and report."""

import json
import os
import subprocess
import sys
from pathlib import Path

from gabion_tools import build, drawing, processes, scenes, summary, zone_size
from gabion_tools.errors import UserError
from gabion_tools.places import RUNS, executable, short


def arguments(parser):
    parser.add_argument("scene", help="scene file, or the name of one of scenarios/")
    parser.add_argument("--set", action="append", default=[], metavar="KEY=VALUE", dest="overrides",
                        help="change one value of the scene, as in coupling.overlap='2 m'; may be repeated")
    parser.add_argument("--model", help="dem, continuum, bridging or edge instead of the scene's own")
    parser.add_argument("--models", help="several models one after the other and a comparison: all, or a list dem,edge")
    parser.add_argument("--out", type=Path, help="run folder (default: a new one in runs/)")
    parser.add_argument("--overwrite", action="store_true", help="replace an earlier run in the run folder")
    parser.add_argument("--check", action="store_true", help="only check the scene")
    parser.add_argument("--threads", type=int, help="threads of each engine (default: the cores shared out)")
    parser.add_argument("--yes", action="store_true", help="install missing packages without asking")
    parser.add_argument("--no-plots", action="store_true", help="leave out plots and report")


def main(options):
    scene = scenes.find(options.scene)
    scenes.override_arguments(options.overrides)
    if options.threads is not None and options.threads < 1:
        raise UserError(f"--threads {options.threads}: at least 1")
    if options.model and options.models:
        raise UserError("--model and --models exclude each other")
    chosen = scenes.models(options.models) if options.models else [None]
    if options.model:
        chosen = scenes.models(options.model)
    build.ensure(options.yes)
    for model in chosen:
        code = check_scene(scene, overrides(options, model))
        if code != 0:
            return code
    if options.check:
        return 0
    if not options.models:
        return run_one(scene, options, chosen[0])
    return run_several(scene, options, chosen)


def overrides(options, model):
    return options.overrides + ([f"model={model}"] if model else [])


def check_scene(scene, changes):
    """Exit code of the coupler's own check, which prints what it found."""
    return subprocess.run([str(executable("coupler")), str(scene), "--check", *scenes.override_arguments(changes)],
                          stdin=subprocess.DEVNULL, check=False).returncode


def engines(model, threads):
    """{engine: threads}. Without a continuum one engine has every core; else they share them. threads: a number for
    both, a dict {"dem": ..., "continuum": ...} or None."""
    cores = os.cpu_count() or 1
    if isinstance(threads, dict):
        chosen = engines(model, None)
        return {name: threads.get(name.removesuffix("_server"), count) for name, count in chosen.items()}
    if model == "dem":
        return {"dem_server": threads or cores}
    # The grains' engine is needed for a continuum too: stiffness is measured on the packing.
    if model == "continuum":
        return {"dem_server": threads or cores, "continuum_server": threads or cores}
    share = threads or max(1, cores // 2)
    return {"dem_server": share, "continuum_server": share}


def free_folder(name):
    """runs/<name>-<n> with the first n that is free; made, so that no other run takes it."""
    RUNS.mkdir(exist_ok=True)
    n = 1
    while True:
        folder = RUNS / f"{name}-{n}"
        try:
            folder.mkdir()
            return folder
        except FileExistsError:
            n += 1


def prepare(folder, overwrite):
    """The run folder that the user named."""
    if folder.exists() and not folder.is_dir():
        raise UserError(f"--out {short(folder)} is a file")
    if folder.is_dir() and any(folder.iterdir()) and not overwrite:
        raise UserError(f"--out {short(folder)} is not empty. Choose another folder, or add --overwrite to replace an "
                        "earlier run")
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise UserError(f"--out {short(folder)} cannot be made: {error.strerror}") from None
    return folder.resolve()


def run_one(scene, options, model):
    folder = prepare(options.out, options.overwrite) if options.out else None
    changes, choice = zone_size.resolve(scene, overrides(options, model), options.threads)
    model = scenes.model(scene, changes)
    return carry_out(scene, changes, model, folder or free_folder(f"{scene.stem}-{model}"), options, choice=choice)


def carry_out(scene, changes, model, folder, options, extra=(), choice=None):
    """Runs, summarises and draws; extra: further words for the coupler; choice: of the zone, for zone.json. Exit code of the coupler."""
    print(f"run folder {short(folder)}", flush=True)
    threads = options.threads or scenes.threads(scene, changes)
    code = 1  # an interrupt
    try:
        code = processes.couple(scene, [*scenes.override_arguments(changes), *extra], folder, engines(model, threads),
                                options.overwrite)
    finally:
        if choice is not None and code != 2:  # 2: the coupler left the folder as it was
            (folder / "zone.json").write_text(json.dumps(choice, indent=1), encoding="utf-8")
    if (folder / "summary.json").exists():
        print(summary.table(folder))
        if not options.no_plots:
            drawing.draw(folder)
    if code != 0:
        print(f"gabion: the coupler ended with code {code}; see {short(folder / 'run.log')}", file=sys.stderr)
    return code


def run_several(scene, options, chosen):
    whole = prepare(options.out, options.overwrite) if options.out else free_folder(f"{scene.stem}-models")
    worst, folders = 0, {}  # by model
    for asked in chosen:
        changes, choice = zone_size.resolve(scene, overrides(options, asked), options.threads)
        model = scenes.model(scene, changes)
        if model in folders or (model != asked and model in chosen):
            print(f"{asked}: zone = auto chose model = {model}, which is run as such")
            continue
        folders[model] = prepare(whole / model, options.overwrite)
        worst = max(worst, carry_out(scene, changes, model, folders[model], options, choice=choice))
    done = [folder for folder in folders.values() if (folder / "summary.json").exists()]
    if done and not options.no_plots:
        drawing.compare(whole, done)
    return worst
