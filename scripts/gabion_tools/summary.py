"""summary.json as a table."""

import json

ORDER = ("scene", "title", "model", "state_hash", "sizes", "step", "wall", "bytes_per_step", "energy", "stages",
         "figures", "warnings")


def load(folder):
    return json.loads((folder / "summary.json").read_text(encoding="utf-8"))


def number(value):
    """Short and readable; integers in full."""
    if isinstance(value, bool) or value is None:
        return {True: "yes", False: "no", None: "-"}[value]
    if isinstance(value, float):
        return f"{value:.6g}"
    return str(value)


def plain(value):
    """A value on one line: numbers short, lists in brackets, tables as 'name value' pairs."""
    if isinstance(value, dict):
        return ", ".join(f"{key.replace('_', ' ')} {plain(inner)}" for key, inner in value.items()) or "-"
    if isinstance(value, list):
        return "[" + ", ".join(plain(inner) for inner in value) + "]"
    return number(value)


def in_order(summary):
    return sorted(summary, key=lambda key: (ORDER.index(key) if key in ORDER else len(ORDER), key))


def rows(summary):
    """(name, text) pairs in a fixed order, one a leaf; what the order does not name comes last."""
    def flat(prefix, value):
        if isinstance(value, dict):
            for key, inner in value.items():
                yield from flat(f"{prefix} {key.replace('_', ' ')}", inner)
        elif isinstance(value, list) and value and all(isinstance(inner, dict) for inner in value):
            for k, inner in enumerate(value):
                rest = {key: v for key, v in inner.items() if key != "name"}
                yield f"{prefix} {inner.get('name', k)}", plain(rest)
        else:
            yield prefix, plain(value)

    for key in in_order(summary):
        if key == "warnings":
            for warning in summary[key]:
                yield "warning", plain(warning)
        else:
            yield from flat(key.replace("_", " "), summary[key])


def table(folder):
    """For the terminal: one line a group; matrices and long lists are left to the report."""
    content, lines = load(folder), []
    for key in in_order(content):
        value, name = content[key], key.replace("_", " ")
        if isinstance(value, dict):
            value = {k: v for k, v in value.items() if not (isinstance(v, list) and len(v) > 3)}
        if isinstance(value, list):
            lines += [(name.rstrip("s"), plain(one)) for one in value]
        elif isinstance(value, dict) and any(isinstance(inner, dict) for inner in value.values()):
            lines += [(name, f"{k} {plain(v)}") for k, v in value.items()]
        elif value not in ({}, None):
            lines.append((name, plain(value)))
    width = max((len(name) for name, _ in lines), default=0)
    return "\n".join(f"  {name:{width}}  {text}" for name, text in lines)
