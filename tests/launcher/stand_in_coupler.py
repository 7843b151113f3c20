#!/usr/bin/python3
"""Takes the coupler's arguments, connects to the engines and leaves a made-up run folder behind."""

import argparse
import os
import socket
import sys
import time
from pathlib import Path

sys.path.insert(0, os.path.dirname(os.path.realpath(__file__)))

parser = argparse.ArgumentParser()
parser.add_argument("scene", type=Path)
parser.add_argument("--set", action="append", default=[])
parser.add_argument("--check", action="store_true")
parser.add_argument("--out", type=Path)
parser.add_argument("--dem")
parser.add_argument("--continuum")
parser.add_argument("--overwrite", action="store_true")
parser.add_argument("--resume")
options = parser.parse_args()
behaviour = os.environ.get("STAND_IN_COUPLER", "")

if options.check:
    if behaviour == "refuses":
        print(f"{options.scene}: mesh.size: expected a length", file=sys.stderr)
        sys.exit(2)
    print("the scene is sound")
    sys.exit(0)

with open(os.path.join(os.environ["STAND_IN_PIDS"], "coupler"), "w", encoding="ascii") as file:
    file.write(f"{os.getpid()}\n")
connections = []
for address in filter(None, (options.dem, options.continuum)):
    host, port = address.split(":")
    connections.append(socket.create_connection((host, int(port)), timeout=5))
if behaviour == "hangs":
    time.sleep(60)
if behaviour == "fails":
    print("step 12: the energy balance is off", file=sys.stderr)
    sys.exit(1)
model = next((text.split("=")[1] for text in reversed(options.set) if text.startswith("model=")), "bridging")
if behaviour == "full":
    import sample_run
    sample_run.write(options.out, model)
else:
    (options.out / "summary.json").write_text(f'{{"scene": "sample", "model": "{model}"}}', encoding="utf-8")
