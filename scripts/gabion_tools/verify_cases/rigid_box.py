"""An impact on gravel in a rigid box against an independent code's run of the same grains (scenarios/data).

Three copies of the bed, settled with different damping: single force peaks scatter by 15 to 20 % between such copies,
penetrations by 1 %. Errors are those of the mean over the copies.
"""

import numpy as np

from gabion_tools.places import SCENARIOS

TITLE = "impact in a rigid box against an independent code: penetration and force"

DAMPING = (0.7, 0.6, 0.5)
LARGEST_FORCES = (1.914e6, 1.789e6, 1.784e6)  # N, mean over 4 ms: the independent code's run, a settled copy, half the step
SHORT, LONG = "60 ms", "0.5 s"


def reference():
    return np.genfromtxt(SCENARIOS / "data" / "rigid_box_history.csv", delimiter=",", comments="#", skip_header=3)


def at(run, time):
    """Penetration at a time after the release, m."""
    clock = run.history("block", "time") - run.summary["stages"][0]["time"]
    return float(np.interp(time, clock, run.history("block", "penetration")))


def run(context):
    history = reference()
    runs = [context.run_scene("rigid_box", {"stages[0].damping": damping,
                                            "stages[1].duration": LONG if context.full else SHORT})
            for damping in DAMPING]
    for time, goal in ((0.045, 0.01), (0.060, 0.02)):
        values = np.array([at(one, time) for one in runs])
        wanted = float(np.interp(time, history[:, 0], history[:, 1]))
        yield context.figure(f"penetration_{1e3 * time:.0f}ms_error", values.mean() / wanted - 1, "", f"-{goal} .. {goal}")
        yield context.figure(f"penetration_{1e3 * time:.0f}ms_scatter", values.std(ddof=1) / wanted, "", "report")
    if context.full:
        ends = np.array([one.summary["figures"]["block"]["penetration_end"] for one in runs])
        yield context.figure("penetration_end_error", ends.mean() / history[-1, 1] - 1, "", "-0.05 .. 0.05")
        yield context.figure("penetration_end_scatter", ends.std(ddof=1) / history[-1, 1], "", "report")
    forces = np.array([one.summary["figures"]["block"]["largest_force_4ms"] for one in runs])
    yield context.figure("largest_force_4ms_error", forces.mean() / np.mean(LARGEST_FORCES) - 1, "", "-0.15 .. 0.15")
    yield context.figure("largest_force_4ms_scatter", forces.std(ddof=1) / forces.mean(), "", "report")
    yield context.figure("bonds_left", max(one.summary["counters"]["bonds"] for one in runs), "", "< 160")
    yield context.figure("energy_balance", max(one.summary["energy"]["balance_error"] for one in runs), "", "<= 0.001")
