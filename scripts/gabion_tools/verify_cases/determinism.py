"""The same scene gives the same bits: run twice, and with two threads an engine."""

TITLE = "same bits when run again and with two threads"

SCENE = "tiny"


def run(context):
    for model in ("bridging", "edge", "dem", "continuum"):
        first = context.run_scene(SCENE, {"model": model}, threads=1)
        again = context.run_scene(SCENE, {"model": model}, threads=1, repeat=1)
        threaded = context.run_scene(SCENE, {"model": model}, threads=2)
        wanted = first.summary["state_hash"]
        yield context.figure(f"{model}: run again, hashes equal", again.summary["state_hash"] == wanted, "", "= True")
        yield context.figure(f"{model}: two threads, hashes equal", threaded.summary["state_hash"] == wanted, "",
                             "= True")
