"""How an element is deformed, and the forces that this makes; see `wirefe.element.beam` for the symbols."""

import math
from typing import Any, NamedTuple

from coilspring.compiling.compiled import arithmetic
from wirefe.element.algebra import cross, dot, mixed, plus
from wirefe.element.poses import pose, three
from wirefe.element.rotations import conjugate, stretch_functions, times


class Strain(NamedTuple):
    """How an element is deformed; vectors and matrices are tuples, which stay in registers."""

    M: Any  # half-way frame, a quaternion
    q: Any  # theta^2
    f: Any  # `stretch_functions`
    th: Any  # theta
    u: Any


class Forces(NamedTuple):
    """Forces of an element, conjugate to the variations."""

    s: Any  # dU/dv
    N: Any  # to u
    m: Any  # to theta
    Pm: Any  # to w
    C: Any  # N x u, to mu
    X: Any  # theta x C


@arithmetic
def strain(state, n, triads, arm):
    """`Strain` of the n-th element; relative rotations reach to 180 degrees.

    The wire's end stands off from the last node by `arm`.
    """
    last = n == len(triads) - 1
    p1, p2, M, u, _ = pose(state, n, triads[n], three(arm, 0) if last else (0.0, 0.0, 0.0))
    # cos a, and sin a times the axis, which is the same in R1, M and R2; a = theta/2
    h = times(conjugate(p1), p2)
    sin_a = math.sqrt(h[1] * h[1] + h[2] * h[2] + h[3] * h[3])
    a = math.atan2(sin_a, h[0])
    twice = 2.0 * a / sin_a if sin_a > 0.0 else 2.0
    q = 4.0 * a * a
    th = (twice * h[1], twice * h[2], twice * h[3])
    return Strain(M, q, stretch_functions(q, a, sin_a, h[0]), th, u)


@arithmetic
def stretched(q, f, th, x):
    """P x."""
    return mixed(1.0 + f[0] * q, x, -f[0] * dot(th, x), th)


@arithmetic
def deformed(q, f, th, u, e0):
    """e of one element."""
    v = stretched(q, f, th, u)
    return v[0] - e0[0], v[1] - e0[1], v[2] - e0[2], th[0] - e0[3], th[1] - e0[4], th[2] - e0[5]


@arithmetic
def forces(q, f, th, u, s, y):
    """`Forces` of one element from dU/dv and dU/dtheta."""
    c, c1 = f[0], f[1]
    al, al1 = 1.0 + c * q, c1 * q + c
    A, B, S = dot(th, s), dot(th, u), dot(s, u)
    m = plus(y, 2.0 * (al1 * S - c1 * A * B), th)
    m = plus(m, -c, mixed(B, s, A, u))
    N = mixed(al, s, -c * A, th)
    C = cross(N, u)
    return Forces(s, N, m, stretched(q, f, th, m), C, cross(th, C))
