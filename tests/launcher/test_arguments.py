"""What the user gets wrong: exit code 2 and a message that says what to do."""

import unittest

from fixture import LauncherTest


class ArgumentsTest(LauncherTest):
    def assert_mistake(self, done, *parts):
        self.assertEqual(done.returncode, 2, done.stderr)
        for part in parts:
            self.assertIn(part, done.stderr)
        self.assertNotIn("Traceback", done.stderr)
        self.assertEqual(self.started(), {}, "nothing may be started")

    def test_unknown_command(self):
        self.assert_mistake(self.launch("fly"), "invalid choice", "'fly'")

    def test_unknown_scene_names_the_nearest(self):
        self.assert_mistake(self.launch("run", "triaxal"), "no scene 'triaxal'", "did you mean triaxial?")

    def test_unknown_model_names_the_nearest(self):
        self.assert_mistake(self.launch("run", self.scene, "--model", "brigding"), "did you mean bridging?")
        self.assert_mistake(self.launch("run", self.scene, "--models", ","), "at least one of dem")

    def test_model_and_models(self):
        self.assert_mistake(self.launch("run", self.scene, "--model", "dem", "--models", "all"), "exclude each other")

    def test_set_without_a_value(self):
        self.assert_mistake(self.launch("run", self.scene, "--set", "model"), "--set model: expected key=value")

    def test_no_threads(self):
        self.assert_mistake(self.launch("run", self.scene, "--threads", "0"), "at least 1")

    def test_run_folder_with_content(self):
        out = self.folder / "out"
        out.mkdir()
        (out / "thesis.tex").write_text("years of work", encoding="utf-8")
        self.assert_mistake(self.launch("run", self.scene, "--out", out), "not empty", "--overwrite")
        self.assert_mistake(self.launch("run", self.scene, "--out", self.scene), "is a file")

    def test_a_scene_that_the_coupler_refuses(self):
        done = self.launch("run", self.scene, "--out", self.folder / "out", STAND_IN_COUPLER="refuses")
        self.assert_mistake(done, "mesh.size: expected a length")
        self.assertFalse((self.folder / "out").exists())

    def test_plot_of_something_else(self):
        self.assert_mistake(self.launch("plot", self.folder), "not a run folder")

    def test_unknown_case(self):
        self.assert_mistake(self.launch("verify", "luck"), "no case 'luck'", "determinism")

    def test_calibrate_without_a_pressure(self):
        self.assert_mistake(self.launch("calibrate", self.scene, "--young", "500", "--poisson", "0.3"), "'500 MPa'")
        self.assert_mistake(self.launch("calibrate", self.scene, "--young", "5 MPa", "--poisson", "3"), "between 0 and")

    def test_binaries_that_are_not_there(self):
        (self.bin / "coupler").unlink()
        done = self.launch("run", self.scene)
        self.assertEqual(done.returncode, 1)
        self.assertIn("no executable", done.stderr)


if __name__ == "__main__":
    unittest.main()
