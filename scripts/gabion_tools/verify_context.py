"""What a verify case may ask for: figures against goals, runs of scenes, executables. Needs numpy and h5py."""

import hashlib
import json
import os
import shutil
import subprocess
from pathlib import Path

from gabion_tools import processes, run, scenes, zone_size
from gabion_tools.errors import Failure
from gabion_tools.goals import meets
from gabion_tools.places import BUILD, executable
from gabion_tools.run_data import Run

RUNS = BUILD / "verify"


class RunResult(Run):
    """Run plus the coupler's exit code; h5_path, summary, histories, history(), state() as in run_data."""

    def __init__(self, folder, code):
        super().__init__(folder)
        self.code = code


class Context:
    """full: the long form is wanted. seed: of the packings, or None. Runs are made once per verify call."""

    def __init__(self, full=False, seed=None, overrides=()):
        self.full, self.seed, self.overrides = full, seed, list(overrides)
        self.case = ""
        self.runs = {}
        self.root = RUNS / str(os.getpid())
        for old in RUNS.glob("*"):  # of calls that have ended
            if not (old.name.isdigit() and Path(f"/proc/{old.name}").exists()) or old == self.root:
                shutil.rmtree(old, ignore_errors=True)

    def figure(self, name, value, unit, goal):
        """One figure of the present case, for yield."""
        if hasattr(value, "item"):
            value = value.item()
        return {"case": self.case, "figure": name, "value": value, "unit": unit, "goal": goal,
                "met": meets(value, goal)}

    def executable(self, name):
        path = executable(name)
        if not path.exists():
            raise Failure(f"{path} is not built")
        return path

    def json_lines(self, name, *words, timeout=600):
        """Runs an executable and returns the JSON objects that it prints one a line; other lines are passed over."""
        done = subprocess.run([str(self.executable(name)), *map(str, words)], capture_output=True, text=True,
                              timeout=timeout, check=False)
        if done.returncode != 0:
            raise Failure(f"{name} ended with code {done.returncode}: {done.stderr.strip()[-500:]}")
        return [json.loads(text) for text in done.stdout.splitlines() if text.startswith("{")]

    def run_scene(self, scene, overrides=None, threads=None, repeat=0, expect_success=True):
        """Runs a scene (name or path) with overrides, a dict or a list of 'key=value', and returns a RunResult.

        The same scene, overrides and threads are run once per verify call; repeat > 0 asks for a further run.
        Raises Failure when the coupler does not end with 0, unless expect_success is False.
        """
        changes = scenes.changes(overrides) + self.overrides
        if self.seed is not None:
            changes.append(f"grains.seed={self.seed}")
        path = scenes.find(str(scene))
        key = hashlib.sha256(json.dumps([str(path), changes, threads, repeat]).encode()).hexdigest()[:12]
        if key not in self.runs:
            folder = self.root / f"{path.stem}-{key}"
            folder.mkdir(parents=True)
            changes, _ = zone_size.resolve(path, changes, threads, say=lambda text: None)
            code = processes.couple(path, scenes.override_arguments(changes), folder,
                                    run.engines(scenes.model(path, changes), threads), quiet=True)
            self.runs[key] = RunResult(folder, code)
        result = self.runs[key]
        if expect_success and result.code != 0:
            raise Failure(f"{path.stem} with {', '.join(changes) or 'no changes'} ended with code {result.code}:\n"
                          + processes.tail(result.folder / "coupler.log"))
        return result
