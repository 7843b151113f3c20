"""Plot of the triaxial tests in a folder of gabion calibrate. Run as a program: FOLDER."""

import json
import math
import sys
from pathlib import Path

from gabion_tools import strength
from gabion_tools.style import plt, save

SHADES = plt.get_cmap("viridis")


def curves(folder, content):
    """(confinement, points, test) of every sample."""
    for one in content["samples"]:
        places = [folder / f"seed-{one['sample']['seed']}", folder / "final" / f"seed-{one['sample']['seed']}"]
        place = next(path for path in places if path.is_dir())
        for test in one["tests"]:
            yield test["confinement"], strength.read(place / test["curve"]), test


def strains(axes, every, shades, fine_to):
    """Deviator and volume strain: the whole test on the left, its beginning on the right."""
    for pressure, points, _ in every:
        axial = [100.0 * p["axial_strain"] for p in points]
        look = {"color": shades[pressure], "lw": 1.0}
        for column in (0, 1):
            axes[0][column].plot(axial, [p["q"] / 1e3 for p in points], **look)
            axes[1][column].plot(axial, [100.0 * p["volume_strain"] for p in points], **look)
    for column, title in ((0, "whole test"), (1, "beginning")):
        axes[0][column].set_title(title)
        axes[0][column].set_ylabel("deviator [kPa]")
        axes[1][column].set_ylabel("volume strain [%], compression positive")
        axes[1][column].set_xlabel("axial strain [%]")
    beginning = [p for _, points, _ in every for p in points if p["axial_strain"] <= fine_to]
    volumes = [100.0 * p["volume_strain"] for p in beginning]
    for row in (0, 1):
        axes[row][1].set_xlim(0.0, 100.0 * fine_to)
    margin = 0.05 * (max(volumes) - min(volumes)) or 1e-6
    axes[1][1].set_ylim(min(volumes) - margin, max(volumes) + margin)


def envelopes(axes, found, every):
    for kind, colour in (("peak", "#d62728"), ("residual", "#1f77b4")):
        pairs = [(test["figures"][kind]["sigma_3"], test["figures"][kind]["sigma_1"]) for _, _, test in every]
        angle, cohesion = found[kind]["friction_angle"]["mean"], found[kind]["cohesion"]["mean"]
        axes.plot([a / 1e3 for a, _ in pairs], [b / 1e3 for _, b in pairs], "o", color=colour, ms=4)
        if not math.isfinite(angle):
            continue
        ratio = (1 + math.sin(math.radians(angle))) / (1 - math.sin(math.radians(angle)))
        top = 1.1 * max(a for a, _ in pairs)
        axes.plot([0, top / 1e3], [2 * cohesion * math.sqrt(ratio) / 1e3, (ratio * top + 2 * cohesion * math.sqrt(ratio)) / 1e3],
                  color=colour, label=f"{kind}: {angle:.1f} degrees, {cohesion / 1e3:.1f} kPa")
    axes.set_xlabel("lateral stress [kPa]")
    axes.set_ylabel("axial stress [kPa]")
    axes.set_xlim(left=0)
    axes.set_ylim(bottom=0)
    axes.legend()


def draw(folder):
    folder = Path(folder)
    content = json.loads((folder / "calibration.json").read_text(encoding="utf-8"))
    every = list(curves(folder, content))
    pressures = sorted({pressure for pressure, _, _ in every})
    shades = {p: SHADES(0.1 + 0.75 * k / max(1, len(pressures) - 1)) for k, p in enumerate(pressures)}
    figure, axes = plt.subplots(2, 3, figsize=(13.0, 7.0))
    end = max(points[-1]["axial_strain"] for _, points, _ in every)
    peak = max(test["figures"]["peak"]["axial_strain"] for _, _, test in every)
    strains([row[:2] for row in axes], every, shades, min(end, max(0.002, 1.3 * peak) if peak < 0.5 * end else end))
    envelopes(axes[0][2], content["found"], every)
    told = set()
    for pressure, points, _ in every:
        axes[1][2].plot([100.0 * p["axial_strain"] for p in points], [p["contacts_per_grain"] for p in points], color=shades[pressure],
                        lw=1.0, label=f"{pressure / 1e3:g} kPa" if pressure not in told else None)
        told.add(pressure)
    axes[1][2].set_xlabel("axial strain [%]")
    axes[1][2].set_ylabel("contacts per grain")
    axes[1][2].legend(title="confinement")
    figure.suptitle(f"{content['material']}: {len(content['samples'])} periodic samples of "
                    f"{content['samples'][0]['sample']['grains']} grains, {content['samples'][0]['sample']['contacts_per_grain']:.2f} contacts per grain")
    return save(figure, folder, "triaxial")


if __name__ == "__main__":
    draw(sys.argv[1])
