"""The equivalent beam of a scene: its data and the kernels that the path follower calls."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from coilspring.compiled import copy, entry, kernel
from coilspring.errors import InputError
from coilspring.packing import heads, table, vector
from coilspring.scene import Scene
from equivbeam.contact import circle_centre, pair_forces, pair_potential
from equivbeam.halfcoil import half_coil, haringx_stiffness, paper_matrix

BAND = 8  # half bandwidth: a pair couples nodes i and i + 2, three freedoms each
EXACT, PAPER, PRINTED = 0, 1, 2
TANGENTS = {"exact": EXACT, "paper": PAPER, "paper-printed": PRINTED}
PAIRS_PER_TURN = 2


class BeamModel(NamedTuple):
    """Arrays of one equivalent beam; node i stands at half coil i of the axis, node 0 is clamped."""

    stiffness: np.ndarray  # (elements, 3) axial, shearing, bending
    l0: float  # length of an element at rest
    force: np.ndarray  # (2,) dead load on the last node at time 1
    held: np.ndarray  # (3,) freedoms of the last node that are held: 1.0 or 0.0
    carrier: np.ndarray  # (circles,) node that carries each circle
    offset: np.ndarray  # (circles, 2) from the node to the circle's centre, at rest
    pairs: np.ndarray  # (pairs, 2) circles that may touch
    reach: float  # largest distance of a circle from its node
    d: float  # wire diameter: the distance of centres at which a pair touches
    kc: float  # penalty of a pair
    k: float  # exponent
    stick: int  # 1 where closed pairs are kept from sliding
    tangent: int  # EXACT, PAPER or PRINTED


def build_model(scene: Scene, tangent: str = "exact", sliding: str = "ignore") -> BeamModel:
    """Arrays of the equivalent beam of `scene`.

    Raises
    ------
    InputError : where the active coils are not a whole number of half coils.
    """
    spring, contact = scene.spring, scene.contact
    count = round(2 * spring.active_coils)
    if abs(2 * spring.active_coils - count) > 1e-9:
        raise InputError(
            f"spring.active_coils must be a multiple of 0.5 in [0.5, 1000] for the equivalent beam, "
            f"got {spring.active_coils!r}"
        )
    carrier, offset = _circles(scene, count)
    index = np.arange(carrier.size - 2)
    pairs = np.stack((index, index + 2), axis=1)
    # pairs within one rigid end never move against each other
    apart = carrier[pairs[:, 0]] != carrier[pairs[:, 1]]
    pairs = pairs[apart] if contact.enabled else pairs[:0]
    held = [name in scene.supports.top_held for name in ("ux", "uy", "rotz")]
    return BeamModel(
        stiffness=haringx_stiffness(spring, scene.material),
        l0=spring.active_height / count,
        force=np.array(scene.load.force),
        held=np.array(held, dtype=float),
        carrier=carrier,
        offset=offset,
        pairs=np.ascontiguousarray(pairs),
        reach=float(np.hypot(offset[:, 0], offset[:, 1]).max()),
        d=spring.wire_diameter,
        kc=contact.stiffness * 4.0 / PAIRS_PER_TURN,
        k=float(contact.exponent),
        stick=int(sliding == "scene" and contact.sliding == "none"),
        tangent=TANGENTS[tangent],
    )


def _circles(scene: Scene, count: int) -> tuple[np.ndarray, np.ndarray]:
    """Carriers and offsets of the contact circles, end turns included, from bottom to top.

    The model knows the start phase only by the side on which the wire begins.
    """
    spring = scene.spring
    ends = math.floor(2 * spring.end_turns + 1e-9)
    half = np.arange(-ends, count + ends + 1)
    phases = half * math.pi
    first = 1.0 if math.cos(spring.start_phase) >= 0.0 else -1.0
    carrier = np.clip(half, 0, count)
    side = np.where(half % 2 == 0, first, -first)
    rise = spring.height(phases) - spring.height(carrier * math.pi)
    return carrier, np.stack((side * spring.radius(phases), rise), axis=1)


def rest_state(model: BeamModel) -> np.ndarray:
    """Positions and rotations (x, y, theta) of all nodes at rest, flat."""
    nodes = model.stiffness.shape[0] + 1
    state = np.zeros((nodes, 3))
    state[:, 1] = model.l0 * np.arange(nodes)
    return state.ravel()


def load_vector(model: BeamModel) -> np.ndarray:
    """Load at time 1 on the free nodes, flat; held freedoms carry none."""
    load = np.zeros(3 * model.stiffness.shape[0])
    load[-3:-1] = model.force * (1.0 - model.held[:2])
    return load


def matrix_size(model: BeamModel) -> int:
    """Length of the banded matrix: row i holds the entries (i, i - j) at column j."""
    return 3 * model.stiffness.shape[0] * (BAND + 1)


@kernel
def view(reals, ints):
    """The model's fields, in their order, in the packed arrays."""
    head = heads(ints)
    return BeamModel(
        table(reals, head[0]), reals[head[1, 0]], vector(reals, head[2]), vector(reals, head[3]),
        vector(ints, head[4]), table(reals, head[5]), table(ints, head[6]), reals[head[7, 0]],
        reals[head[8, 0]], reals[head[9, 0]], reals[head[10, 0]], ints[head[11, 0]],
        ints[head[12, 0]],
    )  # fmt: skip


