"""Materials as the launcher reads and writes them."""

import json
import re
from pathlib import Path

from gabion_tools import scenes
from gabion_tools.errors import UserError, advice
from gabion_tools.places import SCENARIOS, short

MATERIALS = SCENARIOS / "materials"


def known():
    return sorted(path.stem for path in MATERIALS.glob("*.json"))


def path_of(name):
    """File of a material given as a file or a built-in name, or None."""
    given = Path(name)
    for candidate in (given, MATERIALS / f"{name}.json"):
        if candidate.is_file():
            return candidate
    return None


def load(name):
    """(name, values). Raises UserError with the nearest name."""
    path = path_of(name)
    if path is None:
        if (SCENARIOS / f"{name}.json").is_file():
            raise UserError(f"'{name}' is a scene; give --young and --poisson with it, or name a material: " + ", ".join(known()))
        raise UserError(f"no material '{name}': neither a file nor a built-in one; {advice(Path(name).stem, known())}")
    try:
        values = json.loads(scenes.without_comments(path.read_text(encoding="utf-8")))
    except (OSError, ValueError) as error:
        raise UserError(f"{short(path)}: not a material file: {error}") from None
    if not isinstance(values, dict) or "normal_stiffness" not in values:
        what = "a scene" if isinstance(values, dict) and "gabion" in values else "no material"
        raise UserError(f"{short(path)} is {what}; a material has normal_stiffness, shear_stiffness and more. "
                        "With a scene, give --young and --poisson")
    return path.stem, values


def quantity(material, key):
    """(number, unit) of a parameter. Raises UserError where it cannot be varied."""
    value = material.get(key)
    found = re.fullmatch(r"\s*([-+.\deE]+)\s*(.*?)\s*", str(value))
    try:
        return float(found[1]), found[2]
    except (TypeError, ValueError):
        raise UserError(f"--vary {key}: the material's value is {value!r}, which is no number to vary") from None


def changed(material, key, number):
    """A copy with one parameter, which keeps its unit. stiffness_ratio is shear over normal stiffness, bond_strength a
    factor on both strengths."""
    values = dict(material)
    if key == "stiffness_ratio":
        normal, unit = quantity(material, "normal_stiffness")
        values["shear_stiffness"] = f"{number * normal:.6g} {unit}"
    elif key == "bond_strength":
        for name in ("normal_strength", "shear_strength"):
            base, unit = quantity(material, name)
            values[name] = f"{number * base:.6g} {unit}".strip()
    else:
        unit = quantity(material, key)[1] if key in material else ""
        values[key] = f"{number:.6g} {unit}" if unit else float(f"{number:.6g}")
    return values


def write(path, material, provenance):
    """A material file; provenance: lines of its opening comment."""
    body = json.dumps(material, indent=2)
    path.write_text("".join(f"// {line}\n" for line in provenance) + body + "\n", encoding="utf-8")
