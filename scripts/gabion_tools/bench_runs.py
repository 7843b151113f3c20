"""Runs of a benchmark: made once, kept in a folder, taken again by the next call as long as programs and scene are the same."""

import hashlib
import json
import shutil
import time
from pathlib import Path

from gabion_tools import processes, run, scenes, zone_size
from gabion_tools.errors import Failure
from gabion_tools.places import executable
from gabion_tools.verify_context import RunResult

HEAVY = ("grains.vtkhdf", "mesh.vtkhdf", "results.xdmf", "dem_server.log", "continuum_server.log")


class BenchContext:
    """What a case of the benchmark may ask for; the same calls as those of a verify case's context."""

    seed = None

    def __init__(self, folder, full=False, say=print):
        self.folder, self.full, self.say = Path(folder) / "runs", full, say
        self.folder.mkdir(parents=True, exist_ok=True)
        programs = hashlib.sha256()
        for name in ("dem_server", "continuum_server", "coupler"):
            programs.update(executable(name).read_bytes())
        self.programs = programs.hexdigest()[:16]
        self.overrides, self.made, self.taken = [], 0, 0

    def run_scene(self, scene, overrides=None, threads=None):
        """A RunResult. Raises Failure where the run did not end with 0."""
        changes, path = scenes.changes(overrides), scenes.find(str(scene))
        text = json.dumps([self.programs, path.read_text(encoding="utf-8"), changes, threads])
        folder = self.folder / f"{path.stem}-{hashlib.sha256(text.encode()).hexdigest()[:16]}"
        mark = folder / "done.json"
        if not mark.exists():
            self.make(path, changes, threads, folder, mark)
        else:
            self.taken += 1
        code = json.loads(mark.read_text(encoding="utf-8"))["code"]
        if code != 0:
            raise Failure(f"{path.stem} with {', '.join(changes) or 'no changes'} ended with code {code}:\n" + processes.tail(folder / "coupler.log", 4))
        return RunResult(folder, code)

    def make(self, path, changes, threads, folder, mark):
        shutil.rmtree(folder, ignore_errors=True)  # a run that was broken off
        folder.mkdir(parents=True)
        begin = time.monotonic()
        resolved, choice = zone_size.resolve(path, changes, threads, say=lambda text: None)
        sizing = time.monotonic() - begin if choice else 0.0
        code = processes.couple(path, scenes.override_arguments(resolved), folder, run.engines(scenes.model(path, resolved), threads), quiet=True)
        for name in HEAVY:
            (folder / name).unlink(missing_ok=True)
        mark.write_text(json.dumps({"code": code, "sizing": sizing, "choice": choice}), encoding="utf-8")
        self.made += 1
        self.say(f"  run {self.made}: {path.stem}, {time.monotonic() - begin:.0f} s" + ("" if code == 0 else f", code {code}"))
