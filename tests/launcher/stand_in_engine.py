#!/usr/bin/python3
"""Listens like an engine and does nothing else. How it misbehaves is said in STAND_IN_<NAME>."""

import os
import socket
import sys
import time

name = os.path.basename(sys.argv[0])
behaviour = os.environ.get("STAND_IN_" + name.removesuffix("_server").upper(), "")
with open(os.path.join(os.environ["STAND_IN_PIDS"], name), "w", encoding="ascii") as file:
    file.write(f"{os.getpid()}\n")
assert sys.argv[1:3] == ["--listen", "127.0.0.1:0"] and sys.argv[3] == "--threads", sys.argv
assert len(os.environ["GABION_TOKEN"]) == 32

if behaviour == "dies":
    print("no memory for that", file=sys.stderr)
    sys.exit(3)
if behaviour == "silent":
    time.sleep(60)
if behaviour == "babbles":
    print("hello world", flush=True)
    time.sleep(60)
server = socket.create_server(("127.0.0.1", 0))
print("LISTENING 127.0.0.1", server.getsockname()[1], flush=True)
if behaviour == "dies later":
    time.sleep(0.3)
    print("grain 7 is lost", file=sys.stderr, flush=True)
    os._exit(1)
server.settimeout(60)
client, _ = server.accept()
client.recv(1)  # until the coupler is done
