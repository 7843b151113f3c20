"""coupling.zone = auto: a quick run with coarse grains shows where the ground yields; zone, overlap and mesh follow from it.

    hole     the box in which contacts slid or broke, and every fill (the mesh has the stiffness of the ground alone),
             and a margin of one diameter
    overlap  as wide as the target asks for (docs/theory.md, "How large a zone")
    mesh     the element size of least cost between 2.5 diameters and what the load's frequency allows
    zone     the hole and the overlap round it; a face that comes within two elements of the ground's own is put there
"""

import json
import math
import subprocess
import tempfile
from pathlib import Path

from gabion_tools import processes, run, scenes
from gabion_tools.errors import Failure, UserError
from gabion_tools.places import PYTHON, REPOSITORY, executable

COARSE_GRAINS = 30000      # of the quick run, at most about
ELEMENT_COST = 0.30        # of one element's step over one grain's, `gabion verify kernels`
YIELD_SHARE = 1.0 / 3.0    # of the target: share of yielding contacts that the mesh may miss
# least target error, for impacts of a block and for other loads: elements and diameters of the overlap, elements a wave
RULES = ((0.03, 0.05, (1, 2.5, 6)), (0.02, 0.02, (2, 5, 6)), (0.0, 0.0, (4, 10, 10)))
LEAST_ELEMENT = 2.5        # diameters
AXES = "xyz"


def effective(scene, changes):
    """The coupler's own view of a scene: what its check prints."""
    done = subprocess.run([str(executable("coupler")), str(scene), "--check", "--json", *scenes.override_arguments(changes)],
                          stdin=subprocess.DEVNULL, capture_output=True, text=True, check=False)
    if done.returncode != 0:
        raise UserError(done.stderr.strip())
    return json.loads(done.stdout)


def metres(value):
    return float(str(value).split()[0])


def box(value):
    return [[metres(v) for v in corner] for corner in value]


def mean_radius(radius):
    """By number; of one value, a uniform distribution, or a grain-size curve."""
    if isinstance(radius, dict) and "uniform" in radius:
        return 0.5 * sum(metres(r) for r in radius["uniform"])
    if isinstance(radius, dict):
        return mean_cube(radius) * sum(density * (1 / a - 1 / b) for a, b, density in sieves(radius))
    return metres(radius)


def mean_cube(radius):
    """Of the radius, by number."""
    if isinstance(radius, dict) and "uniform" in radius:
        a, b = map(metres, radius["uniform"])
        return (a + b) * (a * a + b * b) / 4
    if isinstance(radius, dict):  # a mass of 1 makes 1/(mean cube) grains
        return 1.0 / sum(density * 0.5 * (a ** -2 - b ** -2) for a, b, density in sieves(radius))
    return metres(radius) ** 3


def sieves(radius):
    """[(a, b, mass density)] between neighbouring sieves."""
    curve = [(metres(r), float(share)) for r, share in radius["sieve"]]
    return [(a, b, (q - p) / (b - a)) for (a, p), (b, q) in zip(curve, curve[1:])]


def scaled(radius, factor):
    if isinstance(radius, dict) and "uniform" in radius:
        return {"uniform": [f"{factor * metres(r)!r} m" for r in radius["uniform"]]}
    if isinstance(radius, dict):
        return {"sieve": [[f"{factor * metres(r)!r} m", share] for r, share in radius["sieve"]]}
    return f"{factor * metres(radius)!r} m"


def volume(corners):
    return math.prod(max(0.0, high - low) for low, high in zip(*corners))


