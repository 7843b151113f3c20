"""How every engine must treat its client: starting, handshake, broken bytes, states, trouble."""

import math
import signal
import time

import models
from engine_process import TOKEN, start
from gabion_client import MESSAGES, VERSION, encode, frame


class SessionCases:
    # ---- starting and ending

    def test_bye_ends_the_engine_with_status_0(self):
        client = self.greeted()
        client.ask("BYE")
        self.assertEqual(self.status()[0], 0)

    def test_wrong_usage_ends_with_status_2(self):
        self.launch()
        for options, token in ((["--no-such-option"], TOKEN), (["--listen", "nowhere"], TOKEN), ([], None),
                               (["--listen", f"{self.host}:{self.port}"], TOKEN), (["--threads", "0"], TOKEN)):
            with self.subTest(options=options, token=token):
                process = start(self.engine_name, *options, token=token)
                errors = process.communicate(timeout=10)[1]
                self.assertEqual(process.returncode, 2, errors)
                self.assertNotEqual(errors, "", "the engine says what was wrong")

    def test_nobody_connects(self):
        self.launch("--accept-timeout", "0.3")
        began = time.monotonic()
        status, errors = self.status()
        self.assertEqual(status, 1)
        self.assertIn("nobody connected", errors)
        self.assertLess(time.monotonic() - began, 2.0)

    # ---- handshake

    def test_welcome(self):
        self.launch()
        welcome = self.connect().hello(TOKEN)
        self.assertEqual(welcome["protocol_version"], VERSION)
        self.assertEqual(welcome["role"], self.role)
        self.assertEqual(welcome["threads"], 1)
        self.assertIn("field:displacement", welcome["capabilities"])
        self.assertIn("field:velocity", welcome["capabilities"])

    def test_intruders_are_turned_away_and_the_right_client_served(self):
        self.launch()
        client = self.connect()
        self.assertEqual(self.refusal(client.hello, "wrong").code, "token")
        with self.assertRaises(ConnectionError):
            client.receive_any()
        self.assertEqual(self.refusal(self.connect().hello, "").code, "token")
        self.assertEqual(self.refusal(self.connect().hello, TOKEN, version=VERSION + 1).code, "version")
        self.assertEqual(self.refusal(self.connect().ask, "PREPARE").code, "state")
        client = self.connect()
        client.send_raw(MESSAGES["HELLO"]["id"], b"", version=VERSION + 1)
        self.assertEqual(self.refusal(client.receive, "WELCOME").code, "version")
        for garbage in (b"GET / HTTP/1.1\r\n\r\n", bytes(200), b"\xff" * 8, b"GABN"):
            client = self.connect()
            client.send_bytes(garbage)
            client.close()
        self.connect().hello(TOKEN)

    def test_a_frame_that_is_too_large_before_the_handshake_is_refused(self):
        self.launch()
        client = self.connect()
        client.send("HELLO", protocol_version=VERSION, token=TOKEN, software="x" * 100000)
        with self.assertRaises(ConnectionError):
            client.receive_any()
        self.connect().hello(TOKEN)

    # ---- broken bytes

    def test_broken_frames_end_the_session(self):
        payload = encode("FETCH", {"field": "velocity"})
        sound = frame(MESSAGES["FETCH"]["id"], 1, 0, payload)
        flipped = bytearray(sound)
        flipped[-1] ^= 1
        for name, data in (("checksum", bytes(flipped)), ("sequence", frame(MESSAGES["FETCH"]["id"], 7, 0, payload)),
                           ("magic", b"NOPE" + sound[4:])):
            with self.subTest(name):
                client = self.greeted()
                client.send_bytes(data)
                with self.assertRaises(ConnectionError):
                    client.receive_any()
                self.assertEqual(self.status()[0], 1)

    def test_malformed_payloads_are_refused_and_the_session_goes_on(self):
        client = self.prepared()
        fetch = MESSAGES["FETCH"]["id"]
        for payload in (b"", b"\x05\0\0\0vel", b"\0\0\0\0\0", b"\xff\xff\xff\xff"):
            client.send_raw(fetch, payload)
            self.assertEqual(self.refusal(client.receive, "FIELD").code, "value")
        absurd = encode("FETCH", {"field": "velocity"}) + b"\x02" + b"\xff" * 16
        client.send_raw(MESSAGES["SET_FIELD"]["id"], absurd)
        self.assertEqual(self.refusal(client.receive, "OK").code, "value")
        client.send_raw(9999, b"")
        self.assertEqual(self.refusal(client.receive, "OK").code, "value")
        client.ask("STABLE_STEP")

    # ---- states

    def test_requests_in_the_wrong_state_are_refused_and_the_session_goes_on(self):
        client = self.greeted()
        run = dict(steps=1, dt=1e-6)
        self.assertEqual(self.refusal(client.ask, "RUN", **run).code, "state")
        self.assertEqual(self.refusal(client.ask, "FETCH", field="velocity").code, "state")
        self.assertEqual(self.refusal(client.ask, "HELLO").code, "state")
        self.set_up(client)
        client.ask("PREPARE")
        client.ask("RUN", **run)
        client.send("MULTIPLIERS", values=[[0, 0, 0]])
        self.assertEqual(self.refusal(client.receive, "OK").code, "state")
        client.ask("OPTIONS", **models.options())
        self.assertEqual(self.refusal(client.ask, "RUN", **run).code, "state")
        client.ask("PREPARE")
        client.ask("RUN", **run)
        client.ask("BYE")

    def test_values_out_of_range_are_refused_by_name(self):
        client = self.prepared()
        for fields in (dict(steps=0, dt=1e-6), dict(steps=1, dt=0.0), dict(steps=1, dt=math.nan),
                       dict(steps=1, dt=1e-6, damping=1.0), dict(steps=1, dt=1e-6, measure=1)):
            error = self.refusal(client.ask, "RUN", **fields)
            self.assertEqual(error.code, "value", fields)
            self.assertTrue(error.where.startswith("RUN."), error.where)
        self.assertIn("nonsense", str(self.refusal(client.ask, "FETCH", field="nonsense")))
        self.assertIn("4096", str(self.refusal(client.ask, "CONSTRAIN", name="a", entities=[4096], components=1,
                                               direction=[1, 0, 0], history_kind="zero")))
        self.assertIn("sawtooth", str(self.refusal(client.ask, "LOADS", name="a", history_kind="sawtooth")))
        self.assertEqual(self.refusal(client.ask, "TIE", mode="gap", slots=1, row_ptr=[0, 1], columns=[4096],
                                      values=[1.0]).code, "value")
        self.assertEqual(self.refusal(client.ask, "SET_FIELD", field="velocity", values=[[0, 0, 0]]).code, "value")
        self.assertEqual(self.refusal(client.ask, "RESTORE", blob=[1, 2, 3]).code, "value")
        client.ask("RUN", steps=1, dt=1e-6)

    # ---- trouble

    def test_a_client_that_dies_is_noticed_at_once(self):
        for in_run in (False, True):
            client = self.prepared()
            if in_run:
                self.tie_first(client)
                client.send("RUN", steps=10, dt=self.dt)
                client.receive("GAP")
            began = time.monotonic()
            client.close()
            status, errors = self.status()
            self.assertEqual(status, 1)
            self.assertIn("closed the connection", errors)
            self.assertLess(time.monotonic() - began, 1.0)

    def test_a_client_that_freezes_in_a_run_is_noticed_at_the_deadline(self):
        client = self.prepared("--io-timeout", "0.4")
        self.tie_first(client)
        client.send("RUN", steps=10, dt=self.dt, first_step=41, frame_step=41)
        client.receive("GAP")
        began = time.monotonic()
        error = self.refusal(client.receive, "RUN_DONE")
        waited = time.monotonic() - began
        self.assertEqual(error.code, "timeout")
        self.assertEqual(error.step, 41)
        self.assertGreater(waited, 0.3)
        self.assertLess(waited, 1.0)
        status, errors = self.status()
        self.assertEqual(status, 1)
        self.assertIn("coupler", errors)
        self.assertIn("step 41", errors)

    def test_a_client_that_asks_for_nothing_is_noticed_at_the_deadline(self):
        client = self.prepared("--idle-timeout", "0.4")
        self.assertEqual(self.refusal(client.receive, "OK").code, "timeout")
        self.assertEqual(self.status()[0], 1)

    def test_a_client_that_has_sent_no_heartbeat_may_wait(self):
        client = self.prepared("--io-timeout", "0.3")
        time.sleep(0.8)
        client.ask("RUN", steps=1, dt=self.dt)

    def test_a_client_that_sends_heartbeats_is_missed_when_they_cease(self):
        client = self.prepared("--io-timeout", "0.5", "--idle-timeout", "0.6")
        for _ in range(6):
            client.beat("writing", 7)
            time.sleep(0.2)
        client.ask("RUN", steps=3, dt=self.dt, first_step=7)
        client.ask("CHECKPOINT")
        client.beat("thinking", 10)
        began = time.monotonic()
        error = self.refusal(client.receive, "OK")
        waited = time.monotonic() - began
        self.assertEqual(error.code, "timeout")
        self.assertEqual(error.step, 10)
        self.assertIn("'thinking'", error.message)
        self.assertGreater(waited, 0.4)
        self.assertLess(waited, 1.0)
        status, errors = self.status()
        self.assertEqual(status, 1)
        for words in ("coupler", "step 10", "last CHECKPOINT was at step 10"):
            self.assertIn(words, errors)

    def test_an_engine_that_dies_or_freezes_is_noticed(self):
        client = self.prepared(timeout=0.5)
        self.tie_first(client)
        client.send("RUN", steps=10, dt=self.dt)
        client.receive("GAP")
        self.process.send_signal(signal.SIGSTOP)
        client.send("MULTIPLIERS", values=[[0, 0, 0]])
        began = time.monotonic()
        with self.assertRaises(TimeoutError):
            client.receive("GAP")
        self.assertLess(time.monotonic() - began, 1.0)
        self.process.kill()
        with self.assertRaises(ConnectionError):
            while True:
                client.receive_any()

    def test_heartbeats_come_while_a_request_takes_long(self):
        client = self.prepared(timeout=2.0)
        trial = 2000
        began = time.monotonic()
        client.run(trial, self.dt)
        steps = int(trial * 3.5 / (time.monotonic() - began)) + trial
        began = time.monotonic()
        client.run(steps, self.dt)
        took = time.monotonic() - began
        self.assertGreater(took, 1.5, "the run was too short to say anything")
        self.assertLessEqual(abs(len(client.heartbeats) - int(took)), 1)
        moments = [moment for moment, _ in client.heartbeats]
        for earlier, later in zip(moments, moments[1:]):
            self.assertAlmostEqual(later - earlier, 1.0, delta=0.4)
        self.assertGreater(client.heartbeats[-1][1]["step"], 0)
        with self.assertRaises(TimeoutError):  # and none while the engine waits
            client.receive_any()
