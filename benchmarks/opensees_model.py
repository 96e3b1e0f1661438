"""A scene's wire model in OpenSees: same nodes, section, supports and sphere contact as `wirefe`.

Built from `coilspring` alone. The choices that OpenSees leaves open:

- forceBeamColumn with an elastic section that has shear, two Gauss points (exact for a straight
  element) and the Corotational transformation. ElasticTimoshenkoBeam would ignore that one silently.
- Stiff beams from the top reference point, since rigidLink holds for small rotations only.
- corotTruss with a gap material between the sphere centres: F = K max(0, d - h) exactly.
- Newton's method, SparseSYM with RCM: as fast as SparseGEN or UmfPack and much faster than the band
  and profile solvers. KrylovNewton and NewtonLineSearch lose Spring A's path, at 50 steps already.
- EnergyIncr against the work of the load. RelativeEnergyIncr refers to the first iterate of the step,
  which overshoots the farther, the larger the step: at a few steps it then accepts wrong states.
"""

from __future__ import annotations

import math
import os
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass

import numpy as np
from openseespy import opensees as ops

from coilspring import Scene
from coilspring.wire import SHEAR_FACTOR

ELEMENTS_PER_TURN = 40
PAIRS_PER_TURN = 4
STRIDE = ELEMENTS_PER_TURN // PAIRS_PER_TURN
STIFF = 1e4  # sections of the stiff beams over the wire's; 1e2 to 1e6 move Spring A's tip by 1e-5
MOST_ITERATIONS = 60  # of a step
NEVER_YIELDS = -1e12  # yield stress of the gap material, in compression
WIRE, STEEP, SECTION, RULE = 1, 2, 1, 1  # tags


@dataclass(frozen=True)
class Run:
    """End of one OpenSees analysis.

    Attributes
    ----------
    tip : (3,) UX, UY, ROTZ of the top reference point at time 1; None where a step did not converge.
    seconds : CPU time of the analysis, without the building of the model.
    iterations : Newton iterations of all steps.
    """

    tip: np.ndarray | None
    seconds: float
    iterations: int


