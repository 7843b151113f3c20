"""The tests that compare with a closed form (tag [closed-form]), each as one figure."""

import subprocess
import xml.etree.ElementTree as xml

from gabion_tools.places import BUILD

TITLE = "unit and physics tests against closed forms"

TAG = "[closed-form]"
DEADLINE = 600  # s, one executable


def run(context):
    for program in sorted((BUILD / "bin").glob("test_*")):
        done = subprocess.run([str(program), TAG, "-r", "junit"], capture_output=True, text=True, timeout=DEADLINE,
                              check=False)
        if not done.stdout.startswith("<?xml"):
            yield context.figure(f"{program.name} ended with {done.returncode}", False, "", "= True")
            continue
        for case in xml.fromstring(done.stdout).iter("testcase"):
            passed = case.find("failure") is None and case.find("error") is None
            name = case.get("name").split("/")[0]
            yield context.figure(name, passed, "", "= True")
