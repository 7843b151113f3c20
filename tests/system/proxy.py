"""Stands between the coupler and an engine, and does to one chosen frame what a broken peer would do.

A fault is (direction, name, step or None, action): direction 'from' or 'to' the engine; action:
  kill      both connections are closed in place of the frame
  freeze    nothing is passed on any more
  garbage   bytes that are no frame, in its place
  flip      one bit of the payload (of the header where there is none) is wrong
  nan       the first number of the payload's array is not a number; the checksum is right
"""

import socket
import struct
import threading
import zlib

import programs  # noqa: F401, puts the reference client on the path
from gabion_client import HEADER, NAMES

GARBAGE = bytes(range(165, 229))


def read_exactly(source, count):
    parts = bytearray()
    while len(parts) < count:
        part = source.recv(count - len(parts))
        if not part:
            raise ConnectionError
        parts += part
    return bytes(parts)


def with_nan(head, payload, entry):
    """The frame with a number of its first array replaced."""
    magic, version, kind, length, sequence, step, _ = HEADER.unpack(head)
    changed = bytearray(payload)
    begin = 1 + 8 * changed[0]  # extents, then the numbers
    struct.pack_into("<d", changed, begin + 8 * entry, float("nan"))
    head = HEADER.pack(magic, version, kind, length, sequence, step, 0)
    checksum = zlib.crc32(bytes(changed), zlib.crc32(head))
    return HEADER.pack(magic, version, kind, length, sequence, step, checksum) + bytes(changed)


class Proxy:
    def __init__(self, engine, fault, entry=0):
        self.engine, self.fault, self.entry = engine, fault, entry
        self.done = self.frozen = False
        self.passed_after = []  # names of the frames to the engine once the fault was there
        self.sockets = []
        self.listener = socket.create_server(("127.0.0.1", 0))
        self.listener.settimeout(30)
        self.address = "127.0.0.1:%d" % self.listener.getsockname()[1]
        threading.Thread(target=self.serve, daemon=True).start()

    def serve(self):
        try:
            coupler = self.listener.accept()[0]
            host, port = self.engine.rsplit(":", 1)
            engine = socket.create_connection((host, int(port)), 10)
        except OSError:
            return
        for end in (coupler, engine):
            end.settimeout(None)
            end.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        self.sockets = [coupler, engine]
        for direction, source, target in (("to", coupler, engine), ("from", engine, coupler)):
            threading.Thread(target=self.pass_on, args=(direction, source, target), daemon=True).start()

    def pass_on(self, direction, source, target):
        try:
            while True:
                head = read_exactly(source, HEADER.size)
                kind, length, step = (HEADER.unpack(head)[k] for k in (2, 3, 5))
                payload = read_exactly(source, length)
                if self.frozen:
                    continue
                frame = head + payload
                if self.done and direction == "to":
                    self.passed_after.append(NAMES[kind])
                if not self.done and self.is_chosen(direction, NAMES[kind], step):
                    self.done = True
                    frame = self.spoilt(head, payload)
                if frame:
                    target.sendall(frame)
        except OSError:
            if not self.frozen:
                self.close()

    def is_chosen(self, direction, name, step):
        return self.fault[:2] == (direction, name) and self.fault[2] in (None, step)

    def spoilt(self, head, payload):
        action = self.fault[3]
        if action == "kill":
            self.close()
        elif action == "freeze":
            self.frozen = True
        elif action == "garbage":
            return GARBAGE
        elif action == "flip":
            frame = bytearray(head + payload)
            frame[-1] ^= 4
            return bytes(frame)
        else:
            return with_nan(head, payload, self.entry)
        return b""

    def close(self):
        self.listener.close()
        for end in self.sockets:
            try:
                end.shutdown(socket.SHUT_RDWR)
            except OSError:
                pass
            end.close()
