"""Where things are."""

import os
from pathlib import Path

REPOSITORY = Path(__file__).resolve().parents[2]
BUILD = REPOSITORY / "build"
RUNS = REPOSITORY / "runs"
SCENARIOS = REPOSITORY / "scenarios"
PYTHON = "/usr/bin/python3"  # Debian's, to which numpy, h5py and matplotlib belong


def given_binaries():
    """Folder of ready executables in GABION_BIN, or None: then they are built."""
    folder = os.environ.get("GABION_BIN")
    return Path(folder).resolve() if folder else None


def executable(name):
    return (given_binaries() or BUILD / "bin") / name


def short(path):
    """Relative to where the user stands, when that is shorter."""
    relative = os.path.relpath(path)
    return relative if len(relative) < len(str(path)) else str(path)
