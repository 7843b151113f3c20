"""Debian packages that Gabion needs, and their installation."""

import os
import shutil
import subprocess
import sys

from gabion_tools.errors import Failure

NEEDED = {
    "g++": "compiler",
    "cmake": "build",
    "ninja-build": "build",
    "libboost-dev": "sockets (Asio)",
    "libeigen3-dev": "linear algebra",
    "nlohmann-json3-dev": "scenes, summaries",
    "libcli11-dev": "command lines",
    "libvalijson-dev": "schema of the scenes",
    "libhdf5-dev": "results",
    "zlib1g-dev": "checksums",
    "catch2": "tests",
    "python3": "launcher, code generation",
    "python3-numpy": "plots, reports",
    "python3-h5py": "plots, reports",
    "python3-matplotlib": "plots",
}


def versions(names=NEEDED):
    """{package: version, or None where it is not installed}."""
    found = dict.fromkeys(names)
    try:
        listed = subprocess.run(["dpkg-query", "-W", "-f", "${Package}\t${db:Status-Status}\t${Version}\n", *names],
                                capture_output=True, text=True, check=False).stdout
    except FileNotFoundError:
        raise Failure("dpkg-query not found: the set-up knows Debian only. Install these by other means, build with "
                      "cmake, and name the folder of executables in GABION_BIN: " + ", ".join(names)) from None
    for line in listed.splitlines():
        name, status, version = line.split("\t")
        if status == "installed" and name in found:
            found[name] = version
    return found


def missing():
    return [name for name, version in versions().items() if version is None]


def ensure(yes):
    """Installs what is missing, after asking unless told yes or nobody can answer."""
    absent = missing()
    if not absent:
        return
    print("Not installed:")
    for name in absent:
        print(f"  {name:20} {NEEDED[name]}")
    as_root = [] if os.geteuid() == 0 else ["sudo"]
    command = " ".join([*as_root, "apt-get install", *absent])
    if as_root and not shutil.which("sudo"):
        raise Failure(f"only root can install packages, and there is no sudo here. As root: {command}")
    if not yes and sys.stdin.isatty():
        if input("Install them with apt-get? [Y/n] ").strip().lower() not in ("", "y", "yes"):
            raise Failure(f"nothing was installed. To do it yourself: {command}")
    environment = {**os.environ, "DEBIAN_FRONTEND": "noninteractive"}
    for step in (["apt-get", "update", "-q"],
                 ["apt-get", "install", "-q", "-y", "--no-install-recommends", *absent]):
        if subprocess.run([*as_root, *step], env=environment, check=False).returncode != 0 and step[1] == "install":
            raise Failure(f"apt-get failed. Try by hand: {command}")
    still = missing()
    if still:
        raise Failure("still not installed: " + ", ".join(still))
