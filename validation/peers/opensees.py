"""A scene's wire model in OpenSees: same nodes, section, supports and sphere contact as `wirefe`.

The choices that OpenSees leaves open:

- forceBeamColumn with an elastic section that has shear, two Gauss points (exact for a straight
  element) and the Corotational transformation. ElasticTimoshenkoBeam would ignore that one silently.
- Stiff beams from the top reference point, since rigidLink holds for small rotations only.
- corotTruss with a gap material between the sphere centres: F = K max(0, d - h) exactly.
- A prescribed UY is reached by DisplacementControl of a force along Y, whose factor is the reaction.
- Newton's method, SparseSYM with RCM: as fast as SparseGEN or UmfPack and much faster than the band
  and profile solvers. KrylovNewton and NewtonLineSearch lose Spring A's path, at 50 steps already.
- EnergyIncr against the work of the load. RelativeEnergyIncr refers to the first iterate of the step,
  which overshoots the farther, the larger the step: at a few steps it then accepts wrong states.
- "No sliding": a pair that a step has closed gets a zeroLength element with two springs K across its
  direction, and loses it when a step has opened it, after which the equilibrium is found anew. That is
  linear in the displacements, as `wirefe`'s law.
"""

import atexit
import math
import os
import sys
import time
from collections.abc import Iterator, Sequence
from contextlib import contextmanager

import numpy as np
from openseespy import opensees as ops

from coilspring import Scene
from coilspring.scene.load import stage_ends
from coilspring.scene.sizing import axial_rate
from coilspring.scene.wire import SHEAR_FACTOR
from validation.peers.layout import NODES_PER_TURN, PeerCurve, amplitudes, layout, refuse

TOLERANCE = 1e-10  # of the energy test, over a bound of the load's work
STIFF = 1e4  # sections of the stiff beams over the wire's; 1e2 to 1e6 move Spring A's tip by 1e-5
MOST_ITERATIONS = 60  # of a step
HALVINGS = 6  # of a step that does not converge
NEVER_YIELDS = -1e12  # yield stress of the gap material, in compression
WIRE, STEEP, SECTION, RULE, TANGENTIAL = 1, 2, 1, 1, 1_000_000  # tags


@contextmanager
def quiet() -> Iterator[None]:
    """Send what OpenSees prints, from C++ and past Python, nowhere."""
    kept = os.dup(1), os.dup(2)
    silence()
    try:
        yield
    finally:
        _redirect(kept)


def silence() -> None:
    """Send standard output and error nowhere."""
    _redirect([os.open(os.devnull, os.O_WRONLY) for _ in range(2)])


def _redirect(targets: Sequence[int]) -> None:
    """Send standard output and error to two files, which are closed as such."""
    for python, stream, target in zip((sys.stdout, sys.stderr), (1, 2), targets, strict=True):
        python.flush()
        os.dup2(target, stream)
        os.close(target)


atexit.register(silence)  # OpenSees says good-bye when the interpreter ends


