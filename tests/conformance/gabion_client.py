"""A client of Gabion's engines, written from PROTOCOL.md and catalogue.json alone; Python's standard library only.

    client = Client("127.0.0.1", port)
    client.hello(token)
    client.ask("OPTIONS", gravity=[0, 0, -9.81], box_lo=[0, 0, 0], box_hi=[1, 1, 1], periodic=[0, 0, 0])
    ready = client.ask("PREPARE")          # a dict of the reply's fields
    client.run(steps=100, dt=1e-4, answer=lambda step, gap: multipliers)

Arrays are nested lists on the way in and Array objects (shape, flat values) on the way out.
"""

import array
import itertools
import json
import math
import pathlib
import socket
import struct
import sys
import time
import zlib

CATALOGUE = json.loads((pathlib.Path(__file__).resolve().parents[2] / "protocol" / "catalogue.json").read_text())
VERSION = CATALOGUE["version"]
MESSAGES = {m["name"]: m for m in CATALOGUE["messages"]}
NAMES = {m["id"]: m["name"] for m in CATALOGUE["messages"]}

HEADER = struct.Struct("<4sHHQQQI")
MAGIC = b"GABN"
SCALARS = {"u8": "<B", "u32": "<I", "u64": "<Q", "f64": "<d"}
ARRAYS = {"u8s": "B", "i32s": "i", "f64s": "d"}


class EngineError(Exception):
    """The engine answered with ERROR."""

    def __init__(self, fields):
        super().__init__(f'{fields["code"]}: {fields["message"]} [{fields["where"]}] {fields["advice"]}')
        self.code, self.message, self.where = fields["code"], fields["message"], fields["where"]
        self.advice, self.step = fields["advice"], fields["step"]


class ProtocolError(Exception):
    """The engine sent what PROTOCOL.md does not allow."""


class Array:
    def __init__(self, shape, values):
        self.shape, self.values = tuple(shape), values

    def rows(self):
        width = math.prod(self.shape[1:])
        return [list(self.values[i * width:(i + 1) * width]) for i in range(self.shape[0])]

    def __eq__(self, other):
        return self.shape == other.shape and list(self.values) == list(other.values)

    def __repr__(self):
        return f"Array({self.shape}, {list(self.values)})"


def little_endian(values):
    if sys.byteorder == "big":
        values.byteswap()
    return values


def extents(shape):
    """Extents of a shape such as [n,3] as the catalogue writes them; None where any number of them will do."""
    parts = shape.strip("[]").split(",")
    return None if "..." in parts and len(parts) > 1 else parts


def nested_shape(value):
    shape = []
    while isinstance(value, (list, tuple)):
        shape.append(len(value))
        value = value[0] if value else None
    return shape


def flatten(value):
    for item in value:
        if isinstance(item, (list, tuple)):
            yield from flatten(item)
        else:
            yield item


def encode_array(kind, shape, value):
    if not isinstance(value, Array):
        found = nested_shape(value)
        due = extents(shape)
        if due is not None and len(found) < len(due):  # an empty list: the extents after it are the fixed ones
            found = [0] + [int(e) if e.isdigit() else 0 for e in due[1:]]
        value = Array(found, list(flatten(value)))
    head = struct.pack("<B", len(value.shape)) + struct.pack(f"<{len(value.shape)}Q", *value.shape)
    return head + little_endian(array.array(ARRAYS[kind], value.values)).tobytes()


def encode_field(field, value):
    kind = field["type"]
    if kind in SCALARS:
        return struct.pack(SCALARS[kind], value)
    if kind == "str":
        text = value.encode()
        return struct.pack("<I", len(text)) + text
    if kind == "strs":
        return struct.pack("<I", len(value)) + b"".join(encode_field({"type": "str"}, text) for text in value)
    return encode_array(kind, field["shape"], value)


def default(field):
    kind = field["type"]
    if kind in SCALARS:
        return 0
    if kind == "str":
        return ""
    if kind == "strs":
        return []
    parts = extents(field["shape"])
    if parts and all(p.isdigit() for p in parts):
        shape = [int(p) for p in parts]
        return Array(shape, [0] * math.prod(shape))
    return []


def encode(name, fields):
    """The payload of a message; fields that are not given are zero or empty."""
    message = MESSAGES[name]
    unknown = set(fields) - {f["name"] for f in message["fields"]}
    if unknown:
        raise KeyError(f"{name} has no field {sorted(unknown)}")
    return b"".join(encode_field(f, fields.get(f["name"], default(f))) for f in message["fields"])


class Payload:
    def __init__(self, data):
        self.data, self.at = data, 0

    def take(self, count):
        if self.at + count > len(self.data):
            raise ProtocolError(f"payload ends {self.at + count - len(self.data)} bytes early")
        self.at += count
        return self.data[self.at - count:self.at]

    def unpack(self, form):
        return struct.unpack(form, self.take(struct.calcsize(form)))

    def field(self, field, symbols):
        kind = field["type"]
        if kind in SCALARS:
            return self.unpack(SCALARS[kind])[0]
        if kind == "str":
            return self.take(self.unpack("<I")[0]).decode()
        if kind == "strs":
            return [self.field({"type": "str"}, symbols) for _ in range(self.unpack("<I")[0])]
        dims = self.unpack("<B")[0]
        shape = self.unpack(f"<{dims}Q")
        check_shape(field, shape, symbols)
        values = array.array(ARRAYS[kind])
        values.frombytes(self.take(math.prod(shape) * values.itemsize))
        return Array(shape, little_endian(values))


