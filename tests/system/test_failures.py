"""Processes that die, freeze or are interrupted in the middle of a run: everybody else ends, and says why."""

import re
import signal
import time
import unittest

import h5py

from programs import SystemTest

LONG = ("--set", "stages[0].duration=1000 s", "--set", "output.every=100 ms")  # far longer than any test waits
SOON = 5.0  # s, in which the others must have ended once a process is gone
REPLY_DEADLINE = 20.0  # s, of the coupler; docs/running.md, "Deadlines"


class Failures(SystemTest):
    def run_long(self, *options, model="bridging"):
        addresses = self.engines(*options)
        self.run_process = self.coupler("tiny_lattice.json", *addresses, *LONG, "--set", f"model={model}")
        return self.wait_for_steps(self.run_process)

    def check_results_can_be_read(self):
        self.assertFalse((self.out / "summary.json").exists(), "a summary of a run that did not finish")
        with h5py.File(self.out / "results.h5") as file:
            last = len(file["states/time"]) - 1
            self.assertIn("displacement", file[f"grains/state_{last:06d}"])

    def step_named_in(self, text):
        steps = re.findall(r"step (\d+)\)", text)
        self.assertTrue(steps, f"no step in: {text}")
        return int(steps[-1])

    def test_engine_killed(self):
        for name in ("dem", "continuum"):
            with self.subTest(name):
                self.out = self.folder / name
                before = self.run_long()
                victim, other = (self.dem, self.continuum) if name == "dem" else (self.continuum, self.dem)
                victim.kill()
                ended = self.ended(self.run_process, SOON)
                self.assertEqual(ended.status, 1, ended)
                self.assertIn(f"{name}_server", ended.error)
                self.assertRegex(ended.error, "closed the connection|connection is lost")
                self.assertGreaterEqual(self.step_named_in(ended.error), before)
                self.assertIn(f"{name}_server", (self.out / "run.log").read_text())
                survivor = self.ended(other, SOON)
                self.assertEqual(survivor.status, 1, survivor)
                self.assertIn("coupler", survivor.error)
                self.check_results_can_be_read()

    def test_engine_killed_while_it_runs_alone(self):
        self.run_long(model="dem")
        self.dem.kill()
        ended = self.ended(self.run_process, SOON)
        self.assertEqual(ended.status, 1, ended)
        self.assertIn("dem_server", ended.error)

    def test_engine_frozen(self):
        before = self.run_long()
        self.continuum.send_signal(signal.SIGSTOP)
        begin = time.monotonic()
        ended = self.ended(self.run_process, REPLY_DEADLINE + SOON)
        self.assertGreater(time.monotonic() - begin, 0.5 * REPLY_DEADLINE)
        self.assertEqual(ended.status, 1, ended)
        self.assertIn("continuum_server", ended.error)
        self.assertGreaterEqual(self.step_named_in(ended.error), before)
        self.assertEqual(self.ended(self.dem, SOON).status, 1)
        self.continuum.send_signal(signal.SIGCONT)  # wakes up to find nobody there
        self.assertEqual(self.ended(self.continuum, SOON).status, 1)

    def test_coupler_killed(self):
        self.run_long()
        self.run_process.kill()
        for engine in (self.dem, self.continuum):
            ended = self.ended(engine, SOON)
            self.assertEqual(ended.status, 1, ended)
            self.assertIn("coupler", ended.error)
        self.ended(self.run_process)
        self.check_results_can_be_read()

    def test_coupler_frozen(self):
        # it may be caught in the middle of a step or between two requests: the deadline is the same
        before = self.run_long("--io-timeout", "2")
        self.run_process.send_signal(signal.SIGSTOP)
        for engine in (self.dem, self.continuum):
            ended = self.ended(engine, 2 + SOON)
            self.assertEqual(ended.status, 1, ended)
            self.assertIn("coupler", ended.error)
            self.assertRegex(ended.error, "MULTIPLIERS|the next request")
            self.assertGreaterEqual(self.step_named_in(ended.error), before)

    def test_coupler_frozen_between_two_requests(self):
        """While grains are packed the other engine waits: as long as the coupler shows that it works, no longer."""
        deadline = 2.0
        addresses = self.engines("--io-timeout", str(deadline))
        deep = 'ground.box=[["0 m", "0 m", "-24 m"], ["0.9 m", "0.9 m", "0 m"]]'  # 27 000 grains, which take a while
        process = self.coupler("column.json", *addresses, "--set", deep)
        time.sleep(deadline + 1.5)
        for alive in (process, self.dem, self.continuum):
            self.assertIsNone(alive.poll(), "ended while the grains were packed")
        process.send_signal(signal.SIGSTOP)
        begin = time.monotonic()
        ended = self.ended(self.continuum, deadline + SOON)
        self.assertGreater(time.monotonic() - begin, 0.5 * deadline)
        self.assertEqual(ended.status, 1, ended)
        self.assertIn("coupler", ended.error)
        self.assertIn("'preparing'", ended.error)

    def test_coupler_interrupted(self):
        self.run_long()
        self.run_process.send_signal(signal.SIGINT)
        ended = self.ended(self.run_process, SOON)
        self.assertNotEqual(ended.status, 0, ended)
        for engine in (self.dem, self.continuum):
            self.assertNotEqual(self.ended(engine, SOON).status, 0)
        self.check_results_can_be_read()
        self.assertIn("interrupted", ended.error)  # the user is told what became of the run

    def test_interface_that_turns_too_far(self):
        addresses = self.engines()
        process = self.coupler("tiny_lattice.json", *addresses, "--set", "coupling.rotation_limit=0.01 rad", "--set",
                               'faces.zmax={"velocity": ["3 m/s", "0 m/s", "0 m/s"]}', "--set", "stages[0].duration=200 ms")
        ended = self.ended(process)
        self.assertEqual(ended.status, 3, ended)
        for word in ("stage 'pulse'", "turned by", "coupling.rotation_limit"):
            self.assertIn(word, ended.error)
        for engine in (self.dem, self.continuum):
            self.assertNotEqual(self.ended(engine, SOON).status, 0)

    def test_balance_beyond_its_tolerance(self):
        addresses = self.engines()
        process = self.coupler("tiny.json", *addresses, "--set", "run.energy_tolerance=1e-12")
        ended = self.ended(process)
        self.assertEqual(ended.status, 3, ended)
        for word in ("energy balance", "run.energy_tolerance", "energy.csv"):
            self.assertIn(word, ended.error)


if __name__ == "__main__":
    unittest.main()
