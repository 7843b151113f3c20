"""gabion bench error: speed against error, scene by scene, on one page. What was run already is not run again."""

import importlib
import json
import os
import pkgutil
import sys
import time
import traceback
from pathlib import Path

from gabion_tools import build, packages
from gabion_tools.errors import Failure, UserError, advice
from gabion_tools.places import BUILD, PYTHON, executable, short


def arguments(parser):
    parser.add_argument("what", choices=["error"], help="error: work against precision")
    parser.add_argument("scenes", nargs="*", metavar="SCENE", help="scenes to do (default: all)")
    parser.add_argument("--list", action="store_true", help="name the scenes and stop")
    parser.add_argument("--full", action="store_true", help="more packings and more points; hours")
    parser.add_argument("--out", type=Path, help="folder of the page and of the runs (default: build/bench)")
    parser.add_argument("--yes", action="store_true", help="install missing packages without asking")


def registry():
    """{name: module}; names have hyphens where files have underscores."""
    from gabion_tools import bench_cases
    return {module.name.replace("_", "-"): importlib.import_module(f"gabion_tools.bench_cases.{module.name}")
            for module in sorted(pkgutil.iter_modules(bench_cases.__path__), key=lambda m: m.name)}


def main(options):
    cases = registry()
    if options.list:
        for name, module in cases.items():
            print(f"{name:16} {module.TITLE}")
        return 0
    for name in options.scenes:
        if name not in cases:
            raise UserError(f"no scene '{name}' in this benchmark; {advice(name, cases)}")
    packages.ensure(options.yes)
    if os.path.realpath(sys.executable) != os.path.realpath(PYTHON):
        raise Failure(f"bench needs numpy and matplotlib of {PYTHON}; start scripts/gabion with it")
    build.ensure(options.yes, everything=True)
    from gabion_tools import bench_page
    from gabion_tools.bench_runs import BenchContext
    folder = (options.out or BUILD / "bench").resolve()
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise UserError(f"--out {short(folder)} cannot be made: {error.strerror}") from None
    context, done, begin = BenchContext(folder, options.full, lambda text: print(text, flush=True)), [], time.monotonic()
    costs = element_costs(folder, context)
    for name, module in cases.items():
        if options.scenes and name not in options.scenes:
            continue
        print(f"{name}: {module.TITLE}", flush=True)
        cost = costs[module.KERNELS]
        points, reference, floor = collect(name, module, context, cost)
        done.append((name, module, points, reference, floor, cost))
        bench_page.write(folder, done)
        for line in bench_page.headlines(points, reference):
            print("  " + bench_page.sentence(*line))
        print(f"  {len(points)} points, {sum(bool(p.failed) for p in points)} failed, {time.monotonic() - begin:.0f} s so far", flush=True)
    print(f"{context.made} runs made, {context.taken} times one was there already; page {short(folder / 'index.html')}")
    return 1 if any(not points for _, _, points, *_ in done) else 0


def collect(name, module, context, element_cost):
    """(points, the all-grain point, standard error of all grains alone or None)."""
    from gabion_tools import bench_points
    points, reference, floor = [], None, None
    for job in module.jobs(context):
        try:
            runs, parts = job["measure"]()
            point = bench_points.measured(name, job["label"], job["knob"], runs, parts, element_cost, job.get("note", ""))
        except KeyboardInterrupt:
            raise
        except Exception as error:  # noqa: BLE001
            if not isinstance(error, Failure):
                traceback.print_exc()
            point = bench_points.Point(name, job["label"], job["knob"], "", {}, 0, 0, 0, 0, 0, 0, 0, failed=str(error).splitlines()[0])
        if job.get("reference"):
            reference, floor = point, job.get("floor", lambda: None)()
        points.append(point)
        print(f"  {point.label}: " + (point.failed or f"error {100 * point.error:.2f} %, counts {point.counts:.3g}, wall {point.wall:.3g} s"), flush=True)
    return points, None if reference is None or reference.failed else reference, floor


def element_costs(folder, context):
    """As bench_points.element_costs, measured once for these programs."""
    from gabion_tools import bench_points
    from gabion_tools.verify_cases import kernels
    kept = folder / f"kernels-{context.programs}.json"
    if not kept.exists():
        print("timing an element's step and a grain's", flush=True)
        kept.write_text(json.dumps(kernels.speeds(executable)), encoding="utf-8")
    return bench_points.element_costs(json.loads(kept.read_text(encoding="utf-8")))