def check_shape(field, shape, symbols):
    parts = extents(field["shape"])
    if parts is None or parts == ["..."]:
        return
    fits = len(parts) == len(shape)
    for part, extent in zip(parts, shape):
        if part.isdigit():
            fits = fits and extent == int(part)
        else:
            symbol, plus = part.split("+")[0], part.endswith("+1")
            size = max(extent - plus, 0)
            fits = fits and symbols.setdefault(symbol, size) == size
    if not fits:
        raise ProtocolError(f'{field["name"]} has shape {shape}, the catalogue says {field["shape"]}')


def decode(name, data):
    payload, symbols = Payload(data), {}
    fields = {f["name"]: payload.field(f, symbols) for f in MESSAGES[name]["fields"]}
    if payload.at != len(data):
        raise ProtocolError(f"{name}: {len(data) - payload.at} bytes too many")
    return fields


def frame(type_id, sequence, step, payload, version=VERSION):
    head = HEADER.pack(MAGIC, version, type_id, len(payload), sequence, step, 0)
    return HEADER.pack(MAGIC, version, type_id, len(payload), sequence, step, zlib.crc32(payload, zlib.crc32(head))) + payload


class Client:
    def __init__(self, host, port, timeout=10.0):
        self.socket = socket.create_connection((host, port), timeout)
        self.socket.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        self.timeout = timeout
        self.sent, self.received = 0, 0
        self.heartbeats = []  # (time, fields) of those that came while waiting

    def close(self):
        self.socket.close()

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.close()

    def send(self, name, /, frame_step=0, **fields):
        self.send_raw(MESSAGES[name]["id"], encode(name, fields), frame_step)

    def send_raw(self, type_id, payload, step=0, version=VERSION):
        self.send_bytes(frame(type_id, self.sent, step, payload, version))
        self.sent += 1

    def send_bytes(self, data):
        self.socket.sendall(data)

    def read(self, count, deadline):
        parts = bytearray()
        while len(parts) < count:
            left = deadline - time.monotonic()
            if left <= 0:
                raise TimeoutError("the engine did not answer in time")
            self.socket.settimeout(left)
            part = self.socket.recv(min(count - len(parts), 1 << 20))
            if not part:
                raise ConnectionError("the engine closed the connection")
            parts += part
        return bytes(parts)

    def receive_any(self):
        """(name, fields, step) of the next message, heartbeats and errors included."""
        deadline = time.monotonic() + self.timeout
        head = self.read(HEADER.size, deadline)
        magic, version, type_id, length, sequence, step, checksum = HEADER.unpack(head)
        if magic != MAGIC or version != VERSION:
            raise ProtocolError(f"magic {magic}, version {version}")
        payload = self.read(length, deadline)
        if zlib.crc32(payload, zlib.crc32(head[:-4] + b"\0\0\0\0")) != checksum:
            raise ProtocolError("wrong checksum")
        if sequence != self.received:
            raise ProtocolError(f"frame {sequence} came where {self.received} is due")
        self.received += 1
        return NAMES[type_id], decode(NAMES[type_id], payload), step

    def receive(self, expected):
        """(fields, step) of the expected message; EngineError when an ERROR comes."""
        while True:
            name, fields, step = self.receive_any()
            if name == "HEARTBEAT":
                self.heartbeats.append((time.monotonic(), fields))
            elif name == "ERROR":
                raise EngineError(fields)
            elif name != expected:
                raise ProtocolError(f"{name} came where {expected} is due")
            else:
                return fields, step

    def ask(self, name, /, **fields):
        """Sends a request and returns the fields of its reply."""
        self.send(name, **fields)
        return self.receive(MESSAGES[name]["reply"])[0]

    def beat(self, phase="", step=0):
        """One heartbeat between two requests; the engine counts on more from now on, about one a second."""
        self.send("HEARTBEAT", phase=phase, step=step, frame_step=step)

    def hello(self, token, version=VERSION):
        return self.ask("HELLO", protocol_version=version, token=token, role="coupler", software="reference client")

    def run(self, steps, dt, first_step=0, answer=None, **fields):
        """RUN; answer(step, gap rows) returns the rows of MULTIPLIERS, or (rows, stop)."""
        self.send("RUN", steps=steps, dt=dt, first_step=first_step, frame_step=first_step, **fields)
        for step in itertools.count(first_step) if answer else ():
            while True:
                name, reply, at = self.receive_any()
                if name == "HEARTBEAT":
                    self.heartbeats.append((time.monotonic(), reply))
                    continue
                break
            if name == "ERROR":
                raise EngineError(reply)
            if name == "RUN_DONE":
                return reply
            if name != "GAP" or at != step:
                raise ProtocolError(f"{name} of step {at} came where GAP of step {step} is due")
            rows = answer(step, reply["values"].rows())
            rows, stop = rows if isinstance(rows, tuple) else (rows, False)
            self.send("MULTIPLIERS", frame_step=step, stop=int(stop), values=rows)
        return self.receive("RUN_DONE")[0]
