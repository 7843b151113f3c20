"""Goals of figures, and whether a value meets one."""

import math
import re

NUMBER = r"([-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?)"


def meets(value, goal):
    """Goals: '< 0.01', '<= 3', '> 0.9', '= 6', '500 +- 10', '0.9 .. 1.1', 'report' (nothing to reach)."""
    if goal == "report":
        return True
    if isinstance(value, (str, bool)):
        return str(value) == goal.removeprefix("= ")
    if value is None or not math.isfinite(value):
        return False
    for pattern, holds in (
        (rf"< {NUMBER}", lambda a: value < a), (rf"<= {NUMBER}", lambda a: value <= a),
        (rf"> {NUMBER}", lambda a: value > a), (rf">= {NUMBER}", lambda a: value >= a),
        (rf"= {NUMBER}", lambda a: value == a), (rf"{NUMBER} \+- {NUMBER}", lambda a, b: abs(value - a) <= b),
        (rf"{NUMBER} \.\. {NUMBER}", lambda a, b: a <= value <= b),
    ):
        found = re.fullmatch(pattern, goal)
        if found:
            return bool(holds(*map(float, found.groups())))
    raise ValueError(f"goal '{goal}' is none of: {meets.__doc__}")
