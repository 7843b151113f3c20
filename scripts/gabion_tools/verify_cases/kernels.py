"""Speed of the engines alone on one thread, from bench_dem and bench_continuum.

Goals: the fastest peer that carries the same physics, measured on a machine of this kind. Bonded grains with
rotation: ESyS-Particle 2.3.5, 1.46 M particle-steps/s. Frictional grains: LAMMPS, 8.06. Elements: the upper end of the published figures of LULESH's
one-point hexahedra, 1.68 M element-steps/s.
"""

import re
import subprocess

TITLE = "speed of contacts and elements, one thread"

LINE = re.compile(r"(?P<case>.*?)\s{2,}.*?(?P<value>[\d.]+) M (?P<unit>particle|element)-steps/s")
GOALS = {"particle": "> 1.46", "element": "> 1.68"}
FRICTIONAL_GOAL = "> 8.06"
DEADLINE = 300  # s
PROGRAMS = ("bench_dem", "bench_continuum")
# the least that the larger scenes need, on one core
NAMED = {"bonded, frozen": ("bonded_20k_mps", ">= 4e6"), "bricks, isotropic": ("brick_eps", ">= 1e7")}


def measured(executable):
    """The lines of one benchmark program that say a speed."""
    text = subprocess.run([str(executable)], capture_output=True, text=True, timeout=DEADLINE, check=True).stdout
    return list(filter(None, map(LINE.match, text.splitlines())))


def speeds(executable_of):
    """{case: million steps/s} of both programs; executable_of: name -> path."""
    return {row["case"].strip(): float(row["value"]) for program in PROGRAMS for row in measured(executable_of(program))}


def run(context):
    for program in PROGRAMS:
        found = measured(context.executable(program))
        if not found:
            yield context.figure(f"{program} printed no speed", False, "", "= True")
        for row in found:
            if row["case"].strip() in NAMED:
                name, goal = NAMED[row["case"].strip()]
                yield context.figure(name, 1e6 * float(row["value"]), f"{row['unit']}-steps/s", goal)
            yield context.figure(f"{program}: {row['case']}", float(row["value"]), f"M{row['unit'][0]}/s",
                                 FRICTIONAL_GOAL if row["case"].startswith("frictional") else GOALS[row["unit"]])
