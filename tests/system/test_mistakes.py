"""Users' mistakes: exit code 2, a message that names the place and says what to do, nothing left behind."""

import json
import socket
import threading
import unittest

from fake_engine import FakeEngine, error_of_next_version, garbage, welcome_of_next_version
from programs import NOWHERE, SCENARIOS, SystemTest

EDGE_SPONGE = 'coupling={"edge": {"zone": [["0 m","0 m","0 m"],["0.8 m","0.8 m","1.6 m"]], "sponge": {"strength": 12.8}}}'
MATERIAL = {"normal_stiffness": "3e9 N/m2", "shear_stiffness": "1e9 N/m2"}

# what is set in tiny_lattice.json -> words that the message must hold
SCENE_MISTAKES = {
    "unknown key": (['grains.radios="0.05 m"'], ["grains.radios", "did you mean 'radius'"]),
    "unknown key at the top": (["grounds=1"], ["grounds", "did you mean 'ground'"]),
    "wrong unit": (['mesh.size="0.4 kg"'], ["mesh.size", "0.4 kg", "m"]),
    "bare number": (["mesh.size=0.4"], ["mesh.size", "0.4", "unit"]),
    "unknown unit": (['mesh.size="0.4 furlong"'], ["mesh.size", "furlong"]),
    "negative radius": (['grains.radius="-0.05 m"'], ["grains.radius", "-0.05 m", "above 0"]),
    "not a number": (['mesh.size="wide m"'], ["mesh.size", "wide m"]),
    "zone outside the ground": (['coupling.bridging.zone=[["0 m","0 m","0 m"],["0.8 m","0.8 m","9 m"]]'],
                                ["coupling.bridging.zone", "inside the ground", "ground.box"]),
    "zone that is the ground": (['coupling.bridging.zone=[["0 m","0 m","0 m"],["0.8 m","0.8 m","3.2 m"]]'],
                                ["coupling.bridging.zone", "smaller than the ground"]),
    "corners exchanged": (['ground.box=[["0.8 m","0.8 m","3.2 m"],["0 m","0 m","0 m"]]'], ["ground.box", "lower corner"]),
    "overlap thinner than an element": (['coupling.bridging.overlap="0.35 m"'],
                                        ["coupling.bridging.overlap", "at least 1 element", "0.4 m", "wider"]),
    "overlap as wide as the zone": (['coupling.bridging.overlap="2.4 m"'], ["coupling.bridging.overlap", "narrower"]),
    "elements too small for the grains": (['mesh.size="0.3 m"'], ["mesh.size", "2.5 mean grain diameters", "larger"]),
    "unknown material": (['ground.material="seed_sole"'], ["ground.material", "seed_sole", "did you mean 'seed_soil'"]),
    "unknown model": (["model=bridgeing"], ["model", "bridgeing", "did you mean 'bridging'"]),
    "edge with mortar rows": (["model=edge", "coupling.rows=mortar"], ["coupling.rows", "edge, edge_projected, edge_hats"]),
    "sponge with edge": (["model=edge", EDGE_SPONGE], ["coupling.edge.sponge", "mortar"]),
    "sponge with strict rows": (["coupling.rows=strict", "coupling.sponge.strength=12.8"], ["coupling.sponge", "mortar"]),
    "row_sum with mortar rows": (["coupling.solve=row_sum"], ["coupling.solve", "strict", "exact"]),
    "negative friction": (["materials.mud=" + json.dumps(MATERIAL | {"friction": -0.5}), "ground.material=mud"],
                          ["materials.mud.friction", "-0.5", "at least 0"]),
    "finite strength in frozen contacts": (
        ["materials.mud=" + json.dumps(MATERIAL | {"normal_strength": "1e5 N/m2"}), "ground.material=mud"],
        ["materials.mud.normal_strength", "updated"]),
    "damping of 1.2": (["stages[0].damping=1.2"], ["stages[0].damping", "1.2", "below 1"]),
    "damping 1.2 by the other way of writing": (["stages.0.damping=1.2"], ["stages[0].damping", "1.2"]),
    "stage without an end": (['stages=[{"name": "on"}]'], ["stages[0].duration", "duration"]),
    "stages of one name": (['stages=[{"name": "a", "steps": 1}, {"name": "a", "steps": 1}]'], ["stages[1].name", "rename"]),
    "no whole number of lattice cells": (['ground.box=[["0 m","0 m","0 m"],["0.8 m","0.9 m","3.2 m"]]'],
                                         ["ground.box", "whole number of lattice cells", "y", "grains.radius"]),
    "probe outside": (['probes[1].at=["0.4 m","0.4 m","4 m"]'], ["probes[1].at", "ground.box"]),
    "two probes of one name": (["probes[1].name=head"], ["probes[1].name", "rename"]),
    "face across a periodic direction": (["faces.xmin=fixed"], ["faces.xmin", "periodic"]),
    "unknown face": (["faces.top=fixed"], ["faces.top", "zmax"]),
    "unknown kind of face": (["faces.zmin=fixd"], ["faces.zmin", "did you mean 'fixed'"]),
    "block in frozen grains": (['block={"side": "0.3 m", "mass": "10 kg", "velocity": "1 m/s"}'],
                               ["grains.geometry", "updated"]),
    "gravity along a periodic direction": (['gravity=["9.81 m/s2", "0", "0"]'], ["gravity[0]", "periodic"]),
    "solid fraction above one": (["grains.solid_fraction=1.4"], ["grains.solid_fraction", "1.4", "0.74"]),
    "no radius": (["grains=null"], ["grains", "radius"]),
    "unknown --set key": (["mesh.sise=0.4 m"], ["mesh.sise", "did you mean 'size'"]),
    "--set without a value": (["mesh.size"], ["--set", "key.path=value"]),
    "--set beyond a list": (["probes[7].name=far"], ["probes", "7"]),
    "two mistakes at once": (['mesh.size="0.3 m"', 'probes[0].at=["9 m","0 m","0 m"]'], ["mesh.size", "probes[0].at"]),
}


