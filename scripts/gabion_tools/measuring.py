"""Runs that only prepare a scene: packing and stiffness, one step, nothing kept."""

import json
import tempfile
from pathlib import Path

from gabion_tools import processes, run, scenes, summary
from gabion_tools.errors import Failure, UserError

# One step with nothing on the ground: what is wanted is measured before it.
BARE = ['stages=[{"name": "one step", "steps": 1}]', "block=null", "initial=null", "fills=[]", "probes=[]",
        "run.measure_energy=false"]


def prepared(scene, changes, look, threads=None):
    """look(folder, summary) after the scene was prepared with these changes in a folder that is then removed."""
    changes = [*changes, *BARE]
    with tempfile.TemporaryDirectory(prefix="gabion-") as keeper:
        folder = Path(keeper)
        code = processes.couple(scene, scenes.override_arguments(changes), folder,
                                run.engines(scenes.model(scene, changes), threads), quiet=True)
        if code != 0 or not (folder / "summary.json").exists():
            kind = UserError if code == 2 else Failure
            raise kind(f"the coupler ended with code {code}:\n" + processes.tail(folder / "coupler.log"))
        return look(folder, summary.load(folder))


def elasticity(scene, changes, threads=None):
    """{'young': Pa, 'poisson': -, 'misfit': -, ...} measured on the scene's packing."""
    def look(_, content):
        if "elasticity" not in content:
            raise Failure("the summary holds no measured elasticity; is mesh.stiffness = material set?")
        return content["elasticity"]
    return prepared(scene, ["model=continuum", "mesh.stiffness=measured", *changes], look, threads)


def material(name, normal, shear):
    """Changes that fill the ground with one elastic material of these stiffnesses, N/m2."""
    values = {"normal_stiffness": f"{normal!r} N/m2", "shear_stiffness": f"{shear!r} N/m2"}
    return [f"materials.{name}={json.dumps(values)}", f"ground.material={name}"]