class _Builder:
    """Puts a scene into OpenSees' one global model."""

    def __init__(self, scene: Scene, elements_per_turn: int) -> None:
        self.scene = scene
        self.wire = layout(scene, elements_per_turn)
        self.last = len(self.wire.points) - 1
        self.top = self.last + 1  # reference point
        self.nodes = self.elements = 0
        # nodes of the sphere centres, and the element that keeps a pair from sliding
        self.pairs: dict[tuple[int, int], int | None] = {}
        d = scene.spring.wire_diameter
        self.area, self.inertia = math.pi * d**2 / 4.0, math.pi * d**4 / 64.0

    def build(self) -> None:
        """Build the whole model, the load included."""
        ops.wipe()
        ops.model("basic", "-ndm", 3, "-ndf", 6)
        self._wire()
        held = self.scene.supports.top_held
        ops.fix(0, *[1] * 6)
        ops.fix(self.top, int("ux" in held), 0, 1, 1, 1, int("rotz" in held))
        self._stiff_beam(self.last)
        self._contact()
        for place, points in amplitudes(self.scene).items():
            if self.scene.load.displacement:  # which a force along Y is controlled by
                ops.timeSeries("Linear", place)
            else:
                times, values = zip(*points, (2.0, points[-1][1]), strict=True)  # rounding leads beyond 1
                ops.timeSeries("Path", place, "-time", *times, "-values", *values)
            ops.pattern("Plain", place, place)
            ops.load(self.top, *np.eye(6)[place - 1].tolist())

    def aim(self, begin: float, end: float) -> None:
        """Make the next step lead from one time to another."""
        if self.scene.load.displacement:
            times, values = zip(*amplitudes(self.scene)[2], strict=True)
            before, after = np.interp((begin, end), times, values)
            ops.integrator("DisplacementControl", self.top, 2, after - before)
        else:
            ops.integrator("LoadControl", end - begin)

    def hold(self) -> bool:
        """Keep the pairs that touch now from sliding, and let those go that do not; whether there are any."""
        released = False
        for pair, held in self.pairs.items() if self.scene.contact.sliding == "none" else ():
            low, high = (np.add(ops.nodeCoord(node), ops.nodeDisp(node)[:3]) for node in pair)
            gap = high - low
            closed = float(np.linalg.norm(gap)) < self.scene.spring.wire_diameter
            if closed and held is None:  # springs normal to the gap, free of force now
                normal = np.cross(gap, np.eye(3)[np.argmin(np.abs(gap))])
                springs = ("-mat", TANGENTIAL, TANGENTIAL, "-dir", 2, 3, "-orient", *gap, *normal)
                self._element("zeroLength", *pair, *springs)
                self.pairs[pair] = self.elements
            elif not closed and held is not None:
                ops.remove("element", held)
                self.pairs[pair], released = None, True
        return released

    def _node(self, point: np.ndarray) -> int:
        ops.node(self.nodes, *point.tolist())
        self.nodes += 1
        return self.nodes - 1

    def _element(self, kind: str, first: int, second: int, *properties: float | str) -> None:
        self.elements += 1
        ops.element(kind, self.elements, first, second, *properties)

    def _wire(self) -> None:
        """Nodes 0 to `last` on the helix, then the reference point; straight elements between them."""
        material = self.scene.material
        for point in (*self.wire.points, self.wire.reference):
            self._node(point)
        bending = (material.E, self.area, self.inertia, self.inertia)
        ops.section("Elastic", SECTION, *bending, material.G, 2.0 * self.inertia, SHEAR_FACTOR, SHEAR_FACTOR)
        ops.beamIntegration("Legendre", RULE, SECTION, 2)
        ops.geomTransf("Corotational", WIRE, 0.0, 1.0, 0.0)  # the wire never runs along Y ...
        ops.geomTransf("Corotational", STEEP, 0.0, 0.0, 1.0)  # ... but a stiff beam may
        for node in range(self.last):
            self._element("forceBeamColumn", node, node + 1, WIRE, RULE)

    def _stiff_beam(self, node: int) -> None:
        """Tie a node to the top reference point."""
        chord = np.subtract(ops.nodeCoord(node), ops.nodeCoord(self.top))
        steep = abs(chord[1]) > 0.9 * np.linalg.norm(chord)
        material, area, inertia = self.scene.material, STIFF * self.area, STIFF * self.inertia
        properties = (area, material.E, material.G, 2.0 * inertia, inertia, inertia)
        self._element("elasticBeamColumn", self.top, node, *properties, STEEP if steep else WIRE)

    def _contact(self) -> None:
        """A truss between the centres of each pair, which are nodes of the wire or of a rigid end."""
        d, stiffness = self.scene.spring.wire_diameter, self.scene.contact.stiffness
        ops.uniaxialMaterial("Elastic", TANGENTIAL, stiffness)
        nodes = self.wire.attached.tolist()
        for index in np.unique(self.wire.pairs):
            attached = nodes[index]
            if 0 <= attached <= self.last:
                continue
            nodes[index] = self._node(self.wire.spheres[index])
            if attached < 0:
                ops.fix(nodes[index], *[1] * 6)
            else:
                self._stiff_beam(nodes[index])
        for pair in self.wire.pairs:
            lower, upper = (nodes[index] for index in pair)
            self.pairs[lower, upper] = None
            # strain is (h - rest) / rest, area 1
            rest, tag = self.wire.rest(pair), self.elements + 1
            ops.uniaxialMaterial("ElasticPPGap", tag, stiffness * rest, NEVER_YIELDS, d / rest - 1.0)
            self._element("corotTruss", lower, upper, 1.0, tag)


def tolerance(scene: Scene) -> float:
    """Energy increment below which a step has converged, N mm."""
    largest = float(np.abs(stage_ends(scene.load)).max())
    force = largest * axial_rate(scene) if scene.load.displacement else largest
    return TOLERANCE * force * scene.spring.active_height


def run(
    scene: Scene,
    steps: int,
    tolerance: float,
    halvings: int = HALVINGS,
    elements_per_turn: int = NODES_PER_TURN,
) -> PeerCurve:
    """Build the scene's model and load it in equal steps of each stage; `InputError` where it is refused.

    `tolerance`: energy increment below which a step has converged, N mm; `halvings` of one that has not.
    """
    refuse(scene, "opensees")
    builder = _Builder(scene, elements_per_turn)
    rows = scene.with_steps(steps).load.rows
    tips: list[list[float]] = []
    reactions: list[float] = []
    with quiet():
        builder.build()
        ops.constraints("Plain")
        ops.numberer("RCM")
        ops.system("SparseSYM")
        ops.test("EnergyIncr", tolerance, MOST_ITERATIONS, 0)
        ops.algorithm("Newton")
        builder.aim(0.0, 1.0 / rows)
        ops.analysis("Static")
        began, iterations = time.process_time(), 0
        for step in range(rows):
            spent = _advance(builder, step / rows, (step + 1) / rows, halvings)
            if spent is None:
                break
            iterations += spent
            tips.append([ops.nodeDisp(builder.top, dof) for dof in (1, 2, 6)])
            reactions.append(ops.getTime())
        seconds = time.process_time() - began
        ops.wipe()
    times = np.arange(1, len(tips) + 1) / rows
    reaction = np.array(reactions) if scene.load.displacement else None
    return PeerCurve("opensees", times, np.array(tips).reshape(-1, 3), seconds, iterations, reaction)


def _advance(builder: _Builder, begin: float, end: float, halvings: int) -> int | None:
    """Go on to a time, in halves where it does not converge; iterations, None where lost."""
    builder.aim(begin, end)
    if ops.analyze(1) == 0:
        spent = ops.testIter()
        if builder.hold():  # what the pairs held is left out of balance
            builder.aim(end, end)
            spent = spent + ops.testIter() if ops.analyze(1) == 0 else None
        return spent
    if halvings == 0:
        return None
    middle = 0.5 * (begin + end)
    first = _advance(builder, begin, middle, halvings - 1)
    second = None if first is None else _advance(builder, middle, end, halvings - 1)
    return None if first is None or second is None else MOST_ITERATIONS + first + second
