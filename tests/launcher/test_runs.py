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
        self.assertIn("grains 1764, nodes 567", done.stdout)
        self.assertTrue((out / "plots" / "section.png").exists())
        self.assertTrue((out / "continuum_server.log").exists())
        self.assert_nothing_left()

    def test_several_models(self):
        done = self.launch("run", self.scene, "--models", "dem,edge", "--out", "out", "--no-plots",
                           STAND_IN_COUPLER="full")
        self.assertEqual(done.returncode, 0, done.stderr)
        runs = [self.folder / "out" / model for model in ("dem", "edge")]
        for folder in runs:
            summary = json.loads((folder / "summary.json").read_text(encoding="utf-8"))
            self.assertEqual(summary["model"], folder.name)
        self.assertFalse((runs[0] / "continuum_server.log").exists(), "dem needs no continuum")
        done = self.launch("plot", *runs)
        self.assertIn("compare.html", done.stdout)
        self.assertTrue((self.folder / "out" / "plots" / "probe-A.z.png").exists())

    def test_check_starts_no_engine(self):
        done = self.launch("check", self.scene)
        self.assertEqual((done.returncode, done.stdout), (0, "the scene is sound\n"))
        self.assertEqual(self.started(), {})

    def test_overwrite_reaches_the_coupler(self):
        for _ in range(2):
            done = self.launch("run", self.scene, "--out", "out", "--overwrite", "--no-plots")
            self.assertEqual(done.returncode, 0, done.stderr)

    def test_resume_hands_the_checkpoint_to_the_coupler(self):
        broken_off = self.folder / "runs-1"
        broken_off.mkdir()
        done = self.launch("resume", broken_off)
        self.assertEqual(done.returncode, 2)
        self.assertIn("holds no scene.effective.json", done.stderr)
        (broken_off / "scene.effective.json").write_text('{"model": "edge"}', encoding="utf-8")
        done = self.launch("resume", broken_off)
        self.assertIn("holds no checkpoint", done.stderr)
        (broken_off / "checkpoint").write_bytes(b"state")
        done = self.launch("resume", broken_off, "--out", "rest", "--no-plots")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertTrue((self.folder / "rest" / "continuum_server.log").exists())
        self.assert_nothing_left()

    def test_threads_of_the_scene(self):
        self.scene.write_text('{"model": "bridging", "run": {"threads": {"dem": 3}}}', encoding="utf-8")
        self.assertEqual(run.engines("bridging", scenes.threads(self.scene, []))["dem_server"], 3)
        self.assertEqual(scenes.threads(self.scene, ["run.threads=2"]), 2)
        both = run.engines("bridging", scenes.threads(self.scene, ["run.threads=2"]))
        self.assertEqual(both, {"dem_server": 2, "continuum_server": 2})
        self.assertEqual(scenes.threads(self.scene, ["run.threads.continuum=5"]), {"dem": 3, "continuum": 5})
        self.assertEqual(scenes.threads(self.write_scene("dem"), []), None)

    def test_a_scene_may_have_comments(self):
        self.assertEqual(scenes.model(self.scene, []), "bridging")
        self.assertEqual(scenes.model(self.scene, ["model=edge"]), "edge")

    def test_one_engine_alone_has_every_core(self):
        self.assertEqual(list(run.engines("dem", None)), ["dem_server"])
        self.assertEqual(run.engines("bridging", 3), {"dem_server": 3, "continuum_server": 3})


if __name__ == "__main__":
    unittest.main()
