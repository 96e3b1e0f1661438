"""The potential of plates under end turns, and of what holds the top tip along its plate.

The bottom plate is fixed, the top one moves and turns with the top end. With the normal n of a plate, its
reference point X and the vector w = X - x from a point x of the wire, the gap is ``g = n . w - c``, where c
makes it zero at rest for points of the end turns, whose undersides are ground flat. Plates push and do not
pull: the potential is the integral of 1/2 k g^2 over where g <= 0, and the wire slides on them. What holds
the tip is a spring 1/2 k g^2 for both signs of g, with n along the plate. With n = exp(phi) n along the
exponential map

    dg = n . (dX - dx) + phi . (n x w)
    d2g = 2 phi . (n x (dX - dx)) + (phi . n)(phi . w) - (n . w) phi . phi - n . d2x

with x between two nodes as in `wirefe.contact.stations`: of each a share of its place, and an arm.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from coilspring.compiling.compiled import arithmetic, clear_table, inlined
from wirefe.chain import add_block, add_gradient, add_nodes
from wirefe.contact.plates import BORDERS, PIECES
from wirefe.contact.stations import ARMS, POSITION
from wirefe.element.algebra import cross, dot, lever, mixed, plus, product, put, scaled, skew
from wirefe.element.poses import ROW, four, three, three_of
from wirefe.element.rotations import turned

ALONG = (0, 2)  # axes of a plate along it
SIZE = 18  # dofs of a gap: of both nodes, and of the top end


class Plane(NamedTuple):
    """A plane against which an element is pressed, or on which its end is held."""

    n: Any  # (3,) its normal
    X: Any  # (3,) its reference point
    top: int  # node with which it moves, or -1: it does not


class Lever(NamedTuple):
    """What a gap depends on; or sums of it over several gaps, each times a force."""

    n: Any  # (3,) normal of the plane
    one: float  # 1, or the sum of the forces
    p: float  # share of the second node
    ra: Any  # (3,) arm of the first node, as turned now
    rb: Any  # (3,) of the second
    w: Any  # (3,) from the point to the plane's reference point


class Pressure(NamedTuple):
    """Of the borders of an element's pieces."""

    gap: Any  # (n,)
    force: Any  # (n,) derivative of the energy in the gap
    own: Any  # (n,) of the force in the gap
    other: Any  # (n,) and in the next one
    L: Any  # (n, 18) gradient of the gap in both nodes and the top end


@inlined
def press(plates, chain, state, g, H):
    """Potential of the plates, and of what holds the tip along the top one; adds its gradient and Hessian."""
    energy, last, pressure = 0.0, plates.node.size - 1, _no_pressure()
    for m in range(plates.node.size):
        plane = _plate(plates, state, m)
        if _fill_gaps(plates, state, m, plane, pressure) < 0.0:
            energy += _push(plates.stiffness, pressure)
            _add(plates, chain, state, m, plane, pressure, g, H)
    for axis in ALONG:
        plane = _moving(state, (1.0 - 0.5 * axis, 0.0, 0.5 * axis))
        gap = dot(plane.n, _lever(plates, state, last, PIECES, plane).w) - plates.tip[axis]
        _clear(pressure)
        pressure.force[PIECES], pressure.own[PIECES] = plates.hold * gap, plates.hold
        energy += 0.5 * plates.hold * gap * gap
        _add(plates, chain, state, last, plane, pressure, g, H)
    return energy


@inlined
def fill_loads(plates, state, loads):
    """Fill forces and moments of the plates on both nodes of each border, (borders, 12)."""
    clear_table(loads)
    pressure = _no_pressure()
    for m in range(plates.node.size):
        plane = _plate(plates, state, m)
        if _fill_gaps(plates, state, m, plane, pressure) < 0.0:
            _push(plates.stiffness, pressure)
            for i in range(BORDERS):
                _put_gradient(_lever(plates, state, m, i, plane), pressure.L[i])
                for j in range(12):
                    loads[BORDERS * m + i, j] = -pressure.force[i] * pressure.L[i, j]


@arithmetic
def _no_pressure():
    """Room for the pressure on an element."""
    row = np.empty((4, BORDERS))
    return Pressure(row[0], row[1], row[2], row[3], np.empty((BORDERS, SIZE)))


@arithmetic
def _moving(state, axis):
    """The plane across an axis of the top end."""
    top = state.size // ROW - 1
    return Plane(turned(four(state, ROW * top + 3), axis), three(state, ROW * top), top)


@arithmetic
def _plate(plates, state, m):
    """The plate against which the element m is pressed."""
    if m < plates.below:
        return Plane((0.0, -1.0, 0.0), (0.0, 0.0, 0.0), -1)
    return _moving(state, (0.0, 1.0, 0.0))


@arithmetic
def _fill_gaps(plates, state, m, plane, pressure):
    """Fill the gaps of the element m; returns the least one, 0 at most."""
    least = 0.0
    for i in range(BORDERS):
        pressure.gap[i] = dot(plane.n, _lever(plates, state, m, i, plane).w) - plates.c[BORDERS * m + i]
        least = min(least, pressure.gap[i])
    return least


@arithmetic
def _clear(pressure):
    """No forces."""
    for i in range(BORDERS):
        pressure.force[i] = pressure.own[i] = pressure.other[i] = 0.0


