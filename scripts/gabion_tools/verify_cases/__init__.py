"""One module a case; see HOW_TO_ADD in ../verify.py."""
