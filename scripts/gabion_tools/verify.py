"""gabion verify: every claim as a figure with its goal. Cases are the modules of verify_cases/."""

import importlib
import json
import os
import pkgutil
import sys
import traceback

from gabion_tools import build, packages, scenes
from gabion_tools.errors import Failure, UserError, advice
from gabion_tools.places import PYTHON

HOW_TO_ADD = """A case is a module of scripts/gabion_tools/verify_cases with
  TITLE         one line for --list
  FULL = True   only when it takes so long that it runs with --full alone
  run(context)  yields context.figure("name", value, "unit", "goal") for every figure"""


def arguments(parser):
    parser.add_argument("cases", nargs="*", metavar="CASE", help="cases to run (default: all of the short ones)")
    parser.add_argument("--list", action="store_true", help="name the cases and stop")
    parser.add_argument("--json", action="store_true", help="one JSON object a figure on standard output")
    parser.add_argument("--full", action="store_true", help="the long cases too, and at full size")
    parser.add_argument("--set", action="append", default=[], metavar="KEY=VALUE", dest="overrides",
                        help="change a value of every scene; may be repeated")
    parser.add_argument("--seed", type=int, help="seed of the packings")
    parser.add_argument("--yes", action="store_true", help="install missing packages without asking")


def registry():
    """{name: module}, in alphabetical order. Names have hyphens where files have underscores."""
    from gabion_tools import verify_cases
    found = {}
    for module in sorted(pkgutil.iter_modules(verify_cases.__path__), key=lambda m: m.name):
        found[module.name.replace("_", "-")] = importlib.import_module(f"gabion_tools.verify_cases.{module.name}")
    return found


def choose(cases, options):
    if not options.cases:
        return [name for name, module in cases.items() if options.full or not getattr(module, "FULL", False)]
    for name in options.cases:
        if name not in cases:
            raise UserError(f"no case '{name}'; {advice(name, cases)}")
    return options.cases


def main(options):
    cases = registry()
    if options.list:
        for name, module in cases.items():
            print(f"{name:24} {module.TITLE}" + (" (with --full)" if getattr(module, "FULL", False) else ""))
        return 0
    chosen = choose(cases, options)
    scenes.override_arguments(options.overrides)
    packages.ensure(options.yes)
    if os.path.realpath(sys.executable) != os.path.realpath(PYTHON):
        raise Failure(f"verify needs numpy and h5py of {PYTHON}; start scripts/gabion with it")
    build.ensure(options.yes, everything=True)
    from gabion_tools.verify_context import Context
    context = Context(options.full, options.seed, options.overrides)
    unmet = 0
    if not options.json:
        print(f"{'case':20} {'figure':80} {'value':>14} {'unit':8} {'goal':18} met")
    for name in chosen:
        context.case = name
        for figure in carry_out(cases[name], context):
            unmet += not figure["met"]
            print(json.dumps(figure) if options.json else line(figure), flush=True)
    if not options.json:
        print("every goal is met" if unmet == 0 else f"{unmet} goals are not met")
    return 1 if unmet else 0


def carry_out(module, context):
    """The case's figures; an error becomes a figure that is not met, and the other cases go on."""
    try:
        count = 0
        for count, figure in enumerate(module.run(context), 1):
            yield figure
        if count == 0:
            raise Failure("the case gave no figure")
    except KeyboardInterrupt:
        raise
    except Exception as error:  # noqa: BLE001
        if not isinstance(error, Failure):
            traceback.print_exc()
        yield {"case": context.case, "figure": f"error: {error}", "value": None, "unit": "", "goal": "no error",
               "met": False}


def line(figure):
    value = figure["value"]
    text = f"{value:.6g}" if isinstance(value, (int, float)) and not isinstance(value, bool) else str(value)
    return (f"{figure['case']:20} {figure['figure']:80} {text:>14} {figure['unit']:8} {figure['goal']:18} "
            f"{'yes' if figure['met'] else 'NO'}")
