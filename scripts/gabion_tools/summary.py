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


def rows(summary):
    """(name, text) pairs in a fixed order; what the order does not name comes last."""
    def flat(prefix, value):
        if isinstance(value, dict):
            for key, inner in value.items():
                yield from flat(f"{prefix} {key}", inner)
        elif isinstance(value, list) and all(not isinstance(inner, (dict, list)) for inner in value):
            yield prefix, ", ".join(number(inner) for inner in value) or "-"
        elif isinstance(value, list):
            for k, inner in enumerate(value):
                name = inner.get("name", str(k)) if isinstance(inner, dict) else str(k)
                rest = {key: v for key, v in inner.items() if key != "name"} if isinstance(inner, dict) else inner
                yield f"{prefix} {name}", (", ".join(f"{key} {number(v)}" for key, v in rest.items())
                                           if isinstance(rest, dict) else str(rest))
        else:
            yield prefix, number(value)

    for key in sorted(summary, key=lambda key: (ORDER.index(key) if key in ORDER else len(ORDER), key)):
        if key == "warnings":
            for warning in summary[key]:
                yield "warning", warning if isinstance(warning, str) else json.dumps(warning)
        else:
            yield from flat(key.replace("_", " "), summary[key])


def table(folder):
    pairs = [(name.replace("_", " "), text) for name, text in rows(load(folder))]
    width = max((len(name) for name, _ in pairs), default=0)
    return "\n".join(f"  {name:{width}}  {text}" for name, text in pairs)
