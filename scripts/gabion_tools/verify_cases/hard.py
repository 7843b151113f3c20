"""The hard cases of docs/hard_cases.md: each with its figures, from tests that really ran in this call."""

from gabion_tools import hard

TITLE = "hard cases: what can go wrong in a coupled run, and does not"


def run(context):
    outcomes = hard.run_all()
    for outcome in outcomes:
        case = outcome.case
        yield context.figure(f"{case.number} {case.name}", "passed" if outcome.passed else outcome.reason, "", "= passed")
        for name, goal in case.figures.items():
            if name in outcome.figures:
                yield context.figure(f"{case.number} {name}", hard.worst(outcome.figures[name], goal), "", goal)
    yield context.figure("passed", sum(outcome.passed for outcome in outcomes), "", f"= {len(outcomes)}")
    yield context.figure("total", len(outcomes), "", ">= 22")