class Mistake(SystemTest):
    def check_mistake(self, process, *words, folder_kept=False, status=2):
        ended = self.ended(process)
        self.assertEqual(ended.status, status, ended)
        for word in words:
            self.assertIn(word, ended.error)
        self.assertLess(len(ended.error), 2500)
        self.assertFalse(any(sign in ended.error for sign in ("terminate called", "what():", "json.exception", "Assertion")), ended)
        if not folder_kept:
            self.assertFalse(self.out.exists(), f"a half-made run folder: {sorted(p.name for p in self.out.glob('*'))}")
        return ended

    def sets(self, *changes):
        return [word for change in changes for word in ("--set", change)]

    def nowhere(self):
        return ["--dem", NOWHERE, "--continuum", NOWHERE]


class SceneMistakes(Mistake):
    def test_what_the_scene_says(self):
        for name, (changes, words) in SCENE_MISTAKES.items():
            with self.subTest(name):
                process = self.coupler("tiny_lattice.json", *self.nowhere(), *self.sets(*changes))
                self.check_mistake(process, "tiny_lattice.json", *words)

    def test_check_finds_the_same(self):
        process = self.coupler("tiny_lattice.json", "--check", "--set", 'mesh.size="0.3 m"')
        self.check_mistake(process, "mesh.size", "2.5 mean grain diameters")

    def test_missing_scene_file(self):
        self.check_mistake(self.coupler("tiny_latice.json", *self.nowhere()), "tiny_latice.json", "cannot be read")

    def test_scene_that_is_a_folder(self):
        self.check_mistake(self.coupler(self.folder, *self.nowhere()), str(self.folder))

    def test_syntax_error(self):
        scene = self.folder / "slip.json"
        scene.write_text((SCENARIOS / "tiny_lattice.json").read_text().replace('"model": "bridging",', '"model": "bridging"'))
        self.check_mistake(self.coupler(scene, *self.nowhere()), "slip.json", "line 6", "comma")

    def test_empty_scene(self):
        scene = self.folder / "empty.json"
        scene.write_text("")
        self.check_mistake(self.coupler(scene, *self.nowhere()), "empty.json")

    def test_scene_without_ground(self):
        scene = self.folder / "bare.json"
        scene.write_text('{"gabion": 1, "model": "dem", "stages": [{"name": "on", "steps": 1}]}')
        self.check_mistake(self.coupler(scene, *self.nowhere()), "bare.json", "ground")

    def test_format_of_another_time(self):
        self.check_mistake(self.coupler("tiny_lattice.json", *self.nowhere(), "--set", "gabion=2"), "gabion", "2", "1")


