"""Drives the engines' executables as another client would; see PROTOCOL.md.

    GABION_BIN=build/bin python3 -m unittest test_conformance
"""

import math
import unittest

import models
from engine_process import TOKEN, EngineTest
from run_cases import RunCases
from session_cases import SessionCases


class DemServer(SessionCases, RunCases, EngineTest):
    engine_name, role = "dem_server", "dem"

    def set_up(self, client, measure=0):
        bonded = models.set_up_chain(client, 3, measure)
        self.assertEqual(bonded["bonds"], 2)

    def test_messages_of_the_other_engine_are_refused(self):
        client = self.greeted()
        self.assertEqual(self.refusal(client.ask, "MESH").code, "value")

    def test_two_bonded_grains_vibrate(self):
        client = self.greeted()
        self.assertEqual(models.set_up_chain(client, 2), {"bonds": 1, "contacts_per_grain": 1.0})
        self.ready = client.ask("PREPARE")
        for mass in self.ready["mass"].values:
            self.assertAlmostEqual(mass / models.GRAIN_MASS, 1.0, 12)
        # springs in three directions between two masses: omega^2 = 2 k/m, and the stable step is 2/omega
        omega = math.sqrt(2 * models.BOND_STIFFNESS / models.GRAIN_MASS)
        self.assertLessEqual(self.ready["stable_step"], 2.0 / omega * (1 + 1e-9))
        self.dt = 0.05 * 2.0 / omega
        client.ask("SET_FIELD", field="velocity", values=[[1e-3, 0, 0], [-1e-3, 0, 0]])
        squares, period = self.vibration(client, 1, 0)
        for square in squares:
            self.assertAlmostEqual(square / omega**2, 1.0, 8)
        half = math.asin(omega * self.dt / 2)
        self.assertAlmostEqual(period / (math.pi * self.dt / half), 1.0, 4)

    def test_two_clumps_vibrate_as_bodies(self):
        client = self.greeted()
        models.set_up_chain(client, 4)
        client.ask("CONTACT_OPTIONS", geometry="updated", rotations=1, skin=0.0)
        self.assertEqual(client.ask("CLUMPS", clump_size=[2], gap=1e-6),
                         {"clumps": 2, "grains": 4, "aspect_ratio": 2.0})
        self.assertEqual(client.ask("BONDS", gap=1e-6)["bonds"], 1)
        self.ready = client.ask("PREPARE")
        self.assertEqual(list(client.ask("FETCH", field="clump")["values"].values), [0, 0, 1, 1])
        # one spring between two bodies of twice the mass: omega^2 = k/m; their members move alike
        omega = math.sqrt(models.BOND_STIFFNESS / models.GRAIN_MASS)
        dt = 0.01 * 2.0 / omega
        client.ask("SET_FIELD", field="velocity", values=[[1e-3, 0, 0]] * 2 + [[-1e-3, 0, 0]] * 2)
        steps = 100
        client.run(steps, dt)
        u = [row[0] for row in client.ask("FETCH", field="displacement")["values"].rows()]
        self.assertEqual((u[0], u[2]), (u[1], u[3]))
        self.assertAlmostEqual(u[0] / (1e-3 / omega * math.sin(omega * steps * dt)), 1.0, 2)
        error = self.refusal(client.ask, "CLUMPS", clump_size=[0], gap=1e-6)
        self.assertEqual((error.code, error.where), ("value", "CLUMPS clump_size"))
        client.ask("CLUMPS", clump_size=[2], gap=1e-6, single=[0, 1])
        client.ask("PREPARE")
        self.assertEqual(list(client.ask("FETCH", field="clump")["values"].values), [-1, -1, 0, 0])

    def test_the_face_that_a_chain_is_held_at(self):
        """Grains held half a metre inside the face: a rod would have to be held there."""
        count, inside = 14, 0.5
        client = self.greeted()
        models.set_up_chain(client, count)
        client.ask("OPTIONS", **{**models.options(), "periodic": [0, 1, 1]})
        client.ask("PREPARE")
        window = {"box_lo": [2.5, -10, -10], "box_hi": [count - 2.5, 10, 10]}
        for face, place, grain in ((0, -inside, 0), (1, count - 1 + inside, count - 1)):
            measured = client.ask("MEASURE_FACE", face=face, place=place, entities=[grain], components=1, **window)
            self.assertAlmostEqual(measured["offset"], inside, 8)
        self.assertIn("normal", str(self.refusal(client.ask, "MEASURE_FACE", face=0, place=0.0, entities=[0],
                                                 components=6, **window)))
        self.assertIn("face 6", str(self.refusal(client.ask, "MEASURE_FACE", face=6, entities=[0], components=1,
                                                 **window)))

    def test_a_triaxial_test_of_a_lattice(self):
        self.launch()
        client = self.connect()
        if "triaxial" not in client.hello(TOKEN)["capabilities"]:
            self.skipTest("the engine does no triaxial tests")
        models.set_up_lattice(client)
        self.refusal(client.ask, "TRIAXIAL_SHEAR", axial_strain=0.1, record_every=0.1, inertial_number=1e-3, damping=0.2)
        pressure = 1e-6 * models.STIFFNESS
        confined = client.ask("TRIAXIAL_CONFINE", pressure=pressure, axis=2, damping=0.7, unbalanced=1e-3,
                              max_steps=100000, step_fraction=0.7)
        # a simple cubic lattice: C11 = k_n/(2 R), C12 = 0, k_n of two equal grains in series
        modulus = models.BOND_STIFFNESS / (2 * models.RADIUS)
        for side in confined["box"].values:
            self.assertAlmostEqual((1.0 - side / models.LATTICE_SIDE) * modulus / pressure, 1.0, 2)
        curve = client.ask("TRIAXIAL_SHEAR", axial_strain=2e-6, record_every=1e-6, inertial_number=1e-3, damping=0.2)
        strain, stress = (list(curve[name].values) for name in ("axial_strain", "axial_stress"))
        self.assertEqual(len(strain), 2)
        self.assertAlmostEqual((stress[1] - stress[0]) / (strain[1] - strain[0]) / modulus, 1.0, 2)
        self.assertEqual(self.refusal(client.ask, "CHECKPOINT").code, "value")


