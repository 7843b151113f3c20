"""Stand-ins for the programs, and the launcher run as a user would."""

import os
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

HERE = Path(__file__).resolve().parent
REPOSITORY = HERE.parents[1]
sys.path.insert(0, str(REPOSITORY / "scripts"))

ENGINE = HERE / "stand_in_engine.py"
COUPLER = HERE / "stand_in_coupler.py"
SCENE = '{"gabion": 1, // a comment\n "title": "http://no/comment", "model": "%s"}\n'


def alive(pid):
    """A process that has ended and waits to be collected by somebody else does not count."""
    try:
        return Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()[0] not in "ZX"
    except OSError:
        return False


class LauncherTest(unittest.TestCase):
    """A folder of stand-ins, a scene and a working folder, fresh for every test."""

    def setUp(self):
        keeper = tempfile.TemporaryDirectory()
        self.addCleanup(keeper.cleanup)
        self.folder = Path(keeper.name)
        self.bin = self.folder / "bin"
        self.bin.mkdir()
        for name in ("dem_server", "continuum_server"):
            (self.bin / name).symlink_to(ENGINE)
        (self.bin / "coupler").symlink_to(COUPLER)
        self.scene = self.write_scene("bridging")
        self.pids = self.folder / "pids"
        self.pids.mkdir()

    def write_scene(self, model):
        path = self.folder / f"{model}.json"
        path.write_text(SCENE % model, encoding="utf-8")
        return path

    def environment(self, **behaviour):
        return {**os.environ, "GABION_BIN": str(self.bin), "STAND_IN_PIDS": str(self.pids), **behaviour}

    def launch(self, *words, **behaviour):
        """CompletedProcess of scripts/gabion."""
        return subprocess.run([str(REPOSITORY / "scripts" / "gabion"), *map(str, words)], cwd=self.folder, text=True,
                              env=self.environment(**behaviour), stdin=subprocess.DEVNULL, capture_output=True,
                              timeout=60, check=False)

    def started(self):
        """{program: process id} of every stand-in that was started."""
        written = {path.stem: path.read_text() for path in self.pids.iterdir()}
        return {name: int(text) for name, text in written.items() if text.endswith("\n")}

    def assert_nothing_left(self):
        for name, pid in self.started().items():
            self.assertFalse(alive(pid), f"{name} ({pid}) is still there")
