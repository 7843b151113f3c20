"""Starts an engine and talks to it; what the conformance tests share."""

import os
import pathlib
import subprocess
import unittest

from gabion_client import Client, EngineError

TOKEN = "conformance-token"
START_TIMEOUT = 10.0


def executable(name):
    """Path of an engine; the folder is in the environment variable GABION_BIN."""
    folder = os.environ.get("GABION_BIN")
    if not folder:
        raise RuntimeError("set GABION_BIN to the folder of the engines' executables")
    path = pathlib.Path(folder) / name
    if not path.exists():
        raise RuntimeError(f"{path} does not exist: build the target {name} first")
    return str(path)


def start(name, *options, token=TOKEN):
    environment = {k: v for k, v in os.environ.items() if k != "GABION_TOKEN"}
    if token is not None:
        environment["GABION_TOKEN"] = token
    return subprocess.Popen([executable(name), *options], env=environment, stdout=subprocess.PIPE,
                            stderr=subprocess.PIPE, text=True)


def end(process):
    if process.poll() is None:
        process.kill()
    process.wait()
    process.stdout.close()
    process.stderr.close()


class EngineTest(unittest.TestCase):
    """One engine a test; engine_name says which, role what it must call itself."""

    engine_name = role = ""

    def set_up(self, client, measure=0):
        """Sends the smallest model of this engine, up to PREPARE."""
        raise NotImplementedError

    def launch(self, *options):
        self.process = start(self.engine_name, "--threads", "1", *options)
        self.addCleanup(end, self.process)
        words = self.process.stdout.readline().split()
        self.assertEqual(words[:1], ["LISTENING"], "the first line of an engine is LISTENING host port")
        self.host, self.port = words[1], int(words[2])

    def connect(self, timeout=10.0):
        client = Client(self.host, self.port, timeout)
        self.addCleanup(client.close)
        return client

    def greeted(self, *options, timeout=10.0):
        self.launch(*options)
        client = self.connect(timeout)
        client.hello(TOKEN)
        return client

    def status(self, within=5.0):
        """Exit status and what the engine said on its standard error."""
        status = self.process.wait(within)
        return status, self.process.stderr.read()

    def prepared(self, *options, measure=0, timeout=10.0):
        client = self.greeted(*options, timeout=timeout)
        self.set_up(client, measure)
        self.ready = client.ask("PREPARE")
        self.dt = 0.5 * self.ready["stable_step"]
        return client

    def refusal(self, call, *arguments, **fields):
        with self.assertRaises(EngineError) as caught:
            call(*arguments, **fields)
        return caught.exception

    def tie_first(self, client):
        """Point 0 tied by one row to a mass that this test moves."""
        client.ask("TIE", mode="gap", slots=1, row_ptr=[0, 1], columns=[0], values=[-1.0])