class CommandLineMistakes(Mistake):
    def test_no_address_of_an_engine(self):
        for model, wanted in (("dem", "--dem"), ("continuum", "--continuum")):
            with self.subTest(model):
                process = self.coupler("tiny_lattice.json", "--set", f"model={model}")
                self.check_mistake(process, wanted, "HOST:PORT", "start the engine")

    def test_bad_addresses(self):
        for address in ("127.0.0.1", "127.0.0.1:", "127.0.0.1:port", "127.0.0.1:99999", ":80", "127.0.0.1:-5"):
            with self.subTest(address):
                self.check_mistake(self.coupler("tiny_lattice.json", "--dem", address, "--continuum", NOWHERE), address, "host:port")

    def test_host_without_a_name(self):
        process = self.coupler("tiny_lattice.json", "--dem", "no-such-host.invalid:4000", "--continuum", NOWHERE)
        self.check_mistake(process, "no-such-host.invalid")

    def test_unknown_option(self):
        self.check_mistake(self.coupler("tiny_lattice.json", "--threds", "2"), "--threds")

    def test_no_scene(self):
        self.check_mistake(self.start("coupler"), "scene")

    def test_no_token(self):
        addresses = self.engines()
        self.check_mistake(self.coupler("tiny_lattice.json", *addresses, token=None), "GABION_TOKEN")

    def test_token_file_that_is_not_there(self):
        process = self.coupler("tiny_lattice.json", *self.nowhere(), "--token-file", self.folder / "no-token")
        self.check_mistake(process, "--token-file", "no-token")

    def test_run_folder_with_content(self):
        self.out.mkdir()
        (self.out / "diary.txt").write_text("mine")
        for option, words in (((), ["is not empty", "diary.txt", "--out"]), (("--overwrite",), ["diary.txt", "nothing was removed"])):
            with self.subTest(option):
                self.check_mistake(self.coupler("tiny_lattice.json", *self.engines(), *option), str(self.out), *words,
                                   folder_kept=True)
                self.assertEqual([p.name for p in self.out.iterdir()], ["diary.txt"])

    def test_run_folder_that_is_a_file(self):
        self.out.write_text("mine")
        self.check_mistake(self.coupler("tiny_lattice.json", *self.engines()), "is a file", "--out", folder_kept=True)
        self.assertEqual(self.out.read_text(), "mine")


