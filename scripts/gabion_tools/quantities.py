"""Numbers with units on the command line."""

import re

from gabion_tools.errors import UserError

PREFIXES = {"": 1.0, "k": 1e3, "M": 1e6, "G": 1e9}


def pressure(text, option="--young"):
    """Pa."""
    found = re.fullmatch(r"\s*([-+.\deE]+)\s*([kMG]?)Pa\s*", text)
    try:
        value = float(found[1]) * PREFIXES[found[2]]
    except (TypeError, ValueError):
        raise UserError(f"{option} '{text}': expected a pressure such as '500 MPa'") from None
    if not 0.0 < value < float("inf"):
        raise UserError(f"{option} '{text}': must be positive")
    return value


def number(text, option):
    try:
        value = float(text)
    except ValueError:
        raise UserError(f"{option} '{text}': expected a number") from None
    if value != value or abs(value) == float("inf"):
        raise UserError(f"{option} '{text}': expected a finite number")
    return value