@arithmetic
def _lever(plates, state, m, i, plane):
    """What the gap of the border i of the element m depends on."""
    a, row = ROW * plates.node[m], BORDERS * m + i
    p = plates.parts[row, POSITION]
    ra = turned(four(state, a + 3), three_of(plates.parts, row, ARMS))
    rb = turned(four(state, a + ROW + 3), three_of(plates.parts, row, ARMS + 3))
    x = plus(mixed(1.0 - p, three(state, a), p, three(state, a + ROW)), 1.0, plus(ra, 1.0, rb))
    return Lever(plane.n, 1.0, p, ra, rb, plus(plane.X, -1.0, x))


@arithmetic
def _push(k, pressure):
    """Energy of a penalty k of pieces; fills the forces on their borders.

    Along a piece the gap is linear, and 1/2 k g^2 is integrated where it is below 0.
    """
    energy, k = 0.0, k / 6.0
    _clear(pressure)
    for i in range(PIECES):
        a, b = pressure.gap[i], pressure.gap[i + 1]
        if min(a, b) >= 0.0:
            continue
        if max(a, b) <= 0.0:
            energy += k * (a * a + a * b + b * b)
            fa, fb, kaa, kab, kbb = 2.0 * a + b, a + 2.0 * b, 2.0, 1.0, 2.0
        else:
            a, b = min(a, b), max(a, b)
            s = a / (a - b)  # share of the piece that is pressed
            energy += k * a * a * s
            fa, fb, kab = a * s * (3.0 - s), a * s * s, s * s * (3.0 - 2.0 * s)
            kaa, kbb = s * (6.0 - 6.0 * s + 2.0 * s * s), 2.0 * s**3
            if a != pressure.gap[i]:
                fa, fb, kaa, kbb = fb, fa, kbb, kaa
        pressure.force[i] += k * fa
        pressure.force[i + 1] += k * fb
        pressure.own[i] += k * kaa
        pressure.own[i + 1] += k * kbb
        pressure.other[i] = k * kab
    return energy


@arithmetic
def _add(plates, chain, state, m, plane, pressure, g, H):
    """Add gradient and Hessian of the forces on the borders of the element m."""
    one, p, ra, rb, w = 0.0, 0.0, (0.0, 0.0, 0.0), (0.0, 0.0, 0.0), (0.0, 0.0, 0.0)
    for i in range(BORDERS):
        if pressure.own[i] != 0.0:
            f, at = pressure.force[i], _lever(plates, state, m, i, plane)
            _put_gradient(at, pressure.L[i])
            one, p, w = one + f, p + f * at.p, plus(w, f, at.w)
            ra, rb = plus(ra, f, at.ra), plus(rb, f, at.rb)
    total, G, a = Lever(plane.n, one, p, ra, rb, w), np.empty(SIZE), plates.node[m]
    _put_gradient(total, G)
    add_gradient(g, a, a + 1, G)
    if plane.top >= 0:
        for i in range(6):
            g[6 * plane.top + i] += G[12 + i]
    if len(H) == 0:
        return
    K = np.zeros((SIZE, SIZE))
    _put_levers(total, K)
    _add_products(pressure, K, SIZE if plane.top >= 0 else 12)
    add_nodes(H, a, a + 1, K)
    add_block(H, chain.block[a], chain.flip[a], K)
    if plane.top >= 0:
        _add_top(plates, m, plane.top, K, H)


@arithmetic
def _put_gradient(at, L):
    """Gradient (18,) of the gap in both nodes and the top end."""
    n, a = at.n, at.p - at.one
    L[0], L[1], L[2] = a * n[0], a * n[1], a * n[2]
    L[3], L[4], L[5] = cross(n, at.ra)
    L[6], L[7], L[8] = -at.p * n[0], -at.p * n[1], -at.p * n[2]
    L[9], L[10], L[11] = cross(n, at.rb)
    L[12], L[13], L[14] = at.one * n[0], at.one * n[1], at.one * n[2]
    L[15], L[16], L[17] = cross(n, at.w)


@arithmetic
def _put_levers(at, K):
    """Put the second derivative of the gap into K (18, 18)."""
    N, down = skew(at.n, 1.0), (-at.n[0], -at.n[1], -at.n[2])
    put(K, 3, 3, lever(down, at.ra))
    put(K, 9, 9, lever(down, at.rb))
    put(K, 15, 15, lever(at.n, at.w))
    put(K, 15, 0, scaled(at.p - at.one, N))
    put(K, 15, 3, product(N, skew(at.ra, 1.0)))
    put(K, 15, 6, scaled(-at.p, N))
    put(K, 15, 9, product(N, skew(at.rb, 1.0)))
    put(K, 15, 12, scaled(at.one, N))


@arithmetic
def _add_products(pressure, K, size):
    """Add the products of the gradients of borders, each with itself and with the next one."""
    L = pressure.L
    for n in range(BORDERS):
        own, other = pressure.own[n], pressure.other[n]
        if own != 0.0:
            for i in range(size):
                for j in range(size):
                    K[i, j] += own * L[n, i] * L[n, j]
        if other != 0.0:
            for i in range(size):
                for j in range(size):
                    K[i, j] += other * (L[n, i] * L[n + 1, j] + L[n + 1, i] * L[n, j])


@arithmetic
def _add_top(plates, m, top, K, H):
    """Add what K (18, 18) of the element m has of the top end: its own block, and those with both nodes."""
    for i in range(6):
        for j in range(6):
            H[top, i, j] += K[12 + i, 12 + j]
            for s in range(2):
                at = 2 * (m - plates.below) + s
                H[plates.block[at], i, j] += K[6 * s + i, 12 + j] if plates.flip[at] else K[12 + i, 6 * s + j]
