"""Curved pieces of wire: how they deform under forces at their ends, to second order.

A strain of the section at s makes the twist b(s), a motion (dx, spin) of the second end. With B(s) what the
sections before s add up to, all strains together move it by

    X = int b ds + 1/2 int [B, b] ds + ...

(Magnus 1954, Comm. Pure Appl. Math. 7, 649; [ , ] of two twists). The deformation e, see
`wirefe.element.beam`, is that of a strain which is constant along the piece: with the twists c of a unit of
each, and C = int c ds,

    X = C e + 1/2 int [int c e, c e] ds + ...

Let eta be the amplitudes of the strains that the wrenches w = F^-1 C eta at the second end make in the linear
piece, b = f w and F = int f ds. Then

    e = eta + 1/2 Q(eta, eta) + ...,   Q(eta, eta) = C^-1 int ([B, b] - [int c eta, c eta]) ds

and their energy is 1/2 eta^T K eta, K = C^T F^-1 C. To the third order it is the least of all strains that
make e: a correction of the strains of second order changes it in the fourth.
"""

import numpy as np

from coilspring.compiling.compiled import arithmetic, kernel
from wirefe.element.algebra import cross, plus, transposed
from wirefe.element.poses import four, three
from wirefe.element.rotations import exponential, matrix, times, turned


def _quadrature(count: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Gauss points of 0..1, their weights, and what integrals up to each take of values times weights."""
    legendre = np.polynomial.legendre
    nodes, weights = legendre.leggauss(count)
    primitives = legendre.legval(nodes, legendre.legint(np.eye(count), lbnd=-1)).T
    upto = primitives @ np.linalg.inv(legendre.legvander(nodes, count - 1)) / weights
    return 0.5 * (1.0 + nodes), 0.5 * weights, upto


# Up to a quarter of a turn K is exact to rounding, Q to 1e-10.
POINTS, WEIGHTS, UPTO = _quadrature(8)


@kernel
def constant_strain_twists(triads, e0, points, weights, upto, twists):
    """Twists (n, q, 6, 6) of sections by a unit of each constant strain; `triads` and `e0` as in `beams`."""
    turns, steps = np.empty((len(points), 4)), np.empty((len(points), 3))
    for n in range(len(triads)):
        first, v, theta = four(triads[n, 0], 0), three(e0[n], 0), three(e0[n], 3)
        for q in range(len(points)):
            t = times(first, exponential((points[q] * theta[0], points[q] * theta[1], points[q] * theta[2])))
            turns[q, 0], turns[q, 1], turns[q, 2], turns[q, 3] = t
            steps[q, 0], steps[q, 1], steps[q, 2] = turned(t, v)
        for q in range(len(points)):
            lever = (0.0, 0.0, 0.0)  # from the section to the second end
            for p in range(len(points)):
                lever = plus(lever, weights[p] * (1.0 - upto[q, p]), three(steps[p], 0))
            axes = transposed(matrix(four(turns[q], 0)))
            for j in range(3):
                axis = (axes[3 * j], axes[3 * j + 1], axes[3 * j + 2])
                moved = cross(axis, lever)
                for i in range(3):
                    twists[n, q, i, j], twists[n, q, 3 + i, j] = axis[i], 0.0
                    twists[n, q, i, 3 + j], twists[n, q, 3 + i, 3 + j] = moved[i], axis[i]


@arithmetic
def _add_commutators(twists, weights, upto, sign, before, total):
    """Add sign * int [B, b] ds of all pairs of columns to `total` (6, 6, 6), the twist first."""
    for q in range(len(twists)):
        for i in range(6):
            for j in range(6):
                before[i, j] = 0.0
        for p in range(len(twists)):
            share = upto[q, p] * weights[p]
            for i in range(6):
                for j in range(6):
                    before[i, j] += share * twists[p, i, j]
        b, share = twists[q], sign * weights[q]
        for i in range(6):
            v, o = (before[0, i], before[1, i], before[2, i]), (before[3, i], before[4, i], before[5, i])
            for j in range(6):
                spin = (b[3, j], b[4, j], b[5, j])
                x = plus(cross(o, (b[0, j], b[1, j], b[2, j])), 1.0, cross(v, spin))
                y = cross(o, spin)
                for k in range(3):
                    total[k, i, j] += share * x[k]
                    total[3 + k, i, j] += share * y[k]


@kernel
def second_order(twists, lengths, constant, weights, upto, inverse, Q):
    """Second derivatives Q (n, 6, 36) of e in the amplitudes of the strains that a unit of each makes.

    Parameters
    ----------
    twists, constant : (n, q, 6, 6) per length by the wrenches of a unit of each deformation, and per element
        by a unit of each constant strain.
    lengths : (n, q) of wire that the points stand for; weights : (q,) the same of 0..1.
    upto : (q, q) by which both are multiplied in integrals from the start to each point.
    inverse : (n, 6, 6) deformation by a unit of each motion of the second end.
    """
    before, total = np.empty((6, 6)), np.empty((6, 6, 6))
    for n in range(len(Q)):
        for k in range(6):
            for m in range(36):
                total[k, m // 6, m % 6] = 0.0
        _add_commutators(twists[n], lengths[n], upto, 0.5, before, total)
        _add_commutators(constant[n], weights, upto, -0.5, before, total)
        for c in range(6):
            for i in range(6):
                for j in range(6):
                    found = 0.0
                    for k in range(6):
                        found += inverse[n, c, k] * (total[k, i, j] + total[k, j, i])
                    Q[n, c, 6 * i + j] = found
