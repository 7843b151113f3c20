"""The physics tests that compare with a closed form: one figure a test, met when the test passes.

The number and its tolerance stand in the test. A test that is renamed or removed is reported as not met.
"""

import re
import subprocess
import xml.etree.ElementTree as xml

TITLE = "physics tests against closed forms"

DEADLINE = 600  # s, one program

TESTS = {
    "test_continuum_server": [
        "an element has exactly six zero modes, whatever its shape and Poisson's ratio",
        "patch test: seven irregular hexahedra carry a uniform strain exactly",
        "a uniform strain gives C times strain, and no force inside, with a full 6 x 6 stiffness",
        "a rigid translation and an infinitesimal rotation give no stress and no force",
        "no volumetric locking: thick cylinder in plane strain",
        "no shear locking: cantilever under its own weight",
        "bar under a half-sine on the head: peaks at head and middle",
        "bar under a step load: twice the static head displacement, a plateau in the middle",
        "plane waves in a periodic column one element wide have the lumped mesh's dispersion exactly",
        "an absorbing end takes a plane P wave",
        "Lamb: surface motion after a point force on a half space",
        "a free cube at nu 0.45 stays bounded at 0.99 of the step and does not above it",
    ],
    "test_dem_server": [
        "moduli of the face-centred lattice",
        "moduli of the simple cubic lattice",
        "a P wave crosses a face-centred column at sqrt(C11/rho)",
        "oblique impact with infinite friction: ratio of tangential contact velocities",
        "gross sliding follows the impulse ratio",
        "a grain that slides on a floor rolls at 5/7 of its speed",
        "local damping gives the restitution sqrt((1 - a)/(1 + a))",
        "a sponge step takes sum of m beta (1 - beta/2) e^2",
    ],
    "test_packing": [
        "face-centred cubic lattice: closed form",
        "simple cubic lattice: closed form",
        "periodic packing: mean stress is the derivative of the stored energy (Hill)",
    ],
    "test_coupler": [
        "the multipliers close every gap and change no momentum",
        "gap rows are silent for affine fields",
        "slave rows reproduce affine fields",
    ],
}


def specification(names):
    """Catch2's way of naming tests: alternatives after commas, its own marks escaped."""
    return ",".join(re.sub(r"([,\[\]\\])", r"\\\1", name) for name in names)


def passed(report):
    """{test: passed} from Catch2's JUnit report, where sections stand behind a slash."""
    found = {}
    for case in xml.fromstring(report).iter("testcase"):
        good = case.find("failure") is None and case.find("error") is None
        name = case.get("name")
        for known in sum(TESTS.values(), []):
            if name == known or name.startswith(known + "/"):
                found[known] = found.get(known, True) and good
    return found


def run(context):
    for program, names in TESTS.items():
        done = subprocess.run([str(context.executable(program)), specification(names), "-r", "junit"],
                              capture_output=True, text=True, timeout=DEADLINE, check=False)
        found = passed(done.stdout) if done.stdout.startswith("<?xml") else {}
        for name in names:
            yield context.figure(name, found.get(name, "not run"), "", "= True")
