"""The hard cases: one passes only when its tests ran and passed and its figures were measured and meet their goals."""

import unittest

from fixture import LauncherTest

from gabion_tools import hard
from gabion_tools.hard_cases import CASES, case
from gabion_tools.places import REPOSITORY

ONE = case(1, "one", "", "", "", ["a: b", "a: c"], size="< 2", count="= 3")
OUTPUT = "figure size 1.5\nother 7\nfigure count 3\n"


class Hard(LauncherTest):
    def reason(self, **results):
        outcome = hard.judge(ONE, {f"a: {name}": result for name, result in results.items()})
        self.assertEqual(outcome.passed, outcome.reason == "")
        return outcome.reason

    def test_when_a_case_passes(self):
        self.assertEqual(self.reason(b=(True, OUTPUT), c=(True, "")), "")
        self.assertEqual(self.reason(b=(True, "figure size 1.5\n"), c=(True, "figure count 3")), "")

    def test_when_it_does_not(self):
        self.assertIn("did not run: a: c", self.reason(b=(True, OUTPUT)))
        self.assertIn("failed: a: c", self.reason(b=(True, OUTPUT), c=(False, "")))
        self.assertIn("not measured: count", self.reason(b=(True, "figure size 1.5"), c=(True, "figures count 3")))
        self.assertIn("size is 2.5", self.reason(b=(True, OUTPUT), c=(True, "figure size 2.5")))
        self.assertIn("size is nan", self.reason(b=(True, "figure size nan"), c=(True, "figure count 3")))
        self.assertIn("size is nan", self.reason(b=(True, "figure size big"), c=(True, "figure count 3")))

    def test_the_worst_figure_is_shown(self):
        self.assertEqual(hard.worst([1.0, -3.0, 2.0], "< 5"), -3.0)
        self.assertEqual(hard.worst([1.0, 0.5], ">= 0.1"), 0.5)

    def test_the_list_and_its_page(self):
        self.assertGreaterEqual(len(CASES), 22)
        self.assertEqual([c.number for c in CASES], list(range(1, len(CASES) + 1)))
        page = (REPOSITORY / "docs" / "hard_cases.md").read_text(encoding="utf-8")
        for c in CASES:
            self.assertIn(f"| {c.number} | {c.name} |", page)
            self.assertIn(f"- {c.number}: " + "; ".join(c.tests), page)


if __name__ == "__main__":
    unittest.main()
