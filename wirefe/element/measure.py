"""How an element is deformed, and the forces that this makes; see `wirefe.element.beam` for the symbols."""

import math
from typing import Any, NamedTuple

from coilspring.compiling.compiled import arithmetic
from wirefe.element.algebra import cross, dot, mixed, plus
from wirefe.element.lanes import (
    ENDS,
    FIRST,
    HIGH,
    LANES,
    LOW,
    SECOND,
    SPAN,
    get_four,
    get_three,
    give_ends,
    put_four,
    put_three,
    wide,
)
from wirefe.element.rotations import conjugate, half_way, stretch_functions, times, turned

# Rows of what is measured, see `wirefe.element.lanes`: half-way frame M, a quaternion; theta^2;
# `stretch_functions`; theta; u; (v, theta). Then cos a, and sin a times the axis; sin a, and a = theta/2.
TURN, SQUARE, STRETCH, ANGLE, CHORD, STRAIN = ENDS, ENDS + 4, ENDS + 5, ENDS + 10, ENDS + 13, ENDS + 16
BETWEEN, SINE, HALF = ENDS + 22, ENDS + 26, ENDS + 27
MEASURED = ENDS + 28  # rows


class Forces(NamedTuple):
    """Forces of an element, conjugate to the variations."""

    s: Any  # dU/dv
    N: Any  # to u
    m: Any  # to theta
    Pm: Any  # to w
    C: Any  # N x u, to mu
    X: Any  # theta x C


@arithmetic
def pose(table, n):
    """Pose of an element: its end frames, the second with the sign of the shorter way, the frame half way,
    and the chord there."""
    p1 = times(get_four(table, LOW, n), get_four(table, FIRST, n))
    m, p2 = half_way(p1, times(get_four(table, HIGH, n), get_four(table, SECOND, n)))
    return p1, p2, m, turned(conjugate(m), get_three(table, SPAN, n))


@arithmetic
def measure(table, state, triads, arm, begin, size):
    """Measure how `size` elements, from the one at `begin` on, are deformed; relative rotations reach to 180
    degrees."""
    for n in range(wide(size)):
        give_ends(table, n, state, triads, arm, min(begin + n, len(triads) - 1))
    for n in range(wide(size)):
        _turn(table, n)
    for n in range(wide(size)):  # the library's function takes one number
        table[LANES * HALF + n] = math.atan2(table[LANES * SINE + n], table[LANES * BETWEEN + n])
    for n in range(wide(size)):
        _deform(table, n)


@arithmetic
def _turn(table, n):
    """Relative rotation of an element's ends, and its chord."""
    p1, p2, M, u = pose(table, n)
    h = times(conjugate(p1), p2)
    put_four(table, TURN, n, M)
    put_three(table, CHORD, n, u)
    put_four(table, BETWEEN, n, h)
    table[LANES * SINE + n] = math.sqrt(h[1] * h[1] + h[2] * h[2] + h[3] * h[3])


@arithmetic
def _deform(table, n):
    """How an element is deformed, from the angle of that rotation."""
    h, sin_a, a = get_four(table, BETWEEN, n), table[LANES * SINE + n], table[LANES * HALF + n]
    twice, q = 2.0 * a / sin_a if sin_a > 0.0 else 2.0, 4.0 * a * a
    th = (twice * h[1], twice * h[2], twice * h[3])
    f = stretch_functions(q, a, sin_a, h[0])
    table[LANES * SQUARE + n] = q
    put_three(table, STRETCH, n, (f[0], f[1], f[2]))
    table[LANES * (STRETCH + 3) + n], table[LANES * (STRETCH + 4) + n] = f[3], f[4]
    put_three(table, ANGLE, n, th)
    put_three(table, STRAIN, n, stretched(q, f, th, get_three(table, CHORD, n)))
    put_three(table, STRAIN + 3, n, th)


@arithmetic
def stretched(q, f, th, x):
    """P x."""
    return mixed(1.0 + f[0] * q, x, -f[0] * dot(th, x), th)


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