class ContinuumServer(SessionCases, RunCases, EngineTest):
    engine_name, role = "continuum_server", "continuum"

    def set_up(self, client, measure=0):
        models.set_up_brick(client, measure)

    def test_messages_of_the_other_engine_are_refused(self):
        client = self.greeted()
        self.assertEqual(self.refusal(client.ask, "BONDS", gap=0.1).code, "value")

    def test_a_brick_vibrates_along_its_length(self):
        client = self.greeted()
        self.set_up(client)
        models.fix(client, "end", models.face(0, 0), 7)
        models.fix(client, "sides", models.face(0, 1), 6)
        self.ready = client.ask("PREPARE")
        self.assertAlmostEqual(sum(self.ready["mass"].values) / models.BRICK_MASS, 1.0, 12)
        # uniform strain: force = modulus area/length, mass = half the brick
        omega = math.sqrt(2 * models.P_MODULUS / models.DENSITY) / models.SIDE[0]
        self.dt = 0.05 * self.ready["stable_step"]
        client.ask("SET_FIELD", field="velocity",
                   values=[[1e-3 * corner[0], 0, 0] for corner in models.CORNERS])
        squares, period = self.vibration(client, 1, 0)
        for square in squares:
            self.assertAlmostEqual(square / omega**2, 1.0, 8)
        half = math.asin(omega * self.dt / 2)
        self.assertAlmostEqual(period / (math.pi * self.dt / half), 1.0, 3)

    def test_a_stretched_brick(self):
        client = self.greeted()
        self.set_up(client)
        for axis, name in enumerate("xyz"):
            models.fix(client, name, models.face(axis, 0), 1 << axis)
        force = 1000.0  # N
        client.ask("LOADS", name="pull", entities=models.face(0, 1), vectors=[[force / 4, 0, 0]] * 4,
                   history_kind="constant", history=[1.0])
        ready = client.ask("PREPARE")
        done = client.run(4000, 0.6 * ready["stable_step"], damping=0.7)
        self.assertLess(done["unbalanced"], 1e-9)
        length, width, height = models.SIDE
        strain = force / (width * height) / models.YOUNG
        u = client.ask("FETCH", field="displacement")["values"].rows()
        for corner, moved in zip(models.CORNERS, u):
            for axis, expected in enumerate((strain * length, -models.POISSON * strain * width,
                                             -models.POISSON * strain * height)):
                self.assertAlmostEqual(moved[axis] / (strain * length), corner[axis] * expected / (strain * length), 8)
        reactions = dict(zip(done["reaction_names"], done["reactions"].rows()))
        self.assertAlmostEqual(reactions["x"][0] / force, -1.0, 8)
        self.assertAlmostEqual(reactions["y"][1] / force, 0.0, 8)

    def test_rates(self):
        self.launch()
        client = self.connect()
        if "rates" not in client.hello(TOKEN)["capabilities"]:
            self.skipTest("the engine knows one rate only")
        self.set_up(client, measure=1)
        self.assertEqual(self.refusal(client.ask, "RATES", rate=[4]).code, "state")
        ready = client.ask("PREPARE")
        dt = 2.0 ** math.floor(math.log2(0.2 * ready["stable_step"]))
        velocity = [[1e-3 * math.sin(3 * i + axis) for axis in range(3)] for i in range(8)]
        client.ask("SET_FIELD", field="velocity", values=velocity)
        start = client.ask("CHECKPOINT")["blob"]
        one = client.run(10, 4 * dt, measure=1)
        client.ask("RESTORE", blob=start)
        client.ask("RATES", rate=[4])
        self.assertAlmostEqual(client.ask("STABLE_STEP")["stable_step"] / ready["stable_step"], 0.25, 3)
        four = client.run(40, dt, measure=4)  # a brick that is evaluated in every fourth step: the steps are four times as long
        self.assertEqual(four["state_hash"], one["state_hash"])
        summed = lambda done: [e for e, kind in zip(done["ledger"].values, done["ledger_kinds"].values) if kind != 3]  # noqa: E731
        self.assertEqual(summed(four), summed(one))
        for fields in (dict(steps=6), dict(steps=8, first_step=2), dict(steps=8, damping=0.1), dict(steps=8, measure=1)):
            error = self.refusal(client.ask, "RUN", **{"dt": dt, **fields})
            self.assertEqual((error.code, error.where), ("value", f"RUN.{list(fields)[-1]}"))
        for rates in ([3], [1, 1], [0]):
            error = self.refusal(client.ask, "RATES", rate=rates)
            self.assertEqual((error.code, error.where), ("value", "RATES.rate"))
        client.ask("RATES", rate=[])
        client.run(1, dt, first_step=3)


if __name__ == "__main__":
    unittest.main()
