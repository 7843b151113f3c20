"""Two kinds of trouble: the user's mistake (exit code 2) and everything else that can fail (exit code 1)."""


class UserError(Exception):
    """What was asked cannot be done as asked; the message says what to do instead."""


class Failure(Exception):
    """Something that should have worked did not; the message says where to look."""
