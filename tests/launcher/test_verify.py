"""The verify framework: goals, cases that fail, runs made once."""

import json
import types
import unittest
from unittest import mock

from fixture import LauncherTest

from gabion_tools import verify, verify_context
from gabion_tools.errors import Failure


class VerifyTest(LauncherTest):
    def test_goals(self):
        for value, goal, met in ((1, "< 2", True), (2, "< 2", False), (2, "<= 2", True), (5, "> 1e1", False),
                                 (6, "= 6", True), (498.0, "500 +- 10", True), (511, "500 +- 10", False),
                                 (0.95, "0.9 .. 1.1", True), (float("nan"), "< 1", False), (None, "< 1", False),
                                 (float("nan"), "report", True), (True, "= True", True), (False, "= True", False)):
            with self.subTest(value=value, goal=goal):
                self.assertEqual(verify_context.meets(value, goal), met)
        with self.assertRaises(ValueError):
            verify_context.meets(1, "about 2")

    def test_an_error_is_a_figure_that_is_not_met(self):
        def run(context):
            yield context.figure("first", 1, "", "= 1")
            raise Failure("no such luck")
        context = mock.Mock(case="luck", figure=lambda *a: {"figure": a[0], "met": True})
        figures = list(verify.carry_out(types.SimpleNamespace(run=run), context))
        self.assertEqual([(f["figure"], f["met"]) for f in figures], [("first", True), ("error: no such luck", False)])

    def test_runs_are_made_once(self):
        with mock.patch.object(verify_context, "RUNS", self.folder / "runs"), \
                mock.patch.dict("os.environ", self.environment(STAND_IN_COUPLER="full")):
            context = verify_context.Context(seed=3)
            first = context.run_scene(self.scene, {"model": "edge"}, threads=1)
            self.assertIs(context.run_scene(self.scene, ["model=edge"], threads=1), first)
            self.assertIsNot(context.run_scene(self.scene, {"model": "edge"}, threads=1, repeat=1), first)
            self.assertEqual(first.summary["model"], "edge")
            self.assertEqual(len(first.history("block", "penetration")), 200)
            self.assertEqual(first.state("grains")["displacement"].shape[1], 3)
            with self.assertRaisesRegex(KeyError, "it has: time"):
                first.history("block", "luck")

    def test_a_run_that_fails_says_why(self):
        with mock.patch.object(verify_context, "RUNS", self.folder / "runs"), \
                mock.patch.dict("os.environ", self.environment(STAND_IN_COUPLER="fails")):
            context = verify_context.Context()
            with self.assertRaisesRegex(Failure, "(?s)ended with code 1.*the energy balance is off"):
                context.run_scene(self.scene)
            self.assertEqual(context.run_scene(self.scene, expect_success=False).code, 1)

    def test_list_names_every_case(self):
        done = self.launch("verify", "--list")
        self.assertEqual(done.returncode, 0)
        self.assertEqual([line.split()[0] for line in done.stdout.splitlines()], list(verify.registry()))

    def test_figures_as_json(self):
        module = types.SimpleNamespace(TITLE="", run=lambda context: [context.figure("a", 3, "m", "< 2")])
        options = mock.Mock(list=False, cases=[], full=False, overrides=[], seed=None, json=True, yes=True)
        with mock.patch.object(verify, "registry", lambda: {"one": module}), \
                mock.patch.object(verify_context, "RUNS", self.folder / "runs"), \
                mock.patch.dict("os.environ", self.environment()), mock.patch("builtins.print") as printed:
            self.assertEqual(verify.main(options), 1)
        self.assertEqual(json.loads(printed.call_args[0][0]),
                         {"case": "one", "figure": "a", "value": 3, "unit": "m", "goal": "< 2", "met": False})


if __name__ == "__main__":
    unittest.main()
