"""Two kinds of trouble: the user's mistake (exit code 2) and everything else that can fail (exit code 1)."""

import difflib


class UserError(Exception):
    """What was asked cannot be done as asked; the message says what to do instead."""


class Failure(Exception):
    """Something that should have worked did not; the message says where to look."""


def advice(word, known):
    """What to write in place of an unknown word."""
    near = difflib.get_close_matches(word, known, 1)
    return f"did you mean {near[0]}?" if near else "known: " + (", ".join(known) or "none")
