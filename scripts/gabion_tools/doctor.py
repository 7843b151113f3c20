"""gabion doctor: what is installed, built and missing, and what machine this is."""

import os
import platform
import re
import subprocess

from gabion_tools import build, packages
from gabion_tools.errors import Failure
from gabion_tools.places import BUILD, PYTHON, executable, given_binaries, short

OPTIONAL = {"ccache": "faster rebuilds", "paraview": "shows results.xdmf", "clang-format": "formatting of sources"}


def arguments(parser):
    parser.add_argument("--yes", action="store_true", help="(nothing is ever installed by the doctor)")


def first_match(path, pattern):
    try:
        with open(path, encoding="utf-8") as file:
            found = re.search(pattern, file.read(), re.MULTILINE)
            return found[1] if found else "unknown"
    except OSError:
        return "unknown"


def machine():
    yield "system", first_match("/etc/os-release", r'^PRETTY_NAME="?([^"\n]*)')
    yield "kernel", platform.release()
    yield "processor", first_match("/proc/cpuinfo", r"^model name\s*: (.*)$")
    yield "cores", str(os.cpu_count())
    kilobytes = first_match("/proc/meminfo", r"^MemTotal:\s*(\d+)")
    yield "memory", f"{int(kilobytes) / 1024**2:.1f} GiB" if kilobytes.isdigit() else kilobytes
    flags = first_match("/proc/cpuinfo", r"^flags\s*: (.*)$").split()
    yield "vectors", ", ".join(flag for flag in ("avx2", "fma", "avx512f") if flag in flags) or "none known"


def python_modules():
    for name in ("numpy", "h5py", "matplotlib"):
        found = subprocess.run([PYTHON, "-c", f"import {name}; print({name}.__version__)"], capture_output=True,
                               text=True, check=False)
        yield f"{PYTHON} {name}", found.stdout.strip() if found.returncode == 0 else "MISSING"


def programs():
    for name in build.PROGRAMS:
        path = executable(name)
        yield name, short(path) if os.access(path, os.X_OK) else "not built"


def main(_options):
    good = True

    def section(title, pairs):
        nonlocal good
        print(title)
        for name, value in pairs:
            good = good and value != "MISSING"
            print(f"  {name:24} {value}")

    section("Machine", machine())
    try:
        section("Packages", ((name, version or "MISSING") for name, version in packages.versions().items()))
        section("Optional packages", ((name, version or f"not installed ({OPTIONAL[name]})")
                                      for name, version in packages.versions(OPTIONAL).items()))
    except Failure as failure:
        print("Packages\n  " + str(failure))
        good = False
    section("Python", python_modules())
    section("Programs" + (" (GABION_BIN)" if given_binaries() else ""), programs())
    print(f"Build folder\n  {short(BUILD)} {'configured' if (BUILD / 'build.ninja').exists() else 'not configured'}")
    print("Everything needed is here." if good else "Something is missing: `scripts/gabion test` installs and builds.")
    return 0 if good else 1
