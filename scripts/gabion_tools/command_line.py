"""The command line: which words there are and which module carries each out."""

import argparse
import importlib
import signal
import sys

from gabion_tools.errors import UserError, Failure

COMMANDS = {
    "run": "run a scene, then plots and a report",
    "resume": "go on with a run that was broken off",
    "check": "read a scene, say what it would do or what is wrong with it",
    "test": "build everything and run every test",
    "verify": "compare with closed forms and references, figure by figure",
    "bench": "speed against error of every scene, on one page",
    "plot": "draw the plots of a run folder again",
    "report": "write the report of a run folder again",
    "calibrate": "test a material on periodic samples, or find parameters that give wanted figures",
    "pack": "make the packing of a scene and show it",
    "zone": "say which zone of grains, overlap and mesh a scene needs",
    "doctor": "say what is installed, built and missing",
}


def parser():
    top = argparse.ArgumentParser(prog="gabion", description="Discrete elements and continuum, coupled.",
                                  epilog="Exit codes: 0 done, 1 something failed, 2 a mistake in what was asked.")
    commands = top.add_subparsers(dest="command", metavar="COMMAND", required=True)
    for name, text in COMMANDS.items():
        one = commands.add_parser(name, help=text, description=text[0].upper() + text[1:] + ".")
        importlib.import_module("gabion_tools." + name).arguments(one)
    return top


def stop_on_terminate(*_):
    # As an exception, so that every process that was started is stopped on the way out.
    raise KeyboardInterrupt


def main(words):
    options = parser().parse_args(words)
    signal.signal(signal.SIGTERM, stop_on_terminate)
    try:
        return importlib.import_module("gabion_tools." + options.command).main(options)
    except UserError as error:
        print("gabion:", error, file=sys.stderr)
        return 2
    except Failure as error:
        print("gabion:", error, file=sys.stderr)
        return 1
    except KeyboardInterrupt:
        print("\ngabion: stopped", file=sys.stderr)
        return 130
    except BrokenPipeError:
        return 1
