"""Plates on which elastic end turns rest: nodes against rigid planes, and how the tips are held there.

The wire's tips are held along the plates and against turning about the plates' normal, as friction would
hold them; all else of the end turns lies on the plates, slides and lifts off.

The bottom plate is fixed, the top one moves and turns with the top end. With the normal n of a plate, its
reference point X and the vector w = X - x from a node, the gap is ``g = n . w - c``, where c makes it zero at
rest for nodes of the end turns, whose undersides are ground flat. The potential is 1/2 k g^2 where g <= 0:
plates push and do not pull, and the wire slides on them. What holds the top tip along its plate is the same
for both signs of g, with n along the plate. With n = exp(phi) n along the exponential map

    dg = n . (dX - dx) + phi . (n x w)
    d2g = 2 phi . (n x (dX - dx)) + (phi . n)(phi . w) - (n . w) phi . phi
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from coilspring.compiling.compiled import inlined
from coilspring.compiling.packing import Vector, Wholes
from coilspring.scene.profile import TWO_PI
from coilspring.scene.scene import PAIRS_OF_STIFFNESS
from coilspring.scene.spring import Spring
from wirefe.contact.points import NONE
from wirefe.element.algebra import lever, put
from wirefe.element.poses import ROW, four, three
from wirefe.element.rotations import turned
from wirefe.mesh import WHOLE, WireMesh
from wirefe.rod import Rod

HOLD = 100.0  # stiffness of the hold at the top, over that of the wire's last element
ALONG = (0, 2)  # axes of a plate along it


class PlateArrays(NamedTuple):
    """Nodes that may touch the plates."""

    low: Wholes  # nodes of the lower end
    level: Vector  # (low,) height of each where it touches, mm
    low_stiffness: Vector  # (low,) of each on its plate, N/mm
    high: Wholes  # nodes of the upper end
    depth: Vector  # (high,) c of each, mm
    high_stiffness: Vector  # (high,) as of the lower ones
    tip: Vector  # (3,) from the last of these, the tip, to the top end at rest, mm
    free: Vector  # (6,) 1 for free dofs of the top end, 0 for held ones
    hold: float  # of the tip along the plate, N/mm
    block: Wholes  # (high,) block of each node's coupling with the top end
    flip: Wholes


EMPTY = np.zeros(0)
NO_PLATES = PlateArrays(NONE, EMPTY, EMPTY, NONE, EMPTY, EMPTY, np.zeros(3), np.ones(6), 0.0, NONE, NONE)


def place_plates(spring: Spring, mesh: WireMesh, stiffness: float, rod: Rod) -> PlateArrays:
    """Plates of a spring: nodes of each end turn and of the coil next to it may touch its plate.

    `stiffness` is that of the linear contact of a pair: as stiff along the wire as coils. The blocks are left
    empty. `rod` is its wire, joined to the top end.
    """
    phases, y = mesh.phases[:-1], mesh.points[:-1, 1]  # the last node is the top end itself
    low, below = _wire_within(phases, phases[0], TWO_PI)
    high, above = _wire_within(phases, spring.phase_end - TWO_PI, phases[-1])
    top, per_radian = mesh.reference[1], stiffness * PAIRS_OF_STIFFNESS / TWO_PI
    return NO_PLATES._replace(
        low=low,
        level=np.minimum(y[low], 0.0),
        low_stiffness=per_radian * below,
        high=high,
        depth=np.minimum(top - y[high], 0.0),
        high_stiffness=per_radian * above,
        tip=-mesh.arm,
        free=(~rod.held[-1]).astype(float),
        hold=HOLD * rod.stiffness[-2, 0, 0],
    )


def _wire_within(phases: np.ndarray, begin: float, end: float) -> tuple[np.ndarray, np.ndarray]:
    """Nodes that stand for wire between two phases, and how much each: up to half way to its neighbours, rad.

    So what is at an end counts by its share, and the last digit of its phase decides nothing.
    """
    borders = np.concatenate((phases[:1], 0.5 * (phases[1:] + phases[:-1]), phases[-1:]))
    share = np.minimum(borders[1:], end) - np.maximum(borders[:-1], begin)
    nodes = np.flatnonzero(share > WHOLE * (phases[1] - phases[0]))
    return nodes, share[nodes]


def join_top(rod: Rod) -> Rod:
    """The rod with its tip joined to a last node at the same point, the top end: held against turning on its
    plate, free to lift and to tilt.

    A force of the joint would act along axes half way between those of the tip and of the plate, and carry
    some of the load: so `press_high` holds the tip along the plate.
    """
    stiffness = np.zeros((1, 6, 6))
    stiffness[0, 4, 4] = HOLD * rod.stiffness[-1, 3, 3]
    upright = np.broadcast_to([1.0, 0.0, 0.0, 0.0], (1, 2, 4))
    return Rod(
        points=np.concatenate((rod.points, rod.points[-1:])),
        triads=np.concatenate((rod.triads, upright)),
        stiffness=np.concatenate((rod.stiffness, stiffness)),
        held=np.concatenate((rod.held, np.zeros((1, 6), dtype=bool))),
        loads=np.concatenate((rod.loads, np.zeros((1, 6)))),
    )


class Gap(NamedTuple):
    """Derivatives of the gap between a node and the top plate."""

    k: float  # its stiffness
    n: Any  # (3,) normal of the plate, or an axis along it
    a: Any  # (6,) gradient at the node
    b: Any  # (6,) and at the top end
    C: Any  # (3, 3) second derivative in the spin of the top end


class Plane(NamedTuple):
    """A plane of the top end against which a node is pressed, or on which it is held."""

    axis: int  # of the top end: its normal
    level: float  # c of the node, mm
    stiffness: float  # N/mm
    pulls: bool  # for both signs of the gap


@inlined
def press_low(plates, state, g, H):
    """Potential of the bottom plate; adds its gradient and Hessian."""
    energy = 0.0
    for m in range(plates.low.size):
        node, k = plates.low[m], plates.low_stiffness[m]
        gap = state[ROW * node + 1] - plates.level[m]
        if gap > 0.0:
            continue
        energy += 0.5 * k * gap * gap
        g[6 * node + 1] += k * gap
        if len(H) > 0:
            H[node, 1, 1] += k
    return energy


@inlined
def press_high(plates, state, g, H):
    """Potential of the top plate, and of what holds the tip along it; adds its gradient and Hessian."""
    energy, last = 0.0, plates.high.size - 1
    for m in range(plates.high.size):
        energy += _press(plates, state, m, Plane(1, plates.depth[m], plates.high_stiffness[m], False), g, H)
    for axis in ALONG:
        energy += _press(plates, state, last, Plane(axis, plates.tip[axis], plates.hold, True), g, H)
    return energy


@inlined
def _press(plates, state, m, plane, g, H):
    """Potential of the node m of the top plate against a plane; adds its gradient and Hessian."""
    top, node, free, k = state.size // ROW - 1, plates.high[m], plates.free, plane.stiffness
    axis, n, w, a, b, C = np.zeros(3), np.empty(3), np.empty(3), np.zeros(6), np.empty(6), np.empty((3, 3))
    axis[plane.axis] = 1.0
    n[0], n[1], n[2] = turned(four(state, ROW * top + 3), three(axis, 0))
    gap = -plane.level
    for i in range(3):
        w[i] = state[ROW * top + i] - state[ROW * node + i]
        gap += n[i] * w[i]
    if gap > 0.0 and not plane.pulls:
        return 0.0
    for i in range(3):
        j, l = (i + 1) % 3, (i + 2) % 3  # noqa: E741
        a[i] = -n[i]
        b[i] = n[i] * free[i]
        b[3 + i] = (n[j] * w[l] - n[l] * w[j]) * free[3 + i]
    for i in range(6):
        g[6 * node + i] += k * gap * a[i]
        g[6 * top + i] += k * gap * b[i]
    if len(H) > 0:
        put(C, 0, 0, lever(three(n, 0), three(w, 0)))
        _add_hessian(plates, m, top, k * gap, Gap(k, n, a, b, C), H)
    return 0.5 * k * gap * gap


@inlined
def _add_hessian(plates, m, top, force, gap, H):
    """k dg dg^T + force d2g of the node m of the top plate."""
    node, free, (k, n, a, b, C) = plates.high[m], plates.free, gap
    B, flip = H[plates.block[m]], plates.flip[m]
    for i in range(6):
        for j in range(6):
            H[node, i, j] += k * a[i] * a[j]
            H[top, i, j] += k * b[i] * b[j]
            if flip:
                B[i, j] += k * a[i] * b[j]
            else:
                B[i, j] += k * b[i] * a[j]
    for i in range(3):
        for j in range(3):
            H[top, 3 + i, 3 + j] += force * C[i, j] * free[3 + i] * free[3 + j]
        j, l = (i + 1) % 3, (i + 2) % 3  # noqa: E741
        for axis, sign, nl in ((j, -1.0, n[l]), (l, 1.0, n[j])):  # phi_i (n_j d_l - n_l d_j)
            value = sign * nl * force * free[3 + i]
            H[top, 3 + i, axis] += value * free[axis]
            H[top, axis, 3 + i] += value * free[axis]
            if flip:
                B[axis, 3 + i] -= value
            else:
                B[3 + i, axis] -= value