@kernel
def _add(g, H, ge, Ke, a, b):
    """Scatter the 6 freedoms of the nodes `a` < `b` (node 0 is clamped)."""
    for i in range(6):
        p = 3 * (a - 1) + i if i < 3 else 3 * (b - 1) + i - 3
        if p < 0:
            continue
        g[p] += ge[i]
        for j in range(i + 1):
            q = 3 * (a - 1) + j if j < 3 else 3 * (b - 1) + j - 3
            if q >= 0:
                H[p, p - q] += Ke[i, j]


@kernel
def centre(model, state, circle):
    """Position of a circle's centre."""
    i = 3 * model.carrier[circle]
    return circle_centre(
        state[i], state[i + 1], state[i + 2], model.offset[circle, 0], model.offset[circle, 1]
    )


@kernel
def _bound(model, a, b):
    """Bound on how far any circle's centre moved between two states."""
    most = 0.0
    for i in range(3, a.size, 3):
        way = math.hypot(a[i] - b[i], a[i + 1] - b[i + 1]) + model.reach * abs(a[i + 2] - b[i + 2])
        most = max(most, way)
    return most


@kernel
def _add_pairs(model, memory, state, g, H, ge, Ke):
    """Contact energy; adds its gradient and Hessian. Only pairs that touch are scattered."""
    energy = 0.0
    f = np.empty(2)
    Hg = np.empty((2, 2))
    for m in range(model.pairs.shape[0]):
        A, B = model.pairs[m, 0], model.pairs[m, 1]
        xa, ya = centre(model, state, A)
        xb, yb = centre(model, state, B)
        gx, gy = xb - xa, yb - ya
        h2 = gx * gx + gy * gy
        if h2 >= model.d * model.d and memory[m, 0] == 0.0:
            continue
        a, b = model.carrier[A], model.carrier[B]
        energy += pair_potential(gx, gy, math.sqrt(h2), model.d, model.kc, model.k, memory[m], f, Hg)
        pair_forces(
            f, Hg, xa - state[3 * a], ya - state[3 * a + 1], xb - state[3 * b], yb - state[3 * b + 1], ge, Ke
        )
        _add(g, H, ge, Ke, a, b)
    return energy


