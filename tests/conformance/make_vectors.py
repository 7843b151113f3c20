#!/usr/bin/env python3
"""Writes one example of every message, with the payload that the reference client makes of it.

    make_vectors.py FILE           writes the examples as JSON
    make_vectors.py --check FILE   exit status 1 when FILE is out of date

The C++ tests decode the payloads, compare the fields, and encode them again.
"""

import json
import math
import pathlib
import sys

import gabion_client as client

SIZES = {"n": 3, "m": 2, "k": 4, "p": 2, "r": 2, "f": 2, "v": 4, "nnz": 5, "b": 6, "s": 2, "g": 1, "c": 2}
NUMBERS = {"u8": 200, "u32": 4000000000, "u64": 2**63 + 5, "f64": -1.0 / 3.0}


def value(kind, index):
    return {"u8s": (index * 7) % 256, "i32s": (-1)**index * index * 1000003, "f64s": math.sqrt(index) * 1e-3}[kind]


def example(field):
    kind = field["type"]
    if kind in NUMBERS:
        return NUMBERS[kind]
    if kind == "str":
        return f'{field["name"]} \u00b5'
    if kind == "strs":
        return [field["name"], "", "two words"]
    parts = client.extents(field["shape"]) or ["n", "2"]
    shape = [int(p) if p.isdigit() else 3 if p == "..." else SIZES[p.split("+")[0]] + p.endswith("+1") for p in parts]
    return client.Array(shape, [value(kind, i) for i in range(math.prod(shape))])


def plain(value):
    return {"shape": list(value.shape), "values": list(value.values)} if isinstance(value, client.Array) else value


def text():
    examples = []
    for message in client.CATALOGUE["messages"]:
        fields = {f["name"]: example(f) for f in message["fields"]}
        payload = client.encode(message["name"], fields)
        assert client.decode(message["name"], payload) == fields
        frame = client.frame(message["id"], message["id"] + 1, 1000 + message["id"], payload)
        examples.append({"message": message["name"], "fields": {k: plain(v) for k, v in fields.items()},
                         "frame": frame.hex()})
    return "[\n" + ",\n".join(json.dumps(e) for e in examples) + "\n]\n"


def main():
    file = pathlib.Path(sys.argv[-1])
    if "--check" in sys.argv:
        if file.read_text() != text():
            print(f"{file} is out of date: run make_vectors.py {file}", file=sys.stderr)
            return 1
        return 0
    file.write_text(text())
    return 0


if __name__ == "__main__":
    sys.exit(main())
