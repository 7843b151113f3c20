"""Engines that do not start, die, or must be stopped: a message, the right exit code, nothing left behind."""

import os
import signal
import subprocess
import time
import unittest
from unittest import mock

from fixture import REPOSITORY, LauncherTest

from gabion_tools import processes
from gabion_tools.errors import Failure


class ProcessesTest(LauncherTest):
    def assert_failure(self, done, *parts):
        self.assertEqual(done.returncode, 1, done.stdout + done.stderr)
        for part in parts:
            self.assertIn(part, done.stdout + done.stderr)
        self.assertNotIn("Traceback", done.stderr)
        self.assert_nothing_left()

    def test_an_engine_that_dies_at_its_start(self):
        done = self.launch("run", self.scene, "--out", "out", STAND_IN_DEM="dies")
        self.assert_failure(done, "dem_server ended with code 3", "no memory for that")
        self.assertEqual((self.folder / "out" / "dem_server.log").read_text(), "no memory for that\n")

    def test_an_engine_that_says_something_else(self):
        self.assert_failure(self.launch("run", self.scene, "--out", "out", STAND_IN_CONTINUUM="babbles"),
                            "continuum_server said 'hello world'", "LISTENING HOST PORT")

    def test_a_coupler_that_fails(self):
        self.assert_failure(self.launch("run", self.scene, "--out", "out", STAND_IN_COUPLER="fails"),
                            "step 12: the energy balance is off", "ended with code 1")

    def couple_here(self, **behaviour):
        with mock.patch.dict(os.environ, self.environment(**behaviour)):
            return processes.couple(self.scene, [], self.folder, {"dem_server": 1, "continuum_server": 1}, quiet=True)

    def test_an_engine_that_says_nothing(self):
        with mock.patch.object(processes, "LISTEN_DEADLINE", 0.5), self.assertRaisesRegex(Failure, "said nothing"):
            self.couple_here(STAND_IN_DEM="silent")
        self.assert_nothing_left()

    def test_an_engine_that_dies_while_the_coupler_hangs(self):
        with mock.patch.object(processes, "REPORT_GRACE", 0.5), \
                self.assertRaisesRegex(Failure, "(?s)coupler did not notice.*grain 7 is lost"):
            self.couple_here(STAND_IN_DEM="dies later", STAND_IN_COUPLER="hangs")
        self.assert_nothing_left()

    def interrupt(self, number):
        launcher = subprocess.Popen([str(REPOSITORY / "scripts" / "gabion"), "run", str(self.scene), "--out", "out"],
                                    cwd=self.folder, env=self.environment(STAND_IN_COUPLER="hangs"),
                                    stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.PIPE)
        end = time.monotonic() + 20
        while len(self.started()) < 3 and time.monotonic() < end:
            time.sleep(0.05)
        self.assertEqual(len(self.started()), 3)
        time.sleep(0.3)
        launcher.send_signal(number)
        _, errors = launcher.communicate(timeout=20)
        return launcher.returncode, errors.decode()

    def test_interrupt_stops_everything(self):
        code, errors = self.interrupt(signal.SIGINT)
        self.assertEqual(code, 130)
        self.assertIn("stopped", errors)
        self.assert_nothing_left()

    def test_terminate_stops_everything(self):
        self.assertEqual(self.interrupt(signal.SIGTERM)[0], 130)
        self.assert_nothing_left()

    def test_a_launcher_that_is_killed_takes_everything_with_it(self):
        self.assertEqual(self.interrupt(signal.SIGKILL)[0], -signal.SIGKILL)
        time.sleep(0.5)
        self.assert_nothing_left()


if __name__ == "__main__":
    unittest.main()
