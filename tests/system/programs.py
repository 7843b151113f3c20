"""Starts the three programs as a user would, and ends by pid whatever a test has started.

The folder of the executables is in the environment variable GABION_BIN.
"""

import json
import os
import pathlib
import signal
import subprocess
import sys
import tempfile
import time
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[2]
SCENARIOS = ROOT / "scenarios"
TOKEN = "a token for the system tests"
NOWHERE = "127.0.0.1:9"  # an address for runs that must be refused before they connect

sys.path.insert(0, str(ROOT / "tests" / "conformance"))  # the reference client's codec

_cache = tempfile.TemporaryDirectory(prefix="gabion-system-cache-")  # packings, made once for all tests of a module


def executable(name):
    folder = os.environ.get("GABION_BIN")
    if not folder:
        raise RuntimeError("set GABION_BIN to the folder of the executables")
    path = pathlib.Path(folder) / name
    if not path.exists():
        raise RuntimeError(f"{path} does not exist: build the target {name} first")
    return str(path)


def environment(token):
    kept = {k: v for k, v in os.environ.items() if k not in ("GABION_TOKEN", "OMP_NUM_THREADS")}
    # threads of a test that wait must not take the core from those that work
    kept |= {"GABION_CACHE": _cache.name, "OMP_WAIT_POLICY": "passive"}
    return kept | ({"GABION_TOKEN": token} if token is not None else {})


def figure(name, value):
    """A measured figure, for `gabion test --hard`; on a line of its own, whatever unittest has written before."""
    print(f"\nfigure {name} {value:.6g}", flush=True)


class Ended:
    """Exit status and output of a program."""

    def __init__(self, status, out, error):
        self.status, self.out, self.error = status, out, error

    def __repr__(self):
        return f"status {self.status}\n{self.error}"


class SystemTest(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory(prefix="gabion-system-")
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)
        self.out = self.folder / "run"

    def start(self, name, *arguments, token=TOKEN):
        process = subprocess.Popen([executable(name), *map(str, arguments)], env=environment(token), text=True,
                                   stdout=subprocess.PIPE, stderr=subprocess.PIPE, cwd=self.folder)
        self.addCleanup(self.end, process)
        return process

    @staticmethod
    def end(process):
        if process.poll() is None:
            process.send_signal(signal.SIGCONT)
            process.kill()
        process.wait()
        process.stdout.close()
        process.stderr.close()

    def ended(self, process, within=20.0):
        try:
            out, error = process.communicate(timeout=within)
        except subprocess.TimeoutExpired:
            self.fail(f"{process.args[0]} has not ended after {within} s")
        return Ended(process.returncode, out, error)

    def engine(self, name, *options, threads=1, token=TOKEN):
        """A listening engine: process and HOST:PORT."""
        process = self.start(name, "--threads", threads, *options, token=token)
        words = process.stdout.readline().split()
        self.assertEqual(words[:1], ["LISTENING"])
        return process, f"{words[1]}:{words[2]}"

    def engines(self, *options, threads=1):
        self.dem, dem = self.engine("dem_server", *options, threads=threads)
        self.continuum, continuum = self.engine("continuum_server", *options, threads=threads)
        return ["--dem", dem, "--continuum", continuum]

    def coupler(self, scene, *arguments, token=TOKEN):
        path = SCENARIOS / scene if isinstance(scene, str) else scene
        return self.start("coupler", path, "--out", self.out, *arguments, token=token)

    def run_scene(self, scene, *changes, threads=1, out="run"):
        """A whole run with fresh engines; returns its summary."""
        self.out = self.folder / out
        addresses = self.engines(threads=threads)
        sets = [word for change in changes for word in ("--set", change)]
        ended = self.ended(self.coupler(scene, *addresses, *sets), 60)
        self.assertEqual(ended.status, 0, ended)
        for engine in (self.dem, self.continuum):
            if engine is self.continuum and "model=dem" in changes:
                continue  # nobody has called it
            self.assertEqual(self.ended(engine, 5).status, 0)
        return json.loads((self.out / "summary.json").read_text())

    def wait_for_steps(self, process, enough=100, within=20.0):
        """Waits until the run's own log of steps has passed a number; returns the last one written."""
        deadline = time.monotonic() + within
        while time.monotonic() < deadline:
            self.assertIsNone(process.poll(), "the run has ended too early")
            path = self.out / "monitor.csv"
            rows = path.read_text().splitlines()[1:] if path.exists() else []
            if len(rows) > 1 and int(rows[-2].split(",")[0]) >= enough:
                return int(rows[-2].split(",")[0])
            time.sleep(0.02)
        self.fail(f"the run did not reach step {enough} within {within} s")
