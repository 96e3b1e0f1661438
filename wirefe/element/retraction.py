"""Motion of the wire along a step: its deformations change as prescribed, its shape follows from them.

A step (dx, phi) of all nodes, taken literally, would stretch the wire by squares of its rotations: the
stiffest way to deform it. Here each element's deformation follows the step instead, and the nodes are
placed one after the other, each element standing on the end of the one before. In the half-way frame M of
an element with the relative rotation exp(theta) = h h (see `wirefe.element.beam`)

    u' = u + du,   exp(theta') = h exp(w) h,   du = rho + u x mu

To first order this is the step itself, which is all that Newton's method asks of a retraction (Absil,
Mahony & Sepulchre 2008, Optimization Algorithms on Matrix Manifolds, section 4.1). What is left of second
order at a node that is held is spread over the wire since the node held before.
"""

from typing import NamedTuple

import numpy as np

from coilspring.compiling.compiled import arithmetic, clear, zeros
from wirefe.element.algebra import cross, plus
from wirefe.element.lanes import (
    ENDS,
    FIRST,
    LANES,
    SECOND,
    get_four,
    get_three,
    give_ends,
    put_four,
    put_three,
    wide,
)
from wirefe.element.measure import pose
from wirefe.element.poses import ROW, four, three
from wirefe.element.rotations import (
    conjugate,
    exponential,
    half_way,
    rotation_vector,
    small_turn,
    times,
    turned,
    unit,
)

# Rows of what a step does to an element, see `wirefe.element.lanes`: how it moves the ends apart, turns one
# against the other, and both; half the relative rotation, the chord, and how these change; as the first node
# sees them, the chord and the rotation of the second node.
MOVED, APART, BOTH, HALF, CHORD, TURN, LONGER = (
    ENDS,
    ENDS + 3,
    ENDS + 6,
    ENDS + 9,
    ENDS + 13,
    ENDS + 16,
    ENDS + 19,
)
AHEAD, ROTATION, ROWS = ENDS + 22, ENDS + 25, ENDS + 29


class Move(NamedTuple):
    """How far along a step, and along what the path since an earlier state differs from it.

    With the rate v of a deformation along the step, and b that deformation at the state `before` less the
    present one, it changes by ``first * v + second * b``.
    """

    before: np.ndarray
    step: np.ndarray
    first: float
    second: float


@arithmetic
def _put(out, n, x, q):
    """Set position and rotation of node n."""
    a = ROW * n
    out[a], out[a + 1], out[a + 2] = x
    out[a + 3], out[a + 4], out[a + 5], out[a + 6] = q


@arithmetic
def spin_between(a, b, n):
    """Rotation vector from state a to state b of node n."""
    return rotation_vector(times(four(b, ROW * n + 3), conjugate(four(a, ROW * n + 3))))


@arithmetic
def turn_along(a, b, v):
    """Turn both vectors of each node in `v` (nodes * 6,) as the node turns from state a to state b."""
    for n in range(v.size // 6):
        q = times(four(b, ROW * n + 3), conjugate(four(a, ROW * n + 3)))
        p = 6 * n
        v[p], v[p + 1], v[p + 2] = turned(q, three(v, p))
        v[p + 3], v[p + 4], v[p + 5] = turned(q, three(v, p + 3))


@arithmetic
def _literal(state, move, n):
    """Position and rotation of node n, moved by the step itself."""
    spin = three(move.step, 6 * n + 3)
    v = (move.first * spin[0], move.first * spin[1], move.first * spin[2])
    q = four(state, ROW * n + 3)
    if move.second != 0.0:
        v = plus(v, move.second, spin_between(state, move.before, n))
    t = times(exponential(v), q)
    x = three(state, ROW * n)
    if move.second != 0.0:
        x = plus(x, move.second, plus(three(move.before, ROW * n), -1.0, x))
    return plus(x, move.first, three(move.step, 6 * n)), unit(t[0], t[1], t[2], t[3])


@arithmetic
def _give_step(table, n, step, e, r):
    """Give the n-th element how a step moves its ends; `r` is its arm, see `give_ends`."""
    i, j = 6 * e, 6 * e + 6
    spin1, spin2 = three(step, i + 3), three(step, j + 3)
    put_three(table, MOVED, n, plus(plus(three(step, j), -1.0, three(step, i)), 1.0, cross(spin2, r)))
    put_three(table, APART, n, plus(spin2, -1.0, spin1))
    put_three(table, BOTH, n, plus(spin1, 1.0, spin2))


@arithmetic
def _deform(table, n, factor):
    """How an element is deformed, and how that changes by `factor` times the step: du and w."""
    p1, _, m, u = pose(table, n)
    back, h = conjugate(m), times(conjugate(p1), m)
    w, mean = turned(back, get_three(table, APART, n)), turned(back, get_three(table, BOTH, n))
    half = 0.5 / h[0]  # of h's vector: tau/2 theta, half of tan(theta/4) along the axis of theta
    slip = cross((half * h[1], half * h[2], half * h[3]), w)
    mu = (0.5 * mean[0] - slip[0], 0.5 * mean[1] - slip[1], 0.5 * mean[2] - slip[2])
    du = plus(turned(back, get_three(table, MOVED, n)), 1.0, cross(u, mu))
    put_four(table, HALF, n, h)
    put_three(table, CHORD, n, u)
    put_three(table, TURN, n, (factor * w[0], factor * w[1], factor * w[2]))
    put_three(table, LONGER, n, (factor * du[0], factor * du[1], factor * du[2]))


@arithmetic
def _bend(table, earlier, n, factor):
    """It changes further, by `factor` times the deformation at an earlier state less the present one."""
    p1, _, m, ub = pose(earlier, n)
    back, hb = conjugate(get_four(table, HALF, n)), times(conjugate(p1), m)
    b = times(times(back, hb), times(hb, back))  # exp(theta) = h exp(b) h at the earlier state
    put_three(table, TURN, n, plus(get_three(table, TURN, n), 2.0 * factor / b[0], (b[1], b[2], b[3])))
    longer = plus(ub, -1.0, get_three(table, CHORD, n))
    put_three(table, LONGER, n, plus(get_three(table, LONGER, n), factor, longer))


@arithmetic
def _look_ahead(table, n):
    """What the first node sees of the element once it is deformed."""
    h, turn = get_four(table, HALF, n), get_three(table, TURN, n)
    t = times(times(h, (1.0, 0.5 * turn[0], 0.5 * turn[1], 0.5 * turn[2])), h)
    # its length kept, or rounding would grow
    middle, q = half_way((1.0, 0.0, 0.0, 0.0), unit(t[0], t[1], t[2], t[3]))
    first, chord = (
        get_four(table, FIRST, n),
        plus(get_three(table, CHORD, n), 1.0, get_three(table, LONGER, n)),
    )
    put_three(table, AHEAD, n, turned(first, turned(middle, chord)))
    put_four(table, ROTATION, n, times(times(first, q), conjugate(get_four(table, SECOND, n))))


@arithmetic
def _near_unit(q):
    """A quaternion whose length is off from 1 by rounding: what is left is its square."""
    size = 1.5 - 0.5 * (q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3])
    return size * q[0], size * q[1], size * q[2], size * q[3]


