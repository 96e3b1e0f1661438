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
from wirefe.element.poses import ROW, four, pose, three
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
def _deformation(state, e, triads, arm):
    """Half-way frame of an element, turned back; half its relative rotation; chord there; arm: see `pose`."""
    p1, _, m, u, r = pose(state, e, triads, arm)
    return conjugate(m), times(conjugate(p1), m), u, r


@arithmetic
def _rates(step, e, back, h, u, r):
    """Rates of an element's deformation along a step: du and w."""
    i, j = 6 * e, 6 * e + 6
    spin1, spin2 = three(step, i + 3), three(step, j + 3)
    moved = plus(plus(three(step, j), -1.0, three(step, i)), 1.0, cross(spin2, r))
    w = turned(back, plus(spin2, -1.0, spin1))
    mean = turned(back, plus(spin1, 1.0, spin2))
    half = 0.5 / h[0]  # of h's vector: tau/2 theta, half of tan(theta/4) along the axis of theta
    slip = cross((half * h[1], half * h[2], half * h[3]), w)
    mu = (0.5 * mean[0] - slip[0], 0.5 * mean[1] - slip[1], 0.5 * mean[2] - slip[2])
    return plus(turned(back, moved), 1.0, cross(u, mu)), w


@arithmetic
def place(triads, arm, state, move, out):
    """Place all nodes in `out`, as if none were held but the first; see `beams` for `triads` and `arm`."""
    count = len(triads)
    x, q = _literal(state, move, 0)
    _put(out, 0, x, q)
    for e in range(count):
        first, second = four(triads[e, 0], 0), four(triads[e, 1], 0)
        stand = (arm[0], arm[1], arm[2]) if e == count - 1 else (0.0, 0.0, 0.0)
        back, h, u, r = _deformation(state, e, triads[e], stand)
        du, w = _rates(move.step, e, back, h, u, r)
        turn = (move.first * w[0], move.first * w[1], move.first * w[2])
        chord = plus(u, move.first, du)
        if move.second != 0.0:
            _, hb, ub, _ = _deformation(move.before, e, triads[e], stand)
            half = times(conjugate(h), hb)
            other = times(hb, conjugate(h))
            b = times(half, other)  # exp(theta) = h exp(b) h at the earlier state
            turn = plus(turn, 2.0 * move.second / b[0], (b[1], b[2], b[3]))
            chord = plus(chord, move.second, plus(ub, -1.0, u))
        # the new frames, on the end of the element before; its length kept, or rounding would grow
        p1 = times(q, first)
        t = times(times(h, (1.0, 0.5 * turn[0], 0.5 * turn[1], 0.5 * turn[2])), h)
        p2 = times(p1, unit(t[0], t[1], t[2], t[3]))
        m, _ = half_way(p1, p2)
        q = times(p2, conjugate(second))
        x = plus(x, 1.0, turned(m, chord))
        _put(out, e + 1, plus(x, -1.0, turned(q, stand)), q)


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
