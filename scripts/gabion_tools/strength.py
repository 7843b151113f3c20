"""Figures of triaxial curves: peak, residual, dilation, and the straight envelope through several confinements.

Compression is positive. sigma_1 is the axial stress, sigma_3 the mean of the two lateral ones, q = sigma_1 - sigma_3.
"""

import csv
import math
import statistics

RESIDUAL_FROM = 0.7     # share of the axial strain at the end from which the deviator counts as residual
DILATION_WINDOW = 0.1   # share of the axial strain over which the volume's slope is taken
STEADY = 0.10           # relative difference between the halves of the residual part that is still called steady


def read(path):
    """Points of one curve: dicts with axial_strain, volume_strain, sigma_1, sigma_3, q, broken_bonds ..."""
    with open(path, newline="", encoding="utf-8") as file:
        points = [{key.split(" ")[0]: float(value) for key, value in row.items()} for row in csv.DictReader(file)]
    for point in points:
        point["sigma_1"] = point["axial_stress"]
        point["sigma_3"] = 0.5 * (point["lateral_stress_1"] + point["lateral_stress_2"])
        point["q"] = point["sigma_1"] - point["sigma_3"]
    return points


def slope(x, y):
    """Of the least-squares line, and its value at x = 0."""
    mean_x, mean_y = statistics.fmean(x), statistics.fmean(y)
    square = sum((a - mean_x) ** 2 for a in x)
    tilt = sum((a - mean_x) * (b - mean_y) for a, b in zip(x, y)) / square
    return tilt, mean_y - tilt * mean_x


def dilation_angle(rate):
    """Degrees, from the rate of volume strain over axial strain: sin psi = -rate/(2 - rate) (Vermeer & de Borst 1984)."""
    return math.degrees(math.asin(max(-1.0, min(1.0, -rate / (2.0 - rate)))))


def steepest_dilation(points):
    """The most dilative slope of volume strain over axial strain in any window of the test."""
    end, best = points[-1]["axial_strain"], 0.0
    for first, point in enumerate(points):
        inside = [p for p in points[first:] if p["axial_strain"] <= point["axial_strain"] + DILATION_WINDOW * end]
        if len(inside) < 4 or inside[-1]["axial_strain"] < point["axial_strain"] + 0.7 * DILATION_WINDOW * end:
            continue
        best = min(best, slope([p["axial_strain"] for p in inside], [p["volume_strain"] for p in inside])[0])
    return best


def figures(points):
    """What one curve gives. The first point is the confined sample."""
    end = points[-1]["axial_strain"]
    peak = max(points, key=lambda point: point["q"])
    last = [point for point in points if point["axial_strain"] >= RESIDUAL_FROM * end]
    middle = 0.5 * (1.0 + RESIDUAL_FROM) * end
    residual = statistics.fmean(point["q"] for point in last)
    halves = [[p["q"] for p in last if (p["axial_strain"] >= middle) == late] for late in (False, True)]
    drift = (statistics.fmean(halves[1]) - statistics.fmean(halves[0])) / residual if all(halves) and residual else 0.0
    half = next(point for point in points if point["q"] >= 0.5 * peak["q"])
    rate = steepest_dilation(points)
    return {
        "peak": {"q": peak["q"], "sigma_1": peak["sigma_1"], "sigma_3": peak["sigma_3"], "axial_strain": peak["axial_strain"]},
        "residual": {"q": residual, "sigma_1": statistics.fmean(p["sigma_1"] for p in last),
                     "sigma_3": statistics.fmean(p["sigma_3"] for p in last), "drift": drift, "steady": abs(drift) <= STEADY},
        "secant_modulus_at_half_peak": (half["q"] - points[0]["q"]) / half["axial_strain"] if half["axial_strain"] > 0 else math.nan,
        "dilation_angle": dilation_angle(rate),
        "volume_strain_at_end": points[-1]["volume_strain"],
        "largest_lateral_error": max(abs(p["sigma_3"] / points[0]["sigma_3"] - 1.0) for p in points[1:]),
        "broken_bonds": points[-1]["broken_bonds"],
    }


def envelope(pairs):
    """Friction angle (degrees) and cohesion (Pa) of sigma_1 = N sigma_3 + 2 c sqrt(N), least squares over (sigma_3, sigma_1).

    With one confinement there is no line to fit: the angle is that of a material without cohesion.
    """
    if len(pairs) == 1:
        ratio, offset = pairs[0][1] / pairs[0][0], 0.0
    else:
        ratio, offset = slope([pair[0] for pair in pairs], [pair[1] for pair in pairs])
    if ratio <= 0.0:
        return {"friction_angle": math.nan, "cohesion": math.nan, "misfit": math.nan}
    misfit = math.sqrt(statistics.fmean((s1 - ratio * s3 - offset) ** 2 for s3, s1 in pairs))
    return {"friction_angle": math.degrees(math.asin((ratio - 1.0) / (ratio + 1.0))),
            "cohesion": offset / (2.0 * math.sqrt(ratio)), "misfit": misfit}


def spread(values):
    """Mean, standard deviation over the seeds (none for one) and the values themselves."""
    return {"mean": statistics.fmean(values), "deviation": statistics.stdev(values) if len(values) > 1 else None,
            "values": list(values)}
