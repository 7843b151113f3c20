"""A peer that is killed, freezes or talks nonsense at any point of set-up, step and reply; numbers that are none."""

import concurrent.futures
import unittest

from programs import SCENARIOS, SystemTest, figure
from proxy import Proxy

PATIENCE = 1.0  # s
SOON = 10.0
STEP = 17

# before, in and after the steps: every kind of frame that a coupled run exchanges
POINTS = (("to", "HELLO", None), ("from", "WELCOME", None), ("to", "OPTIONS", None), ("from", "OK", None),
          ("to", "PREPARE", None), ("from", "READY", None), ("to", "TIE", None), ("to", "RUN", None), ("from", "GAP", 0),
          ("to", "MULTIPLIERS", 0), ("from", "GAP", STEP), ("to", "MULTIPLIERS", STEP), ("from", "RUN_DONE", None),
          ("to", "FETCH", None), ("from", "FIELD", None), ("to", "BYE", None))
FROZEN = (("from", "WELCOME", None), ("from", "READY", None), ("to", "RUN", None), ("from", "GAP", STEP),
          ("to", "MULTIPLIERS", STEP), ("from", "FIELD", None))
SCENE = ("--set", 'stages=[{"name": "go", "steps": 60}]', "--set", "output.monitor_steps=40", "--io-timeout", str(PATIENCE))


class PeerTest(SystemTest):
    def run_with(self, role, fault, number, *options, entry=0):
        """Ended coupler, both engines' ends, the proxy."""
        processes, addresses = {}, []
        for name in ("dem", "continuum"):
            processes[name], address = self.engine(f"{name}_server", "--io-timeout", str(PATIENCE), "--idle-timeout", "3",
                                                   "--accept-timeout", "3")
            if name == role:
                proxy = Proxy(address, fault, entry)
                self.addCleanup(proxy.close)
                address = proxy.address
            addresses += [f"--{name}", address]
        scene = SCENARIOS / "tiny_lattice.json"
        process = self.start("coupler", scene, "--out", self.folder / f"run-{number}", *addresses, *SCENE, *options)
        ended = self.ended(process, SOON)
        return ended, {name: self.ended(engine, SOON) for name, engine in processes.items()}, proxy


class Peers(PeerTest):
    def check_one(self, role, fault, number):
        ended, engines, proxy = self.run_with(role, fault, number)
        case = f"{role}: {fault}"
        self.assertTrue(proxy.done, f"{case}: the frame never came\n{ended}")
        last_word = fault[1] == "BYE"  # nothing is lost any more but the farewell
        self.assertNotEqual(ended.status, 0, f"{case}\n{ended}")
        self.assertIn(f"{role}_server", ended.error, f"{case}\n{ended}")
        self.assertNotRegex(ended.error, "terminate called|what\\(\\)|Assertion", case)
        for name, end in engines.items():
            if not last_word:
                self.assertNotEqual(end.status, 0, f"{case}, engine {name}\n{end}")
            self.assertNotRegex(end.error, "terminate called|what\\(\\)|Assertion", case)
        if fault[2] is not None:  # what went to the engine is missed when the next gap is due
            self.assertRegex(ended.error, rf"step ({fault[2]}|{fault[2] + 1})\b", f"{case}\n{ended}")

    def check_all(self, faults):
        with concurrent.futures.ThreadPoolExecutor(6) as pool:
            jobs = [pool.submit(self.check_one, role, fault, number) for number, (role, fault) in enumerate(faults)]
            for job in jobs:
                job.result()
        return len(jobs)

    def test_at_every_point(self):
        self.run_scene("tiny_lattice.json", "stages[0].duration=1 ms", out="warm")  # the lattice's stiffness is in the cache then
        faults = []
        for k, point in enumerate(POINTS):
            for r, role in enumerate(("dem", "continuum")):
                faults.append((role, (*point, "kill")))
                faults.append((role, (*point, "garbage" if (k + r) % 2 else "flip")))
        for point in FROZEN:
            faults += [(role, (*point, "freeze")) for role in ("dem", "continuum")]
        count = self.check_all(faults)
        figure("peer_faults_survived", count)


class Numbers(PeerTest):
    def test_a_number_that_is_none_stops_the_run_in_its_step(self):
        after = []
        for role in ("dem", "continuum"):
            with self.subTest(role):
                ended, engines, proxy = self.run_with(role, ("from", "GAP", STEP, "nan"), role, entry=7)
                self.assertEqual(ended.status, 3, ended)
                for words in (f"step {STEP}", f"{role}_server sent", "component y of GAP row 2", "m: the motion"):
                    self.assertIn(words, ended.error)
                self.assertNotIn("MULTIPLIERS", proxy.passed_after)  # not one more step
                after.append(proxy.passed_after.count("MULTIPLIERS"))
                for end in engines.values():
                    self.assertNotEqual(end.status, 0)
        figure("steps_after_nan", max(after))

    def test_masses_that_are_none_are_refused(self):
        self.run_scene("tiny_lattice.json", "stages[0].duration=1 ms", out="warm")
        for role, entity in (("dem", "grain"), ("continuum", "node")):
            with self.subTest(role):
                # the first array of READY: the tie would divide by it
                ended, _, _ = self.run_with(role, ("from", "READY", None, "nan"), f"{role}-mass")
                self.assertEqual(ended.status, 3, ended)
                self.assertIn(f"{role}_server gives {entity} 0 the mass nan kg", ended.error)


if __name__ == "__main__":
    unittest.main()