class Sizing:
    """What the quick run is like, and what follows from it. scene: path; changes: 'key=value' of the user."""

    def __init__(self, scene, changes):
        self.scene, self.changes = scene, list(changes)
        checked = effective(scene, changes)
        self.wanted = checked["zone_to_choose"]
        self.values = checked["effective"]
        if not self.wanted:
            return
        self.model = self.values["model"]
        self.ground = box(self.values["ground"]["box"])
        self.diameter = 2.0 * mean_radius(self.values["grains"]["radius"])
        self.target = float(self.values["coupling"]["target_error"])
        per_grain = 4.0 / 3.0 * math.pi * mean_cube(self.values["grains"]["radius"]) / float(self.values["grains"]["solid_fraction"])
        self.density = 1.0 / per_grain  # grains per m3
        self.places = max(3, 4 - math.floor(math.log10(self.diameter)))  # decimals of what is written into the scene, m
        self.coarsening = max(1.0, (volume(self.ground) * self.density / COARSE_GRAINS) ** (1.0 / 3.0))

    def quick_changes(self):
        """The scene with all grains, coarse, until the load is over."""
        stages = self.values["stages"]
        changes = ["model=dem", "probes=[]", "output.every=null", "run.checkpoint_every=null",
                   f"grains.radius={json.dumps(scaled(self.values['grains']['radius'], self.coarsening))}"]
        block = self.values.get("block")
        loaded = [k for k, stage in enumerate(stages) if stage.get("damping", 0) == 0]
        if not loaded:
            raise UserError("coupling.zone: auto needs a stage without damping, in which the load acts")
        if block and "duration" in stages[loaded[-1]]:
            speed = block["velocity"]
            speed = metres(speed) if isinstance(speed, str) else math.hypot(*map(metres, speed))
            duration = min(metres(stages[loaded[-1]]["duration"]), metres(block["side"]) / max(speed, 1e-9))
            changes.append(f"stages[{loaded[-1]}].duration={duration!r} s")
        return changes

    def look(self, threads=None):
        """Makes the quick run and returns what zone_yield saw."""
        changes = [*self.changes, *self.quick_changes()]
        with tempfile.TemporaryDirectory(prefix="gabion-") as keeper:
            folder = Path(keeper)
            code = processes.couple(self.scene, scenes.override_arguments(changes), folder, run.engines("dem", threads), quiet=True)
            if code != 0 or not (folder / "summary.json").exists():
                kind = UserError if code == 2 else Failure
                raise kind(f"the quick run that sizes the zone ended with code {code}:\n" + processes.tail(folder / "coupler.log"))
            found = subprocess.run([PYTHON, "-m", "gabion_tools.zone_yield", str(folder), repr(YIELD_SHARE * self.target)],
                                   cwd=REPOSITORY / "scripts", stdin=subprocess.DEVNULL, capture_output=True, text=True, check=False)
            if found.returncode != 0:
                raise Failure("looking at the quick run failed:\n" + found.stderr.strip()[-1000:])
            return json.loads(found.stdout)

    def hole(self, seen):
        """Ground that must be grains alone, from what was seen; None where nothing yields and nothing else needs grains."""
        needed = [seen["box"]] if seen["box"] else []
        needed += [box(fill["box"]) for fill in self.values.get("fills", [])]
        block = self.values.get("block")
        if block:  # the grains under it
            half, place = 0.5 * metres(block["side"]), [metres(v) for v in block["position"][:2]]
            top = self.ground[1][2]
            needed.append([[place[0] - half, place[1] - half, top - half], [place[0] + half, place[1] + half, top]])
        if not needed:
            return None
        margin = self.diameter
        lo = [min(one[0][axis] for one in needed) - margin for axis in range(3)]
        hi = [max(one[1][axis] for one in needed) + margin for axis in range(3)]
        return [lo, hi]

    def rules(self):
        """Elements and diameters of the overlap, elements a wave."""
        return next(rule for impact, other, rule in RULES if self.target >= (impact if self.values.get("block") else other))

    def zone(self, hole, element):
        elements, diameters, _ = self.rules()
        overlap = self.up(max(elements * element, diameters * self.diameter)) if self.model == "bridging" else 0.0
        lo, hi = [], []
        for axis in range(3):
            low, high = hole[0][axis] - overlap, hole[1][axis] + overlap
            lo.append(self.ground[0][axis] if low < self.ground[0][axis] + 2 * element else round(low, self.places))
            hi.append(self.ground[1][axis] if high > self.ground[1][axis] - 2 * element else round(high, self.places))
        return overlap, [lo, hi]

    def up(self, length):
        """Rounded up: sizes have least values."""
        return math.ceil(length * 10 ** self.places - 1e-6) / 10 ** self.places

    def cost(self, overlap, zone, element):
        """Grain-steps and element-steps of one step, in grain-steps."""
        inner = [[a if a == g else a + overlap for a, g in zip(zone[0], self.ground[0])],
                 [a if a == g else a - overlap for a, g in zip(zone[1], self.ground[1])]]
        grains = volume(zone) * self.density
        elements = (volume(self.ground) - volume(inner)) / element ** 3
        return grains + ELEMENT_COST * elements, grains, elements

    def choose(self, seen):
        """{'changes': [...], 'text': [...], figures}; changes name the zone, or another model where one is enough."""
        text = [f"quick run: {seen['grains']} grains of {seen['diameter']:.3g} m; {100 * seen['yielded']:.2g} % of them yielded"]
        hole = self.hole(seen)
        if hole is None:
            text.append("nothing yields: a mesh alone (model = continuum); how far it is from all grains was not estimated")
            return {"changes": ["model=continuum"], "text": text, "seen": seen}
        if seen["box"]:
            text.append("yielding ground: " + " x ".join(f"{a:.2f} .. {b:.2f} m" for a, b in zip(*seen["box"])))
        else:
            text.append("nothing yields beside what the fills and the block need")
        least = self.up(LEAST_ELEMENT * self.diameter)
        largest = least
        _, _, elements_a_wave = self.rules()
        if seen["frequency"] and seen["shear_speed"]:
            wave = seen["shear_speed"] / seen["frequency"]
            largest = max(least, wave / elements_a_wave)
            load = f"load: 95 % of its rate below {seen['frequency']:.0f} Hz (4 ms mean), shear waves of {wave:.3g} m and longer"
            if wave / elements_a_wave < least:
                text.append(f"{load}: {elements_a_wave} elements a wave would be {wave / elements_a_wave:.3g} m, less than the 2.5 diameters, {least:.3g} m, "
                            "that an element needs; the run says what motion the mesh could not follow")
            else:
                text.append(f"{load}: elements of {least:.3g} m (2.5 diameters) to {largest:.3g} m")
        else:
            text.append(f"load: its frequency or the shear speed is not known; elements of 2.5 diameters, {least:.3g} m")
        sizes = [self.up(least * (largest / least) ** (k / 8)) for k in range(9)] if largest > least else [least]
        element = min(sizes, key=lambda h: self.cost(*self.zone(hole, h), h)[0])
        overlap, zone = self.zone(hole, element)
        total, grains, elements = self.cost(overlap, zone, element)
        whole = volume(self.ground) * self.density
        if zone == self.ground or total >= whole:
            text.append("the zone would fill the ground, or cost as much: all grains (model = dem); a larger ground would leave room for a mesh")
            return {"changes": ["model=dem"], "text": text, "seen": seen}
        text.append(f"target {100 * self.target:.3g} %: mesh {element:.3g} m" + (f", overlap {overlap:.3g} m" if overlap else "") +
                    ", zone " + " x ".join(f"{a:.2f} .. {b:.2f} m" for a, b in zip(*zone)))
        text.append(f"about {grains:.0f} grains and {elements:.0f} elements, {100 * total / whole:.0f} % of the cost of all grains")
        key = f"coupling.{self.model}"
        corners = json.dumps([[f"{v!r} m" for v in corner] for corner in zone])
        changes = [f"{key}.zone={corners}", f"mesh.size={element!r} m"]
        if overlap:
            changes.append(f"{key}.overlap={overlap!r} m")
        return {"changes": changes, "text": text, "seen": seen, "zone": zone, "overlap": overlap, "element": element,
                "volume": volume(zone), "cost_share": total / whole}


def resolve(scene, changes, threads=None, say=print):
    """The user's changes, with a zone in them where the scene leaves it open. Says what it chose and why."""
    text = Path(scene).read_text(encoding="utf-8", errors="replace")
    if "auto" not in scenes.without_comments(text) + "".join(changes):  # spares most scenes the question
        return list(changes), None
    sizing = Sizing(scene, changes)
    if not sizing.wanted:
        return list(changes), None
    say(f"coupling.zone = auto: quick run with grains {sizing.coarsening:.2g} times as large")
    choice = sizing.choose(sizing.look(threads))
    for line in choice["text"]:
        say("  " + line)
    return [*changes, *choice["changes"]], choice
