"""Vectors between the circles of pairs, and their derivatives in the freedoms of the four nodes of a pair.

A circle in the plane is carried by its node, as in the paper; one beside the plane by the middle of its half
coil, and it moves out as the coil grows. With chi of the elements e, e + 1 and e + 2, of which e and e + 2
carry the circles of a pair beside the plane, and their bending dtheta, the wire there comes nearer by

    R (chi_e - 2 chi_(e+1) + chi_(e+2)) + R/pi (s dtheta)_(e+2) - R/pi (s dtheta)_e        (B14)

where s is the side of an element's lower node: the axis tilts where the axial force changes, as it does at an
end that is held, and the wire of a coil that bends lies on both sides of its axis.

Functions take the tables of the circles and of the pairs (`equivbeam.across.model`), the windings of the
elements and the places of the circles at a state, each an array: taken from a tuple it would cost as much as
what is done with it.
"""

from __future__ import annotations

import math

import numpy as np

from coilspring.compiled import clear_table, part
from equivbeam.across.model import BESIDE, BOW, FIRST, GROWS, INSIDE, LEAN, LOWER, OFFSET, RISE, SHARE
from equivbeam.halfcoil import Response, gradient, hessian, measures_at
from equivbeam.helix import winding

FREEDOMS = 12  # of the four nodes that a pair couples
# Columns of a winding: chi and rho - rho0 with their derivatives in the length, then the element's measures.
CHI, CHI_L, CHI_LL, RHO, RHO_L, RHO_LL, COS, SIN, LENGTH, SHEAR = range(10)
# Columns of a place: the centre of a circle, and the arm in the plane from what carries it.
X, Y, ACROSS, ALONG = range(4)


@part
def windings(rows, state):
    """Windings of all elements, shape (elements, 10)."""
    out = np.empty((len(rows), 10))
    for i in range(len(rows)):
        c, s, l, v, _ = measures_at(state, i)  # noqa: E741
        out[i, COS], out[i, SIN], out[i, LENGTH], out[i, SHEAR] = c, s, l, v
        out[i, CHI], out[i, CHI_L], out[i, CHI_LL], out[i, RHO], out[i, RHO_L], out[i, RHO_LL] = winding(
            rows, i, l
        )
    return out


@part
def places(node, circles, state):
    """Places of all circles, shape (circles, 4)."""
    out = np.empty((len(circles), 4))
    for k in range(len(circles)):
        p, x = 3 * node[k], circles[k, SHARE]
        out[k, X], out[k, Y], theta = state[p], state[p + 1], state[p + 2]
        if x > 0.0:
            turn = state[p + 5] - theta
            out[k, X] += x * (state[p + 3] - state[p])
            out[k, Y] += x * (state[p + 4] - state[p + 1]) + circles[k, BOW] * turn
            theta += x * turn
        c, s, inside, rise = math.cos(theta), math.sin(theta), circles[k, INSIDE], circles[k, RISE]
        out[k, ACROSS], out[k, ALONG] = c * inside - s * rise, s * inside + c * rise
        out[k, X] += out[k, ACROSS]
        out[k, Y] += out[k, ALONG]
    return out


@part
def vectors(model, state, wound):
    """Vectors between the centres of all pairs, shape (pairs, 3): across the axis, along it, out of plane."""
    circles, pairs, arm = model.circles, model.pairs, model.arm
    out = np.empty((len(pairs), 3))
    place = places(model.node, circles, state)
    for m in range(len(out)):
        way(circles, pairs, arm, wound, place, m, out[m])
    return out


@part
def way(circles, pairs, arm, wound, place, m, w):
    """Vector (3,) between the centres of the pair `m`."""
    a, b = pairs[m, LOWER], pairs[m, LOWER + 1]
    w[0] = place[b, X] - place[a, X]
    w[1] = place[b, Y] - place[a, Y]
    w[2] = circles[b, BESIDE] - circles[a, BESIDE]
    if arm[m] > 0.0:
        e, f, g = pairs[m, LEAN], pairs[m, LEAN + 1], pairs[m, LEAN + 2]
        w[1] -= arm[m] * (wound[e, CHI] - 2.0 * wound[f, CHI] + wound[g, CHI])
        w[2] += pairs[m, GROWS + 1] * wound[g, RHO] - pairs[m, GROWS] * wound[e, RHO]


@part
def derivatives(circles, pairs, arm, wound, place, m, f, J, C, g, K):
    """Rows J (3, 12) of the derivatives of `way`, and the Hessian C (12, 12), or none, of its product with f.

    `g` (6,) and `K` (6, 6), or none, are scratch.
    """
    clear_table(J)
    clear_table(C)
    for side in range(2):
        _carried(circles, pairs, place, m, side, f, J, C)
    if arm[m] > 0.0:
        for j in range(3):
            e, factor = pairs[m, LEAN + j], (2.0 if j == 1 else -1.0) * arm[m]
            _by_length(wound, e, CHI, factor, f[1], 3 * (e - pairs[m, FIRST]), J[1], C, g, K)
        for side in range(2):
            e, factor = pairs[m, LEAN + 2 * side], (2.0 * side - 1.0) * pairs[m, GROWS + side]
            if factor != 0.0:
                _by_length(wound, e, RHO, factor, f[2], 3 * (e - pairs[m, FIRST]), J[2], C, g, K)


@part
def _carried(circles, pairs, place, m, side, f, J, C):
    """What a circle moves with its nodes."""
    k, a, sign = pairs[m, LOWER + side], pairs[m, OFFSET + side], 2.0 * side - 1.0
    x, bow, across, along = circles[k, SHARE], circles[k, BOW], place[k, ACROSS], place[k, ALONG]
    for i in range(2 if x > 0.0 else 1):
        b, one = a + 3 * i, sign * (x if i == 1 else 1.0 - x)
        J[0, b] += one
        J[1, b + 1] += one
        J[0, b + 2] -= one * along
        J[1, b + 2] += one * across + sign * (2.0 * i - 1.0) * bow
    if x == 0.0 and len(C) > 0:  # beside the plane, where x > 0, there is no arm in it
        C[a + 2, a + 2] -= sign * (f[0] * across + f[1] * along)


@part
def _by_length(wound, e, column, factor, force, b, row, C, g, K):
    """What goes with a function of the length of the element `e`, whose freedoms begin at `b`."""
    c, s, l, v = wound[e, COS], wound[e, SIN], wound[e, LENGTH], wound[e, SHEAR]  # noqa: E741
    # a function of the length alone is like the energy of a half coil
    r = Response(
        0.0, factor * wound[e, column + 1], 0.0, 0.0, factor * wound[e, column + 2], 0.0, 0.0, 0.0, 0.0
    )
    gradient(r, c, s, l, v, g)
    for i in range(6):
        row[b + i] += g[i]
    if len(C) == 0:
        return
    hessian(r, c, s, l, v, K)
    for i in range(6):
        for n in range(6):
            C[b + i, b + n] += force * K[i, n]
