"""Pages, tables and figures of gabion bench error. Needs matplotlib."""

import csv
import html
import math

from gabion_tools import report_page
from gabion_tools.bench_points import COSTS, COUPLED, HEADLINES, front, speedup
from gabion_tools.style import MODEL_COLOURS, plt

AXES = {"counts": "grain-steps + element cost x element-steps", "wall": "time of stepping [s]"}
ALWAYS_OMITTED = ("precision: both engines compute in doubles alone (a single at 10 m ends at 1 um)",)
FLOOR = 1e-5  # errors below it are drawn there


def draw(folder, name, title, points, reference, floor):
    """One figure a scene: error against both costs, the front, the all-grain line and the scatter of the reference."""
    figure, panels = plt.subplots(1, 2, figsize=(13.5, 6.4), sharey=True)
    shown = [p for p in points if not p.failed and p.model != "dem" or p.knob == "grain size"]
    for panel, (which, cost) in zip(panels, COSTS.items()):
        for k, point in enumerate(shown):
            error, uncertainty = max(point.error, FLOOR), point.uncertainty
            colour = MODEL_COLOURS.get(point.model, "k")
            if math.isfinite(uncertainty):
                low = max(error - uncertainty, 0.3 * error, FLOOR)
                panel.plot([cost(point)] * 2, [low, error + uncertainty], color=colour, lw=1.0, alpha=0.6)
            panel.plot(cost(point), error, "o", ms=5, color=colour)
            panel.annotate(str(k + 1), (cost(point), error), textcoords="offset points", xytext=(5, 3), fontsize=8)
        best = front(shown, cost)
        panel.plot([cost(p) for p in best], [max(p.error, FLOOR) for p in best], "k-", lw=0.9, alpha=0.5)
        if reference:
            panel.axvline(cost(reference), color=MODEL_COLOURS["dem"], ls="--", lw=1.2)
            panel.annotate("all grains", (cost(reference), 1.0), xycoords=("data", "axes fraction"), xytext=(4, -12),
                           textcoords="offset points", color=MODEL_COLOURS["dem"], fontsize=9)
        if floor:
            panel.axhline(floor, color="0.5", ls=":", lw=1.0)
        panel.set(xscale="log", yscale="log", xlabel=AXES[which])
    panels[0].set(ylabel="error against the reference")
    if floor:
        panels[0].annotate("standard error of all grains alone", (0.01, floor), xycoords=("axes fraction", "data"), fontsize=8, color="0.4",
                           textcoords="offset points", xytext=(0, 3))
    handles = [plt.Line2D([], [], marker="o", ls="", color=c, label=m) for m, c in MODEL_COLOURS.items() if any(p.model == m for p in shown)]
    panels[1].legend(handles=handles, loc="best")
    panels[0].set_title(title, loc="left")
    text = "\n".join(f"{k + 1:2d} {p.label}" for k, p in enumerate(shown))
    figure.text(1.0, 0.98, text, va="top", ha="left", fontsize=8, family="monospace")
    plots = folder / "plots"
    plots.mkdir(exist_ok=True)
    path = plots / f"{name}.png"
    figure.savefig(path, bbox_inches="tight")
    plt.close(figure)
    return path


def number(value):
    if value is None or (isinstance(value, float) and math.isnan(value)):
        return "-"
    return f"{value:.3g}"


def row(point, reference):
    parts = "; ".join(f"{name} {100 * mean:+.2f}" + (f" +- {100 * error:.2f}" if math.isfinite(error) else "") + " %"
                      for name, (mean, error) in point.means.items())
    ratios = [number(cost(reference) / cost(point)) if reference and cost(point) > 0 else "-" for cost in COSTS.values()]
    return [point.label, point.knob, point.failed or parts, number(100 * point.error) if not point.failed else "-", number(point.grains),
            number(point.elements), number(point.steps), number(point.counts), number(point.wall), *ratios, point.note]


HEAD = ("point", "changed", "errors", "worst [%]", "grains", "elements", "steps", "counts", "wall [s]", "speed-up, counts", "speed-up, wall", "note")


def headlines(points, reference):
    """[(limit, model, which cost, factor, point)]"""
    good = [p for p in points if not p.failed]
    return [(limit, model, which, *speedup(good, reference, limit, cost, (model,)))
            for limit in HEADLINES for model in COUPLED for which, cost in COSTS.items()]


def sentence(limit, model, which, factor, point):
    unit = "counts" if which == "counts" else "wall time"
    if factor is None:
        return f"{model} at {100 * limit:.0f} %: no point within ({unit})"
    doubt = "" if not math.isfinite(point.uncertainty) else f" +- {100 * point.uncertainty:.2f}"
    return f"{model} at {100 * limit:.0f} %: {factor:.2f} times all grains in {unit}, {point.label} (error {100 * point.error:.2f}{doubt} %)"


def write_table(path, points, reference):
    with open(path, "w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file)
        writer.writerow(HEAD)
        writer.writerows(row(p, reference) for p in points)


def table(points, reference):
    cells = lambda words, tag: "<tr>" + "".join(f"<{tag}>{html.escape(str(w))}</{tag}>" for w in words) + "</tr>"  # noqa: E731
    return "<table>" + cells(("", *HEAD), "td") + "".join(cells((k + 1, *row(p, reference)), "td") for k, p in enumerate(points)) + "</table>"


def write(folder, cases):
    """folder/index.html from [(name, module, points, reference, floor, element cost)]; CSV and PNG beside it."""
    parts = ["<p>" + html.escape("Every point is one way to run a scene; its error is that against the reference named with the scene, its cost is "
             "counted and timed beside all grains of the same packing. The front joins points that none other beats.") + "</p>"]
    overview = []
    for name, module, points, reference, floor, element_cost in cases:
        write_table(folder / f"{name}.csv", points, reference)
        picture = draw(folder, name, module.TITLE, points, reference, floor)
        lines = [sentence(*line) for line in headlines(points, reference)]
        overview += [(name, line) for line in lines]
        failed = [p for p in points if p.failed]
        parts += [f"<h2>{html.escape(module.TITLE)}</h2>", f"<p>Reference: {html.escape(module.REFERENCE)}<br>Error: {html.escape(module.ERROR)}<br>"
                  f"An element's step counts {element_cost:.2f} of a grain's.</p>", "<ul>" + "".join(f"<li>{html.escape(line)}</li>" for line in lines) + "</ul>",
                  report_page.image(picture), table([p for p in points if not p.failed], reference)]
        omitted = [f"{p.label}: {p.failed}" for p in failed] + [*getattr(module, "OMITTED", ()), *ALWAYS_OMITTED]
        if omitted:
            parts += ["<p>Failed or left out:</p><ul>" + "".join(f"<li>{html.escape(text)}</li>" for text in omitted) + "</ul>"]
    parts.insert(1, report_page.table(overview))
    page = report_page.page("Speed against error", parts).replace("max-width:62em", "max-width:100em")
    (folder / "index.html").write_text(page, encoding="utf-8")
