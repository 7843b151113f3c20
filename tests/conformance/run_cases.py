"""What a run of every engine must give, whatever it computes: state, energy, probes, ties."""

import math


class RunCases:
    # ---- state of the engine

    def shake(self, client):
        points = len(self.ready["mass"].values)
        client.ask("SET_FIELD", field="velocity",
                   values=[[1e-3 * math.sin(3 * i + axis) for axis in range(3)] for i in range(points)])

    def test_a_restored_run_gives_the_same_bits(self):
        client = self.prepared()
        self.shake(client)
        client.run(20, self.dt)
        blob = client.ask("CHECKPOINT")["blob"]
        there = client.run(30, self.dt, first_step=20)
        velocity = client.ask("FETCH", field="velocity")["values"]
        client.run(7, self.dt)
        client.ask("RESTORE", blob=blob)
        again = client.run(30, self.dt, first_step=20)
        self.assertEqual(again["state_hash"], there["state_hash"])
        self.assertEqual(client.ask("FETCH", field="velocity")["values"], velocity)
        self.assertNotEqual(client.run(1, self.dt)["state_hash"], there["state_hash"])

        other = self.prepared()  # another process, set up the same way
        other.ask("RESTORE", blob=blob)
        self.assertEqual(other.run(30, self.dt, first_step=20)["state_hash"], there["state_hash"])

    def test_energy_is_conserved(self):
        client = self.prepared(measure=1)
        self.shake(client)
        balances = []
        for _ in range(30):
            done = client.run(7, self.dt, measure=1)
            signs = [(1, 1, -1, 0)[kind] for kind in done["ledger_kinds"].values]
            balances.append(sum(sign * e for sign, e in zip(signs, done["ledger"].values)))
        self.assertGreater(balances[0], 0.0)
        self.assertLess(max(balances) - min(balances), 1e-9 * balances[0])

    def test_probes_and_numbers_of_a_run(self):
        client = self.prepared()
        client.ask("PROBES", names=["first", "sum"], row_ptr=[0, 1, 3], entities=[0, 0, 1],
                   coefficients=[1.0, 1.0, 1.0], every=3)
        self.shake(client)
        done = client.run(10, self.dt, first_step=5, time=2.0)
        self.assertEqual(done["step"], 15)
        self.assertAlmostEqual(done["time"], 2.0 + 10 * self.dt, 12)
        self.assertEqual(list(done["probe_steps"].values), [6, 9, 12])
        self.assertEqual(done["probes"].shape, (3, 2, 3))
        self.assertEqual(client.run(1, self.dt, first_step=15)["probes"].shape, (1, 2, 3))

    # ---- the tie

    def test_a_gap_tie_to_a_mass_of_the_client(self):
        client = self.prepared()
        self.tie_first(client)
        points = len(self.ready["mass"].values)
        client.ask("SET_FIELD", field="velocity", values=[[1.0, 0.5, 0.0]] * points)
        mass = self.ready["mass"].values[0]
        partner = 3.0 * mass
        state = {"v": [0.0] * 3, "u": [0.0] * 3}

        def answer(_, gap):
            inverse = 1.0 / mass + 1.0 / partner
            mu = [(gap[0][a] + state["v"][a] + state["u"][a] / self.dt) / inverse for a in range(3)]
            for a in range(3):
                state["v"][a] -= mu[a] / partner
                state["u"][a] += self.dt * state["v"][a]
            return [mu]

        done = client.run(1, self.dt, answer=answer)
        velocity = client.ask("FETCH", field="velocity")["values"].rows()
        for a, expected in enumerate((0.25, 0.125, 0.0)):  # a plastic shock of 1 and 3 masses
            self.assertAlmostEqual(velocity[0][a], expected, 12)
            self.assertAlmostEqual(state["v"][a], expected, 12)
        momentum = [p + partner * v for p, v in zip(done["momentum"].values, state["v"])]
        done = client.run(200, self.dt, first_step=1, answer=answer)
        after = [p + partner * v for p, v in zip(done["momentum"].values, state["v"])]
        scale = done["momentum"].values[6] + partner
        for a in range(3):
            self.assertLess(abs(after[a] - momentum[a]), 1e-12 * scale)
        displacement = client.ask("FETCH", field="displacement")["values"].rows()
        for a in range(3):
            self.assertAlmostEqual(displacement[0][a], state["u"][a], 11)
        self.assertGreater(done["largest_displacement"], 0.0)

    def test_a_slave_tie_follows_its_slots(self):
        client = self.prepared()
        client.ask("TIE", mode="slave", slots=2, tied=[0], row_ptr=[0, 2], columns=[0, 1], values=[0.25, 0.75])
        client.ask("SET_FIELD", field="velocity", values=[[0.5, 0, 0]] * len(self.ready["mass"].values))
        sent = []

        def answer(step, gap):
            sent.append(gap)
            return [[4.0, 0, 0], [0, 2.0, 0]]

        client.run(10, self.dt, answer=answer)
        u = client.ask("FETCH", field="displacement")["values"].rows()[0]
        self.assertAlmostEqual(u[0], 10 * self.dt, 12)
        self.assertAlmostEqual(u[1], 15 * self.dt, 12)
        impulse = self.ready["mass"].values[0] * 0.5  # first step, nothing deformed: m v*
        self.assertAlmostEqual(sent[0][0][0] / (0.25 * impulse), 1.0, 12)
        self.assertAlmostEqual(sent[0][1][0] / (0.75 * impulse), 1.0, 12)

    def test_the_stop_flag_ends_a_run(self):
        client = self.prepared()
        self.tie_first(client)
        done = client.run(1000, self.dt, first_step=3, answer=lambda step, _: ([[0, 0, 0]], step == 7))
        self.assertEqual(done["step"], 8)

    def test_wrong_multipliers_end_the_run_not_the_session(self):
        for rows, code in (([[0, 0, 0]] * 2, "value"), ([[math.nan, 0, 0]], "physics")):
            client = self.prepared()
            self.tie_first(client)
            error = self.refusal(client.run, 10, self.dt, answer=lambda *_: rows)
            self.assertEqual(error.code, code)
            self.assertEqual(self.refusal(client.run, 1, self.dt).code, "value")
            client.ask("PREPARE")
            client.ask("TIE", mode="none")
            client.run(1, self.dt)

    def test_an_error_from_the_client_ends_the_run(self):
        client = self.prepared()
        self.tie_first(client)
        client.send("RUN", steps=10, dt=self.dt)
        client.receive("GAP")
        client.send("ERROR", code="internal", message="the other engine is gone")
        client.ask("STABLE_STEP")

    def vibration(self, client, entity, axis):
        """Square of the circular frequency of a point that moves as one oscillator, from each three samples."""
        client.ask("PROBES", names=["u"], row_ptr=[0, 1], entities=[entity], coefficients=[1.0], every=1)
        done = client.run(400, self.dt)
        u = list(done["probes"].values)[axis::3]
        largest = max(abs(x) for x in u)
        # leapfrog: u(n+1) - 2 u(n) + u(n-1) = -(omega dt)^2 u(n), exactly
        squares = [(2 * b - a - c) / (b * self.dt**2) for a, b, c in zip(u, u[1:], u[2:]) if abs(b) > 0.5 * largest]
        self.assertGreater(len(squares), 100)
        crossings = [n + a / (a - b) for n, (a, b) in enumerate(zip(u, u[1:])) if a < 0 <= b]
        period = (crossings[-1] - crossings[0]) / (len(crossings) - 1) * self.dt
        return squares, period
