"""Speed at equal error: how many times cheaper than all grains a coupled model is within 1 or 3 % of them.

The points of `gabion bench error` for the impact and the compression; the cheapest one within the error counts. Counts are
grain-steps and weighted element-steps, free of noise; wall is the time of stepping on this machine, now.
"""

import math

from gabion_tools import bench_points
from gabion_tools.bench_cases import compression, impact
from gabion_tools.verify_cases import kernels

TITLE = "speed-up over all grains at equal error: impact at 3 %, compression at 1 %"

WANTED = (("impact", impact, 0.03, ("reference", "zone"), {"counts": ">= 15", "wall": ">= 15"}),
          ("compression", compression, 0.01, ("reference", "overlap", "mesh", "zone", "coupling"), {"counts": "report", "wall": "report"}))


def run(context):
    costs = bench_points.element_costs(kernels.speeds(context.executable))
    for name, module, limit, knobs, goals in WANTED:
        points, reference = [], None
        for job in module.jobs(context):
            if job["knob"] not in knobs:
                continue
            runs, parts = job["measure"]()
            point = bench_points.measured(name, job["label"], job["knob"], runs, parts, costs[module.KERNELS])
            points.append(point)
            reference = point if job.get("reference") else reference
        for which, cost in bench_points.COSTS.items():
            factor, best = bench_points.speedup(points, reference, limit, cost)
            yield context.figure(f"{name}_speedup_{which}_at_{round(100 * limit)}pct", factor, "times", goals[which])
            if best:
                yield context.figure(f"error of that point ({which}), {best.label}", best.error, "", f"<= {limit}")
                if math.isfinite(best.uncertainty):  # more than one packing
                    yield context.figure(f"standard error of that error ({which})", best.uncertainty, "", "report")
            for model in bench_points.COUPLED:
                factor, best = bench_points.speedup(points, reference, limit, cost, (model,))
                yield context.figure(f"{name}_{model}_speedup_{which}_at_{round(100 * limit)}pct" + (f", {best.label}" if best else ""), factor, "times",
                                     goals[which] if model == "bridging" else "report")

