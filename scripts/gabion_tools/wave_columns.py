"""Columns long enough for a wave packet to cross an interface, and what came back and went through.

R: kinetic energy of the difference to the all-grain run, over the grains beyond the overlap, over the incident energy.
T: kinetic energy of the mesh beyond the overlap over the incident energy.
A travelling wave holds as much kinetic as potential energy, so the kinetic share stands for both.
"""

import json
import math

import numpy as np

SIGMAS = 3.0  # the packet's half length, in standard deviations
# Of the all-grain limit. All runs of a column take the same step: what is left of a wave in a random packing are
# vibrations of single grains, whose phase hangs on the step, and two runs that differ by that alone look like a reflection.
STEP_FRACTION = 0.85


class Column:
    """A column along an axis: packet above, overlap from 0 to its width, the rest below.

    scene: a wave scene; element: m; wavelength: m; unit: lengths are whole multiples of it, m;
    overlap: in elements; packet: standard deviation over wavelength; axis: 0, 1, 2.
    """

    def __init__(self, scene, element, wavelength, unit, side, overlap=8, packet=1.5, axis=2, changes=None):
        self.scene, self.element, self.axis, self.changes = scene, element, axis, dict(changes or {})
        self.overlap = overlap * element
        sigma = packet * wavelength
        reach = math.ceil(2 * SIGMAS * sigma / unit) * unit
        self.low, self.high = -reach, math.ceil(self.overlap / unit) * unit + reach
        self.side = side
        self.wave = {"axis": "xyz"[axis], "polarisation": "xyz"[axis], "wavelength": f"{wavelength!r} m",
                     "centre": f"{self.overlap + SIGMAS * sigma!r} m", "width": f"{sigma!r} m", "amplitude": "1 um",
                     "sense": "-"}
        self.path = 2 * SIGMAS * sigma + self.overlap

    def box(self, low, high):
        lo, hi = [0.0] * 3, [self.side] * 3
        lo[self.axis], hi[self.axis] = low, high
        return json.dumps([[f"{v!r} m" for v in lo], [f"{v!r} m" for v in hi]])

    def overrides(self, scheme, duration=None):
        border = 0.5 * self.overlap
        chosen = {
            "ground.box": self.box(self.low, self.high),
            "ground.periodic": json.dumps([a for k, a in enumerate("xyz") if k != self.axis]),
            "coupling.bridging.zone": self.box(0.0, self.high), "coupling.bridging.overlap": f"{self.overlap!r} m",
            "coupling.edge.zone": self.box(border, self.high), "mesh.size": f"{self.element!r} m",
            "initial.wave": json.dumps(self.wave), "probes": "[]", "output.every": "null",
            "stages": json.dumps([{"name": "pass", "damping": 0, **({"duration": f"{duration!r} s"} if duration else {"steps": 1})}]),
            **self.changes, **scheme}
        return chosen

    def run(self, context, scheme):
        """Runs the scheme; the packet's middle ends as far below the overlap as it started above."""
        bare = context.run_scene(self.scene, self.overrides({"model": "dem"}))
        elastic = bare.summary["elasticity"]
        speed = math.sqrt(elastic["stiffness"][self.axis][self.axis] / elastic["density"])
        step = {"run.step": f"{STEP_FRACTION * bare.summary['step']['stable_dem']!r} s"}
        return context.run_scene(self.scene, self.overrides({**step, **scheme}, self.path / speed))

    def measure(self, context, scheme):
        """R, T, and the all-grain T."""
        reference, coupled = self.run(context, {"model": "dem"}), self.run(context, scheme)
        whole, first = reference.state("grains", -1), reference.state("grains", 0)
        part, mesh = coupled.state("grains", -1), coupled.state("mesh", -1)
        above = self.overlap + 0.5 * self.element
        mass = whole["radius"] ** 3
        energy = lambda m, v: float((m[:, None] * v ** 2).sum())  # noqa: E731
        incident = energy(mass, first["velocity"])
        place = {origin: k for k, origin in enumerate(whole["origin_id"])}
        same = np.array([place[origin] for origin in part["origin_id"]])
        beyond = part["position"][:, self.axis] > above
        difference = part["velocity"] - whole["velocity"][same]
        reflected = energy(part["radius"][beyond] ** 3, difference[beyond]) / incident
        joules = incident * self.grain_density * 4 / 3 * math.pi
        corners = mesh["nodes"][mesh["elements"]]
        volume = np.ptp(corners, axis=1).prod(axis=1)
        nodal = np.zeros(len(mesh["nodes"]))
        np.add.at(nodal, mesh["elements"].ravel(), np.repeat(volume / 8, 8))
        nodal *= coupled.summary["elasticity"]["density"]
        below = mesh["nodes"][:, self.axis] < 0.0
        through = energy(nodal[below], mesh["velocity"][below]) / joules
        under = whole["position"][:, self.axis] < 0.0
        return reflected, through, energy(mass[under], whole["velocity"][under]) / incident

    grain_density = 2650.0