class _Builder:
    """Puts a scene into OpenSees' one global model."""

    def __init__(self, scene: Scene) -> None:
        self.scene = scene
        self.last = round(scene.spring.active_coils * ELEMENTS_PER_TURN)  # node of the last active point
        self.top = self.last + 1  # reference point
        self.nodes = 0
        self.elements = 0
        area, inertia = (
            math.pi * np.array((1.0 / 4.0, 1.0 / 64.0)) * scene.spring.wire_diameter ** np.array((2, 4))
        )
        self.area, self.inertia = float(area), float(inertia)

    def build(self) -> None:
        """Build the whole model, the load included."""
        ops.wipe()
        ops.model("basic", "-ndm", 3, "-ndf", 6)
        self._wire()
        self._supports()
        self._stiff_beam(self.last)
        if self.scene.contact.enabled:
            self._contact()
        ops.timeSeries("Linear", 1)
        ops.pattern("Plain", 1, 1)
        ops.load(self.top, *self.scene.load.force, 0.0, 0.0, 0.0, 0.0)

    def _node(self, point: np.ndarray) -> int:
        ops.node(self.nodes, *point.tolist())
        self.nodes += 1
        return self.nodes - 1

    def _element(self, kind: str, first: int, second: int, *properties: float) -> None:
        self.elements += 1
        ops.element(kind, self.elements, first, second, *properties)

    def _wire(self) -> None:
        """Nodes 0 to `last` on the helix, then the reference point; straight elements between them."""
        spring, material = self.scene.spring, self.scene.material
        for point in spring.points(np.linspace(0.0, spring.phase_end, self.last + 1)):
            self._node(point)
        self._node(np.array([0.0, spring.active_height, 0.0]))
        area, inertia = self.area, self.inertia
        properties = (material.E, area, inertia, inertia, material.G, 2.0 * inertia)
        ops.section("Elastic", SECTION, *properties, SHEAR_FACTOR, SHEAR_FACTOR)
        ops.beamIntegration("Legendre", RULE, SECTION, 2)
        ops.geomTransf("Corotational", WIRE, 0.0, 1.0, 0.0)  # the wire never runs along Y ...
        ops.geomTransf("Corotational", STEEP, 0.0, 0.0, 1.0)  # ... but a stiff beam may
        for node in range(self.last):
            self._element("forceBeamColumn", node, node + 1, WIRE, RULE)

    def _supports(self) -> None:
        held = self.scene.supports.top_held
        ops.fix(0, *[1] * 6)
        ops.fix(self.top, int("ux" in held), 0, 1, 1, 1, int("rotz" in held))

    def _stiff_beam(self, node: int) -> None:
        """Tie a node to the top reference point."""
        chord = np.subtract(ops.nodeCoord(node), ops.nodeCoord(self.top))
        steep = abs(chord[1]) > 0.9 * np.linalg.norm(chord)
        material, area, inertia = self.scene.material, STIFF * self.area, STIFF * self.inertia
        properties = (area, material.E, material.G, 2.0 * inertia, inertia, inertia)
        self._element("elasticBeamColumn", self.top, node, *properties, STEEP if steep else WIRE)

    def _sphere(self, index: int) -> int:
        """Node at the centre of the sphere at phase index * pi/2: of the wire, or of a rigid end."""
        node = index * STRIDE
        if 0 <= node <= self.last:
            return node
        phase = np.array([2.0 * math.pi / PAIRS_PER_TURN * index])
        node = self._node(self.scene.spring.points(phase)[0])
        if index < 0:
            ops.fix(node, *[1] * 6)
        else:
            self._stiff_beam(node)
        return node

    def _contact(self) -> None:
        """Trusses between spheres a turn apart, but not within one rigid end."""
        first, end = (phase / (2.0 * math.pi) * PAIRS_PER_TURN for phase in self.scene.spring.phase_range)
        spheres = {i: self._sphere(i) for i in range(math.ceil(first - 1e-9), math.floor(end + 1e-9) + 1)}
        for index, lower in spheres.items():
            above = index + PAIRS_PER_TURN
            if above > 0 and above in spheres and index * STRIDE < self.last:
                self._gap(lower, spheres[above])

    def _gap(self, lower: int, upper: int) -> None:
        """Penalty between two sphere centres; strain is (h - rest) / rest, area 1."""
        rest = float(np.linalg.norm(np.subtract(ops.nodeCoord(upper), ops.nodeCoord(lower))))
        gap = self.scene.spring.wire_diameter / rest - 1.0
        tag = self.elements + 1
        ops.uniaxialMaterial("ElasticPPGap", tag, self.scene.contact.stiffness * rest, NEVER_YIELDS, gap)
        self._element("corotTruss", lower, upper, 1.0, tag)


def run(scene: Scene, steps: int, energy: float) -> Run:
    """Build the scene's model and load it in equal steps.

    Parameters
    ----------
    scene : frictionless, contact exponent 1.
    steps : number of load steps.
    energy : energy increment below which a step has converged, N mm.
    """
    with quiet():
        builder = _Builder(scene)
        builder.build()
        _prepare(steps, energy)
        began = time.process_time()
        iterations = 0
        completed = True
        for _ in range(steps):
            completed = ops.analyze(1) == 0
            if not completed:
                break
            iterations += ops.testIter()
        seconds = time.process_time() - began
        tip = np.array([ops.nodeDisp(builder.top, freedom) for freedom in (1, 2, 6)]) if completed else None
        ops.wipe()
    return Run(tip, seconds, iterations)


def _prepare(steps: int, energy: float) -> None:
    ops.constraints("Plain")
    ops.numberer("RCM")
    ops.system("SparseSYM")
    ops.test("EnergyIncr", energy, MOST_ITERATIONS, 0)
    ops.algorithm("Newton")
    ops.integrator("LoadControl", 1.0 / steps)
    ops.analysis("Static")


@contextmanager
def quiet() -> Iterator[None]:
    """Send what OpenSees prints, from C++ and past Python, nowhere."""
    sys.stdout.flush()
    sys.stderr.flush()
    kept = os.dup(1), os.dup(2)
    try:
        silence()
        yield
    finally:
        sys.stdout.flush()
        sys.stderr.flush()
        for copy, stream in zip(kept, (1, 2), strict=True):
            os.dup2(copy, stream)
            os.close(copy)


def silence() -> None:
    """Send standard output and error nowhere."""
    nowhere = os.open(os.devnull, os.O_WRONLY)
    os.dup2(nowhere, 1)
    os.dup2(nowhere, 2)
    os.close(nowhere)
