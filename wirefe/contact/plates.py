"""Plates on which elastic end turns rest: the elements that may touch them, and how the tips are held there.

The wire's tips are held along the plates and against turning about the plates' normal, as friction would
hold them; all else of the end turns lies on the plates, slides and lifts off. `wirefe.contact.pressing` has
the potential.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from coilspring.compiling.packing import Table, Vector, Wholes
from coilspring.scene.profile import TWO_PI
from coilspring.scene.scene import PAIRS_OF_STIFFNESS
from coilspring.scene.spring import Spring
from wirefe.contact.points import NONE
from wirefe.contact.stations import SLOPES, parts_between
from wirefe.mesh import WireMesh
from wirefe.rod import Rod

HOLD = 100.0  # stiffness of the hold at the top, over that of the wire's last element
PIECES = 8  # of an element, along each of which the gap is linear
BORDERS = PIECES + 1
TOUCHING = 1e-12  # wire diameters by which what touches at rest is pressed: more than rounding


class PlateArrays(NamedTuple):
    """Elements that may touch the plates, those at the bottom one first, and the borders of their pieces."""

    node: Wholes  # (elements,) lower node of each
    below: int  # elements at the bottom plate
    parts: Table  # (BORDERS elements, 9) what each takes of both nodes, see `wirefe.contact.stations`
    c: Vector  # (BORDERS elements,) gap at rest of what touches there, mm
    stiffness: float  # of a piece on its plate, N/mm
    tip: Vector  # (3,) from the tip to the top end at rest, mm; the tip is the last border
    hold: float  # of the tip along the plate, N/mm
    block: Wholes  # (2 (elements - below),) blocks of the couplings of nodes with the top end
    flip: Wholes

    def couplings(self, top: int) -> np.ndarray:
        """Both nodes of each element at the top plate, each with the top end."""
        nodes = self.node[self.below :, None] + np.arange(2)
        return np.stack((nodes.ravel(), np.full(nodes.size, top)), axis=1)


NO_PLATES = PlateArrays(NONE, 0, np.zeros((0, SLOPES)), np.zeros(0), 0.0, np.zeros(3), 0.0, NONE, NONE)


def place_plates(spring: Spring, mesh: WireMesh, stiffness: float, rod: Rod) -> PlateArrays:
    """Plates of a spring: the elements of each end turn and of the coil next to it may touch its plate.

    `stiffness` is that of the linear contact of a pair: as stiff along the wire as coils. The blocks are left
    empty. `rod` is its wire, joined to the top end.
    """
    step = mesh.phases[1] - mesh.phases[0]
    middles = mesh.phases[:-2] + 0.5 * step  # the last node is the top end, that before it the tip
    low = np.flatnonzero(middles < TWO_PI)
    node = np.concatenate((low, np.flatnonzero(middles > spring.phase_end - TWO_PI)))
    phases = mesh.phases[node, None] + step * np.linspace(0.0, 1.0, BORDERS)
    points = spring.points(phases.ravel())
    y = points[:, 1].reshape(phases.shape)
    rise = np.concatenate((y[: len(low)], mesh.reference[1] - y[len(low) :]))
    return NO_PLATES._replace(
        node=node,
        below=len(low),
        parts=parts_between(mesh, np.repeat(node, BORDERS), phases.ravel(), points),
        c=np.minimum(rise, 0.0).ravel() + TOUCHING * spring.wire_diameter,
        stiffness=stiffness * PAIRS_OF_STIFFNESS * step / (PIECES * TWO_PI),
        tip=-mesh.arm,
        hold=HOLD * rod.stiffness[-2, 0, 0],
    )


def join_top(rod: Rod) -> Rod:
    """The rod with its tip joined to a last node at the same point, the top end: held against turning on its
    plate, free to lift and to tilt.

    A force of the joint would act along axes half way between those of the tip and of the plate, and carry
    some of the load: so `wirefe.contact.pressing` holds the tip along the plate.
    """
    stiffness = np.zeros((1, 6, 6))
    stiffness[0, 4, 4] = HOLD * rod.stiffness[-1, 3, 3]
    upright = np.broadcast_to([1.0, 0.0, 0.0, 0.0], (1, 2, 4))
    joints = min(len(rod.second), 1)  # straight elements have no second derivatives, nor has their joint
    return Rod(
        points=np.concatenate((rod.points, rod.points[-1:])),
        triads=np.concatenate((rod.triads, upright)),
        stiffness=np.concatenate((rod.stiffness, stiffness)),
        held=np.concatenate((rod.held, np.zeros((1, 6), dtype=bool))),
        loads=np.concatenate((rod.loads, np.zeros((1, 6)))),
        second=np.concatenate((rod.second, np.zeros((joints, 6, 36)))),
    )