@entry
def assemble(reals, ints, anchor, clearance, memory, state, time, g, flat):
    """Total potential, gradient and matrix; see `coilspring.newton` for the contract."""
    model = view(reals, ints)
    H = flat.reshape((g.size, BAND + 1))
    g[:] = 0.0
    flat[:] = 0.0
    ge = np.empty(6)
    Ke = np.empty((6, 6))
    energy = 0.0
    for e in range(model.stiffness.shape[0]):
        i = 3 * e
        kax, ksh, kfl = model.stiffness[e]
        energy += half_coil(
            state[i], state[i + 1], state[i + 2], state[i + 3], state[i + 4], state[i + 5],
            kax, ksh, kfl, model.l0, ge, Ke,
        )  # fmt: skip
        if model.tangent != EXACT:
            thb = 0.5 * (state[i + 2] + state[i + 5])
            paper_matrix(thb, kax, ksh, kfl, model.l0, 12.0 if model.tangent == PAPER else 1.0, Ke)
        _add(g, H, ge, Ke, e, e + 1)
    count = model.pairs.shape[0]
    if count > 0 and 2.0 * _bound(model, anchor, state) < clearance:
        count = 0
    if count > 0:
        energy += _add_pairs(model, memory, state, g, H, ge, Ke)
    n = g.size
    g[n - 3] -= time * model.force[0]
    g[n - 2] -= time * model.force[1]
    energy -= time * (model.force[0] * state[n] + model.force[1] * (state[n + 1] - model.l0 * (n // 3)))
    for i in range(3):
        if model.held[i] > 0.0:
            _hold(g, H, n - 3 + i)
    return energy, count


@kernel
def _hold(g, H, p):
    """Take the freedom `p` out: no force, a row and column of the unit matrix."""
    g[p] = 0.0
    H[p, :] = 0.0
    for q in range(p + 1, min(p + BAND + 1, g.size)):
        H[q, q - p] = 0.0
    H[p, 0] = 1.0


@entry
def factor(reals, ints, flat):
    """Banded LDL^T in place (unit lower triangle, pivots in column 0); returns the negative pivots."""
    F = flat.reshape((flat.size // (BAND + 1), BAND + 1))
    n = F.shape[0]
    negative = 0
    for i in range(n):
        first = max(0, i - BAND)
        for j in range(first, i):
            total = F[i, i - j]
            for m in range(max(first, j - BAND), j):
                total -= F[i, i - m] * F[j, j - m]
            F[i, i - j] = total  # L[i, j] * pivot[j]
        pivot = F[i, 0]
        for j in range(first, i):
            scaled = F[i, i - j] / F[j, 0]
            pivot -= F[i, i - j] * scaled
            F[i, i - j] = scaled
        F[i, 0] = pivot
        if not pivot > 0.0:
            negative += 1
    return negative


@entry
def solve(reals, ints, flat, b):
    """Back substitution in place."""
    n = b.size
    F = flat.reshape((n, BAND + 1))
    for i in range(n):
        for j in range(max(0, i - BAND), i):
            b[i] -= F[i, i - j] * b[j]
    for i in range(n):
        b[i] /= F[i, 0]
    for i in range(n - 1, -1, -1):
        for j in range(max(0, i - BAND), i):
            b[j] -= F[i, i - j] * b[i]


@entry
def retract(reals, ints, state, step, factor, out):
    """Positions and rotations simply add."""
    copy(state, out)
    for i in range(step.size):
        out[3 + i] += factor * step[i]


@entry
def motion(reals, ints, a, b):
    """See `coilspring.newton`: bound on the way of any circle, and the largest pair motion over d."""
    model = view(reals, ints)
    most = 0.0
    for m in range(model.pairs.shape[0]):
        A, B = model.pairs[m, 0], model.pairs[m, 1]
        xa, ya = centre(model, a, A)
        xb, yb = centre(model, a, B)
        ux, uy = centre(model, b, A)
        wx, wy = centre(model, b, B)
        near = min(math.hypot(xb - xa, yb - ya), math.hypot(wx - ux, wy - uy))
        if near < 1.5 * model.d:
            most = max(most, math.hypot(wx - ux - xb + xa, wy - uy - yb + ya))
    return _bound(model, a, b), most / model.d


@entry
def commit(reals, ints, state, memory):
    """Update the contact memory with an accepted state; returns the least gap of all pairs.

    A pair that has just closed is remembered with its vector g and direction, one that has opened
    is forgotten. A remembered pair keeps the clearance at zero.
    """
    model = view(reals, ints)
    least = np.inf
    for m in range(model.pairs.shape[0]):
        xa, ya = centre(model, state, model.pairs[m, 0])
        xb, yb = centre(model, state, model.pairs[m, 1])
        gx, gy = xb - xa, yb - ya
        h = math.hypot(gx, gy)
        least = min(least, h - model.d)
        if model.stick == 0:
            continue
        if h >= model.d:
            memory[m, 0] = 0.0
        elif memory[m, 0] == 0.0:
            memory[m, 0] = 1.0
            memory[m, 1], memory[m, 2] = gx, gy
            memory[m, 3], memory[m, 4] = gx / h, gy / h
    return least
