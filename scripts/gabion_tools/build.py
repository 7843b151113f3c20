"""Configures and builds into <repository>/build; the whole output goes to build/build.log."""

import os
import re
import shutil
import subprocess
import sys

from gabion_tools import packages
from gabion_tools.errors import Failure
from gabion_tools.places import BUILD, REPOSITORY, executable, given_binaries, short

PROGRAMS = ("dem_server", "continuum_server", "coupler")
TAIL_LINES = 30


def ensure(yes=False, everything=False):
    """Packages, configuration and build, as far as needed. With GABION_BIN set, only looks whether they are there."""
    if given_binaries():
        for name in PROGRAMS:
            if not os.access(executable(name), os.X_OK):
                raise Failure(f"GABION_BIN is set, but there is no executable {executable(name)}")
        return
    packages.ensure(yes)
    BUILD.mkdir(exist_ok=True)
    log_path = BUILD / "build.log"
    with open(log_path, "w", encoding="utf-8", buffering=1) as log:
        if not (BUILD / "build.ninja").exists():
            compiler_cache = ["-DCMAKE_CXX_COMPILER_LAUNCHER=ccache"] if shutil.which("ccache") else []
            follow(["cmake", "-S", str(REPOSITORY), "-B", str(BUILD), "-G", "Ninja", "-DCMAKE_BUILD_TYPE=Release",
                    *compiler_cache], log, "configure")
        targets = [] if everything else [f"bin/{name}" for name in PROGRAMS]
        follow(["ninja", "-C", str(BUILD), "-j", str(os.cpu_count() or 1), *targets], log, "build")


def follow(command, log, what):
    """Runs a command into the log, with one progress line on a terminal and none elsewhere."""
    log.write("$ " + " ".join(command) + "\n")
    log.flush()
    lines, shown = [], False
    environment = {**os.environ, "NINJA_STATUS": "[%f/%t] "}
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, errors="replace",
                          env=environment, stdin=subprocess.DEVNULL) as process:
        try:
            for line in process.stdout:
                log.write(line)
                lines = [*lines[-TAIL_LINES + 1:], line]
                count = re.match(r"\[(\d+)/(\d+)\]", line)
                if count and sys.stderr.isatty():
                    print(f"\r{what} {count[1]}/{count[2]} ", end="", file=sys.stderr, flush=True)
                    shown = True
        except BaseException:
            process.terminate()
            raise
    if shown:
        print("\r" + " " * 40 + "\r", end="", file=sys.stderr, flush=True)
    if process.returncode != 0:
        raise Failure(f"the {what} failed; all of it is in {short(log.name)}. Its end:\n" + "".join(lines).rstrip())
