"""Runs the hard cases: their tests by ctest, their figures from what the tests print, one line a case."""

import json
import math
import os
import re
import subprocess
import tempfile
import xml.etree.ElementTree as xml
from collections import namedtuple
from pathlib import Path

from gabion_tools.errors import Failure
from gabion_tools.goals import meets
from gabion_tools.hard_cases import CASES
from gabion_tools.places import BUILD, REPOSITORY

PAGE = REPOSITORY / "docs" / "hard_cases.md"
BEGIN, END = "<!-- table: begin -->", "<!-- table: end -->"
LONGEST_OUTPUT = 1 << 20  # bytes of a test's output that ctest keeps

Outcome = namedtuple("Outcome", "case passed reason figures")  # figures: {name: measured values}


def numbers():
    """{name: number} of every test that the build knows."""
    listed = subprocess.run(["ctest", "--test-dir", str(BUILD), "--show-only=json-v1"], capture_output=True, text=True, check=True)
    return {test["name"]: k for k, test in enumerate(json.loads(listed.stdout)["tests"], 1)}


def run_tests(names):
    """{name: (passed, output)}; a name that the build does not know is left out."""
    known = numbers()
    chosen = sorted(known[name] for name in names if name in known)
    if not chosen:
        raise Failure("the build knows none of the hard cases' tests: gabion test --hard builds them")
    with tempfile.TemporaryDirectory() as folder:
        report = Path(folder) / "tests.xml"
        subprocess.run(["ctest", "--test-dir", str(BUILD), "-j", "2", "--output-on-failure", "--output-junit", str(report),
                        "--test-output-size-passed", str(LONGEST_OUTPUT), "--test-output-size-failed", str(LONGEST_OUTPUT),
                        "-I", "0,0,0," + ",".join(map(str, chosen))],
                       stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, check=False, env=os.environ)
        if not report.exists():
            raise Failure("ctest wrote no report")
        found = {}
        for test in xml.parse(report).getroot().iter("testcase"):
            output = test.find("system-out")
            found[test.get("name")] = (test.get("status") == "run", (output.text or "") if output is not None else "")
    return found


def figures_of(output):
    """{name: [values]} from lines `figure NAME VALUE`."""
    figures = {}
    for name, value in re.findall(r"^figure (\w+) (\S+)$", output, re.MULTILINE):
        try:
            figures.setdefault(name, []).append(float(value))
        except ValueError:
            figures.setdefault(name, []).append(math.nan)
    return figures


def judge(case, results):
    """Passed only when each of its tests ran and passed, and each of its figures was printed and meets its goal."""
    figures = {}
    for test in case.tests:
        if test not in results:
            return Outcome(case, False, f"did not run: {test}", figures)
        passed, output = results[test]
        if not passed:
            return Outcome(case, False, f"failed: {test}", figures)
        for name, values in figures_of(output).items():
            if name in case.figures:
                figures.setdefault(name, []).extend(values)
    for name, goal in case.figures.items():
        if name not in figures:
            return Outcome(case, False, f"not measured: {name}", figures)
        for value in figures[name]:
            if not meets(value, goal):
                return Outcome(case, False, f"{name} is {value:.3g}, goal {goal}", figures)
    return Outcome(case, True, "", figures)


def worst(values, goal):
    """The value that is nearest to missing its goal."""
    return min(values) if goal.startswith(">") else max(values, key=abs)


def run_all():
    """An Outcome for each case, in order."""
    results = run_tests({test for case in CASES for test in case.tests})
    return [judge(case, results) for case in CASES]


def figure_text(outcome):
    return ", ".join(f"{name} {worst(outcome.figures[name], goal):.3g} ({goal})" for name, goal in outcome.case.figures.items()
                     if name in outcome.figures)


def print_table(outcomes):
    for o in outcomes:
        print(f"{o.case.number:3}  {'passed' if o.passed else 'FAILED'}  {o.case.name}: {o.reason or figure_text(o) or 'tests passed'}")
    good = sum(o.passed for o in outcomes)
    print(f"{good} passed, {len(outcomes) - good} failed")


def page_table(outcomes):
    rows = ["| | case | what would show | what is asserted, and what was measured | just beyond |", "|---|---|---|---|---|"]
    for o in outcomes:
        figures = "; ".join(f"`{name}` {worst(o.figures[name], goal):.2g}" + ("" if goal == "report" else f" ({goal})") for name, goal in o.case.figures.items())
        asserted = o.case.asserted + (f". {figures}" if figures else "")
        rows.append(f"| {o.case.number} | {o.case.name} | {o.case.symptom} | {asserted} | {o.case.beyond} |")
    rows += ["", "Tests of each case (`gabion test --filter`):", ""]
    rows += [f"- {o.case.number}: " + "; ".join(o.case.tests) for o in outcomes]
    return "\n".join(rows)


def write_page(outcomes):
    """Writes the figures of this run into the page."""
    if not all(o.passed for o in outcomes):
        raise Failure("the page is written when every case has passed")
    text = PAGE.read_text(encoding="utf-8")
    head, rest = text.split(BEGIN)
    PAGE.write_text(head + BEGIN + "\n" + page_table(outcomes) + "\n" + END + rest.split(END)[1], encoding="utf-8")
