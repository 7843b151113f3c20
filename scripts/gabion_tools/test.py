"""gabion test: set-up, build of everything, every test. The last line is "N passed, N failed"."""

import re
import subprocess
import tempfile
import xml.etree.ElementTree as xml
from pathlib import Path

from gabion_tools import build, hard
from gabion_tools.places import BUILD


def arguments(parser):
    parser.add_argument("--yes", action="store_true", help="install missing packages without asking")
    parser.add_argument("--filter", metavar="REGEX", help="only tests whose name matches")
    parser.add_argument("--hard", action="store_true", help="the hard cases of docs/hard_cases.md, one line each with its figures")
    parser.add_argument("--page", action="store_true", help="with --hard: write the figures into docs/hard_cases.md")


def main(options):
    build.ensure(options.yes, everything=True)
    if options.hard:
        return hard_cases(options.page)
    with tempfile.TemporaryDirectory() as folder:
        report = Path(folder) / "tests.xml"
        command = ["ctest", "--test-dir", str(BUILD), "-j", "2", "--output-on-failure", "--no-tests=error",
                   "--output-junit", str(report)]
        if options.filter:
            command += ["-R", options.filter]
        code = subprocess.run(command, stdin=subprocess.DEVNULL, check=False).returncode
        passed, failed, skipped = count(report)
    print(f"{passed} passed, {failed} failed" + (f", {skipped} skipped" if skipped else ""))
    return 0 if code == 0 and failed == 0 and passed > 0 else 1


def hard_cases(page):
    outcomes = hard.run_all()
    hard.print_table(outcomes)
    if page:
        hard.write_page(outcomes)
    return 0 if all(outcome.passed for outcome in outcomes) else 1


def count(report):
    """Passed, failed, skipped from ctest's JUnit file."""
    if not report.exists():
        return 0, 1, 0
    statuses = [case.get("status") for case in xml.parse(report).getroot().iter("testcase")]
    skipped = sum(status in ("notrun", "disabled", "skipped") for status in statuses)
    passed = statuses.count("run")
    return passed, len(statuses) - passed - skipped, skipped


def names():
    """Names of all tests that the build knows."""
    listed = subprocess.run(["ctest", "--test-dir", str(BUILD), "-N"], capture_output=True, text=True, check=True)
    return re.findall(r"Test +#\d+: (.+)", listed.stdout)