@arithmetic
def place(triads, arm, state, move, out):
    """Place all nodes in `out`, as if none were held but the first; see `beams` for `triads` and `arm`."""
    count, bends = len(triads), move.second != 0.0
    table, earlier = np.empty(ROWS * LANES), np.empty((ENDS if bends else 0) * LANES)
    x, q = _literal(state, move, 0)
    _put(out, 0, x, q)
    for begin in range(0, count, LANES):
        size = min(LANES, count - begin)
        for n in range(wide(size)):
            e = min(begin + n, count - 1)
            r = give_ends(table, n, state, triads, arm, e)
            _give_step(table, n, move.step, e, r)
        for n in range(wide(size)):
            _deform(table, n, move.first)
        if bends:
            for n in range(wide(size)):
                give_ends(earlier, n, move.before, triads, arm, min(begin + n, count - 1))
            for n in range(wide(size)):
                _bend(table, earlier, n, move.second)
        for n in range(wide(size)):
            _look_ahead(table, n)
        for n in range(size):
            x = plus(x, 1.0, turned(q, get_three(table, AHEAD, n)))
            q = _near_unit(times(q, get_four(table, ROTATION, n)))
            _put(out, begin + n + 1, x, q)
    _put(out, count, plus(x, -1.0, turned(q, (arm[0], arm[1], arm[2]))), q)


@arithmetic
def _close(held, arm, state, move, begin, end, out):
    """Bring the held dofs (6,) of a node to where the step leaves them, and bend the wire since `begin`.

    A node with a held rotation is turned by the step itself, about the axes that are free.
    """
    count = end - begin
    target, turn = _literal(state, move, end)
    if held[3] + held[4] + held[5] > 0.0:
        v = rotation_vector(times(turn, conjugate(four(out, ROW * end + 3))))
        new = old = three(out, ROW * begin)
        for n in range(begin + 1, end + 1):
            q = four(out, ROW * n + 3)
            x = three(out, ROW * n)
            if n == end:
                x = plus(x, 1.0, turned(q, (arm[0], arm[1], arm[2])))
            new = plus(new, 1.0, turned(small_turn(v, (n - begin - 0.5) / count), plus(x, -1.0, old)))
            old = x
            _put(out, n, new, times(small_turn(v, (n - begin) / count), q))
        _put(out, end, plus(new, -1.0, turned(turn, (arm[0], arm[1], arm[2]))), turn)
    for i in range(3):
        if held[i] > 0.0:
            missing = (target[i] - out[ROW * end + i]) / count
            for n in range(begin + 1, end + 1):
                out[ROW * n + i] += (n - begin) * missing
            out[ROW * end + i] = target[i]  # to the last bit


@arithmetic
def close(dofs, arm, state, move, out):
    """Bring `dofs`, numbered 6 node + dof in rising order, to where the step leaves them."""
    held = zeros(6)
    begin, last = 0, move.step.size // 6 - 1
    none = zeros(3)
    for m in range(dofs.size):
        n = dofs[m] // 6
        held[dofs[m] % 6] = 1.0
        if m + 1 < dofs.size and dofs[m + 1] // 6 == n:
            continue
        if n > 0:
            _close(held, arm if n == last else none, state, move, begin, n, out)
        clear(held)
        begin = n
