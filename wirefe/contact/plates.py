"""Plates on which elastic end turns rest: the nodes that may touch them, and how the tips are held there.

The wire's tips are held along the plates and against turning about the plates' normal, as friction would
hold them; all else of the end turns lies on the plates, slides and lifts off.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from coilspring.scene.spring import Spring
from wirefe.contact.points import PAIRS_OF_PENALTY
from wirefe.mesh import TWO_PI, WireMesh
from wirefe.rod import Rod

JOINT = 100.0  # stiffness of the hold at the top, over that of the wire's last element


class PlateArrays(NamedTuple):
    """Nodes that may touch the plates."""

    low: np.ndarray  # nodes of the lower end
    level: np.ndarray  # (low,) height of each where it touches, mm
    high: np.ndarray  # nodes of the upper end
    depth: np.ndarray  # (high,) c of each, mm
    free: np.ndarray  # (6,) 1 for free dofs of the top end, 0 for held ones
    stiffness: float  # of a node on a plate, N/mm
    block: np.ndarray  # (high,) block of each node's coupling with the top end
    flip: np.ndarray


NO_NODES = np.zeros(0, dtype=np.int64)
NO_PLATES = PlateArrays(NO_NODES, np.zeros(0), NO_NODES, np.zeros(0), np.ones(6), 0.0, NO_NODES, NO_NODES)


def place_plates(spring: Spring, mesh: WireMesh, stiffness: float, free: np.ndarray) -> PlateArrays:
    """Plates of a spring: nodes of each end turn and of the coil next to it may touch its plate.

    `stiffness` is that of the linear contact of a pair: as stiff along the wire as coils. The blocks are
    left empty.
    """
    phases, y = mesh.phases[:-1], mesh.points[:-1, 1]  # the last node is the top end itself
    low = np.flatnonzero(phases < TWO_PI)
    high = np.flatnonzero(phases > spring.phase_end - TWO_PI)
    top = mesh.reference[1]
    per_node = stiffness * PAIRS_OF_PENALTY * (phases[1] - phases[0]) / TWO_PI
    return NO_PLATES._replace(
        low=low,
        level=np.minimum(y[low], 0.0),
        high=high,
        depth=np.minimum(top - y[high], 0.0),
        free=free.astype(float),
        stiffness=per_node,
    )


def join_top(rod: Rod) -> Rod:
    """The rod with its tip joined to a last node at the same point, the top end: held along its plate and
    against turning on it, free to lift and to tilt."""
    stiffness = np.zeros((1, 6, 6))
    for dof in (0, 2, 4):  # x, z, and the turn about y
        stiffness[0, dof, dof] = JOINT * rod.stiffness[-1, dof // 3 * 3, dof // 3 * 3]
    upright = np.broadcast_to([1.0, 0.0, 0.0, 0.0], (1, 2, 4))
    return Rod(
        points=np.concatenate((rod.points, rod.points[-1:])),
        triads=np.concatenate((rod.triads, upright)),
        stiffness=np.concatenate((rod.stiffness, stiffness)),
        held=np.concatenate((rod.held, np.zeros((1, 6), dtype=bool))),
        loads=np.concatenate((rod.loads, np.zeros((1, 6)))),
    )
