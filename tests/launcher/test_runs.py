"""What a run starts and what it leaves behind."""

import json
import unittest

from fixture import LauncherTest

from gabion_tools import run, scenes


class RunsTest(LauncherTest):
    def test_a_run_from_scene_to_report(self):
        done = self.launch("run", self.scene, "--out", "out", STAND_IN_COUPLER="full")
        self.assertEqual(done.returncode, 0, done.stderr)
        out = self.folder / "out"
        page = (out / "report.html").read_text(encoding="utf-8")
        self.assertIn("data:image/png;base64,", page)
        self.assertIn("0.5 % of the contacts of the overlap slide &lt;&amp;&gt;", page)
        self.assertIn("sizes grains", done.stdout)
        self.assertTrue((out / "plots" / "section.png").exists())
        self.assertTrue((out / "continuum_server.log").exists())
        self.assert_nothing_left()

    def test_several_models_are_compared(self):
        done = self.launch("run", self.scene, "--models", "dem,edge", "--out", "out", STAND_IN_COUPLER="full")
        self.assertEqual(done.returncode, 0, done.stderr)
        for model in ("dem", "edge"):
            summary = json.loads((self.folder / "out" / model / "summary.json").read_text(encoding="utf-8"))
            self.assertEqual(summary["model"], model)
        self.assertFalse((self.folder / "out" / "dem" / "continuum_server.log").exists())
        self.assertTrue((self.folder / "out" / "plots" / "probe-A.z.png").exists())
        self.assertIn("compare.html", done.stdout)

    def test_check_starts_no_engine(self):
        done = self.launch("check", self.scene)
        self.assertEqual((done.returncode, done.stdout), (0, "the scene is sound\n"))
        self.assertEqual(self.started(), {})

    def test_overwrite_reaches_the_coupler(self):
        for _ in range(2):
            done = self.launch("run", self.scene, "--out", "out", "--overwrite", "--no-plots")
            self.assertEqual(done.returncode, 0, done.stderr)

    def test_a_scene_may_have_comments(self):
        self.assertEqual(scenes.model(self.scene, []), "bridging")
        self.assertEqual(scenes.model(self.scene, ["model=edge"]), "edge")

    def test_one_engine_alone_has_every_core(self):
        self.assertEqual(list(run.engines("dem", None)), ["dem_server"])
        self.assertEqual(run.engines("bridging", 3), {"dem_server": 3, "continuum_server": 3})


if __name__ == "__main__":
    unittest.main()
