"""Plots and reports are drawn by Debian's Python in a process of its own: the launcher itself needs no numpy."""

import subprocess
import sys

from gabion_tools.places import PYTHON, REPOSITORY, short


def call(module, *words):
    code = subprocess.run([PYTHON, "-m", f"gabion_tools.{module}", *map(str, words)], cwd=REPOSITORY / "scripts",
                          stdin=subprocess.DEVNULL, check=False).returncode
    if code != 0:
        print(f"gabion: {module} failed (code {code}); the run itself is not touched by this", file=sys.stderr)
    return code == 0


def draw(folder, section=None):
    """Plots and report.html of one run folder."""
    words = [folder] if section is None else [folder, section]
    drawn = call("plots", *words)
    reported = call("report_page", folder)
    if reported:
        print(f"report {short(folder / 'report.html')}")
    return drawn and reported


def compare(folder, runs):
    """Histories of several runs over one another, and compare.html."""
    if call("comparison", folder, *runs):
        print(f"comparison {short(folder / 'compare.html')}")
        return True
    return False