class MistakesThatTheEnginesSee(Mistake):
    def check_with_engines(self, arguments, *words):
        addresses = self.engines("--accept-timeout", "20")
        ended = self.check_mistake(self.coupler("tiny_lattice.json", *addresses, *arguments), *words)
        for engine in (self.dem, self.continuum):
            self.assertNotEqual(self.ended(engine, 5).status, 0)
        return ended

    def test_step_above_the_limit(self):
        self.check_with_engines(self.sets('run.step="1 ms"'), "run.step", "0.001", "stable", "lower it")

    def test_reach_that_ties_nothing(self):
        zone = '[["0 m","0 m","0 m"],["0.8 m","0.8 m","1.65 m"]]'
        self.check_with_engines(self.sets("model=edge", f"coupling.edge.zone={zone}", "coupling.edge.reach=0.01"),
                                "coupling.reach", "at least s/2", "raise")

    def test_packing_that_does_not_fit(self):
        dem, address = self.engine("dem_server")
        process = self.coupler("tiny.json", "--dem", address, *self.sets("model=dem", 'grains.radius={"uniform": ["0.25 m", "0.3 m"]}'))
        self.check_mistake(process, "grains.radius", "grains smaller")

    def test_measuring_without_grains(self):
        _, address = self.engine("continuum_server")
        scene = self.folder / "fresh.json"  # a stiffness that no earlier test has put into the cache
        scene.write_text((SCENARIOS / "tiny_lattice.json").read_text().replace("0.0707106781186548 m", "0.0942809041582064 m"))
        process = self.coupler(scene, "--continuum", address, *self.sets("model=continuum"))
        self.check_mistake(process, "--dem", "dem_server is needed")

    def test_wrong_token(self):
        dem, address = self.engine("dem_server", "--accept-timeout", "2")
        process = self.coupler("tiny_lattice.json", "--dem", address, "--continuum", NOWHERE, token="another")
        self.check_mistake(process, "dem_server", "token", "GABION_TOKEN")
        ended = self.ended(dem, 10)  # waits for the right client until its own time is over
        self.assertEqual(ended.status, 1, ended)
        self.assertIn("refused", ended.error)

    def test_addresses_exchanged(self):
        _, dem, _, continuum = self.engines("--accept-timeout", "20")
        process = self.coupler("tiny_lattice.json", "--dem", continuum, "--continuum", dem)
        self.check_mistake(process, "--dem", "--continuum", "swap")
        self.assertNotEqual(self.ended(self.continuum, 5).status, 0)

    def test_the_same_address_twice(self):
        dem, address = self.engine("dem_server")
        process = self.coupler("tiny_lattice.json", "--dem", address, "--continuum", address)
        self.check_mistake(process, "--continuum")

    def test_nobody_listens(self):
        with socket.create_server(("127.0.0.1", 0)) as free:
            address = "127.0.0.1:%d" % free.getsockname()[1]
        process = self.coupler("tiny_lattice.json", "--dem", address, "--continuum", NOWHERE)
        self.check_mistake(process, "dem_server", address, "is it running?", status=1)

    def test_engine_of_another_version(self):
        for reply in (welcome_of_next_version, error_of_next_version):
            with self.subTest(reply.__name__):
                engine = FakeEngine(reply)
                self.addCleanup(engine.close)
                process = self.coupler("tiny_lattice.json", "--dem", engine.address, "--continuum", NOWHERE)
                self.check_mistake(process, "version", "2", "same release")

    def test_address_of_no_engine(self):
        engine = FakeEngine(garbage)
        self.addCleanup(engine.close)
        process = self.coupler("tiny_lattice.json", "--dem", engine.address, "--continuum", NOWHERE)
        self.check_mistake(process, "dem_server", engine.address, "does not speak this protocol", status=1)


class EngineMistakes(Mistake):
    """Each of the two engines by itself."""

    def check_engine(self, arguments, *words, token="token"):
        for name in ("dem_server", "continuum_server"):
            with self.subTest(name, arguments=arguments):
                ended = self.check_mistake(self.start(name, *arguments, token=token), *words)
                self.assertNotIn("LISTENING", ended.out)

    def test_port_taken(self):
        with socket.create_server(("127.0.0.1", 0)) as taken:
            address = "127.0.0.1:%d" % taken.getsockname()[1]
            self.check_engine(["--listen", address], address, "in use")

    def test_address_of_another_machine(self):
        self.check_engine(["--listen", "192.0.2.1:0"], "192.0.2.1")

    def test_bad_addresses(self):
        for address in ("4000", "127.0.0.1:port", "127.0.0.1:99999"):
            self.check_engine(["--listen", address], address, "host:port")

    def test_options(self):
        self.check_engine(["--thread-count", "2"], "--thread-count")
        self.check_engine(["--threads", "0"], "--threads", "0")
        self.check_engine(["--threads", "-3"], "--threads", "-3")
        self.check_engine(["--threads", "two"], "--threads", "two")
        self.check_engine(["--accept-timeout", "-1"], "--accept-timeout")

    def test_more_threads_than_can_be(self):
        self.check_engine(["--threads", "1000000"], "--threads", "1000000")

    def test_no_token(self):
        self.check_engine([], "GABION_TOKEN", "--token-file", token=None)
        self.check_engine(["--token-file", self.folder / "none"], "none", token=None)


if __name__ == "__main__":
    unittest.main()
