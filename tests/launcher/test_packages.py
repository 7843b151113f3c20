"""What is installed, and when: with a dpkg-query and an apt-get that only pretend."""

import os
import unittest
from unittest import mock

from fixture import LauncherTest

from gabion_tools import packages
from gabion_tools.errors import Failure

QUERY = """#!/bin/sh
for package in {installed}; do printf '%s\\tinstalled\\t1.0\\n' "$package"; done
[ -e {done} ] && printf 'catch2\\tinstalled\\t2.13\\n'
exit 1
"""
APT_GET = """#!/bin/sh
echo "$@" >> {log}
[ "$1" = install ] && touch {done}
exit {code}
"""


class PackagesTest(LauncherTest):
    def pretend(self, code=0):
        """Everything but catch2 is installed; installing it works, unless code is not 0."""
        others = " ".join(name for name in packages.NEEDED if name != "catch2")
        done, self.log = self.folder / ("installed" if code == 0 else "never"), self.folder / "apt.log"
        for name, text in (("dpkg-query", QUERY), ("apt-get", APT_GET)):
            path = self.bin / name
            path.write_text(text.format(installed=others, done=done if name == "dpkg-query" or code == 0 else
                                        self.folder / "other", log=self.log, code=code), encoding="utf-8")
            path.chmod(0o755)
        (self.bin / "sudo").write_text('#!/bin/sh\nexec "$@"\n', encoding="utf-8")
        (self.bin / "sudo").chmod(0o755)
        return mock.patch.dict(os.environ, {"PATH": f"{self.bin}:{os.environ['PATH']}"})

    def test_what_is_missing_is_installed(self):
        with self.pretend(), mock.patch("builtins.print"):
            self.assertEqual(packages.missing(), ["catch2"])
            packages.ensure(yes=True)
            self.assertEqual(packages.missing(), [])
        update, install = self.log.read_text(encoding="utf-8").splitlines()
        self.assertEqual(update, "update -q")
        self.assertTrue(install.startswith("install") and install.endswith(" -y --no-install-recommends catch2"))

    def test_nothing_is_installed_against_a_no(self):
        with self.pretend(), mock.patch("builtins.print"), mock.patch("builtins.input", return_value="n"), \
                mock.patch("sys.stdin.isatty", return_value=True), self.assertRaisesRegex(Failure, "apt-get install catch2"):
            packages.ensure(yes=False)
        self.assertFalse(self.log.exists())

    def test_nobody_is_asked_without_a_terminal(self):
        with self.pretend(), mock.patch("builtins.print"), mock.patch("sys.stdin.isatty", return_value=False):
            packages.ensure(yes=False)
        self.assertTrue(self.log.exists())

    def test_a_failed_installation_says_what_to_try(self):
        with self.pretend(code=100), mock.patch("builtins.print"), self.assertRaisesRegex(Failure, "Try by hand: .*catch2"):
            packages.ensure(yes=True)


if __name__ == "__main__":
    unittest.main()
