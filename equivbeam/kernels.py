"""Residual, matrix and motion of the equivalent beam: the kernels that the path follower calls."""

import math
from functools import cache

import numpy as np

from coilspring.compiling.compiled import clear, copy, inlined, kernel, lent, shaped
from coilspring.contact.kinematics import approach, spheres
from coilspring.contact.law import pair_potential
from coilspring.contact.pairs import accept, update
from coilspring.contact.rates import length_gradient as gradient_of_length
from coilspring.contact.rates import pair_rate
from equivbeam.band import ROW, fix
from equivbeam.band import factor as factor
from equivbeam.band import solve as solve
from equivbeam.contact import circle_centre, circle_overlap, pair_forces
from equivbeam.element import gradient, hessian, measures_at, paper_matrix
from equivbeam.laws import response
from equivbeam.laws.haringx import KAX, KFL, KSH, L0
from equivbeam.model import view
from equivbeam.options import EXACT, PAPER


@inlined
def _add_nodes(g, H, ge, Ke, a, b):
    """Scatter the 6 degrees of freedom of the nodes `a` <= `b`; node 0 is clamped."""
    p, q = 3 * (a - 1), 3 * (b - 1)
    if a > 0:
        for i in range(3):
            g[p + i] += ge[i]
    for i in range(3):
        g[q + i] += ge[3 + i]
    if H.shape[0] == 0:
        return
    if a > 0:
        for i in range(3):
            for j in range(i, 3):
                H[p + i, j - i] += Ke[i, j]
            for j in range(3):
                H[p + i, q - p + j - i] += Ke[i, 3 + j]
    for i in range(3):
        for j in range(i, 3):
            H[q + i, j - i] += Ke[3 + i, 3 + j]


@inlined
def _centres(model, state):
    """Centres of all circles, shape (circles, 2)."""
    attached, offset = model.attached, model.offset
    c = np.empty((attached.size, 2))
    for k in range(attached.size):
        i = 3 * attached[k]
        c[k, 0], c[k, 1] = circle_centre(state[i], state[i + 1], state[i + 2], offset[k, 0], offset[k, 1])
    return c


@inlined
def _arm(model, state, k):
    """From a circle's node to its centre, as turned now."""
    theta = state[3 * model.attached[k] + 2]
    return circle_centre(0.0, 0.0, theta, model.offset[k, 0], model.offset[k, 1])


@inlined
def _vectors(model, state):
    """Vectors between the centres of all pairs, in the working plane, shape (pairs, 3)."""
    c, pairs = _centres(model, state), model.pairs
    w = np.empty((pairs.shape[0], 3))
    for m in range(pairs.shape[0]):
        A, B = pairs[m, 0], pairs[m, 1]
        w[m, 0], w[m, 1], w[m, 2] = c[B, 0] - c[A, 0], c[B, 1] - c[A, 1], 0.0
    return w


@inlined
def _bound(reach, a, b):
    """Bound on how far any circle's centre moved between two states."""
    most = 0.0
    for i in range(3, a.size, 3):
        moved = math.sqrt((a[i] - b[i]) ** 2 + (a[i + 1] - b[i + 1]) ** 2)
        most = max(most, moved + reach * abs(a[i + 2] - b[i + 2]))
    return most


@inlined
def _add_pairs(model, history, state, g, H, ge, Ke):
    """Contact energy; adds its gradient and Hessian. Only pairs that touch are scattered."""
    energy = 0.0
    w, e, f = np.empty(3), np.empty(3), np.empty(3)
    Hg = np.empty((3, 3))
    c, pairs, attached = _centres(model, state), model.pairs, model.attached
    for m in range(pairs.shape[0]):
        A, B = pairs[m, 0], pairs[m, 1]
        w[0], w[1], w[2] = c[B, 0] - c[A, 0], c[B, 1] - c[A, 1], 0.0
        h2 = w[0] * w[0] + w[1] * w[1]
        if h2 >= model.d * model.d and not history[m].closed:
            continue
        a, b = attached[A], attached[B]
        energy += pair_potential(w, math.sqrt(h2), model, history[m], e, f, Hg)
        p, q = 3 * a, 3 * b
        ax, ay = c[A, 0] - state[p], c[A, 1] - state[p + 1]
        bx, by = c[B, 0] - state[q], c[B, 1] - state[q + 1]
        pair_forces(f, Hg, ax, ay, bx, by, ge, Ke)
        _add_nodes(g, H, ge, Ke, a, b)
    return energy


@cache
def assembled(response):
    """The kernel `assemble` with a law, given by its response; see `equivbeam.laws.response`."""

    def assemble(reals, ints, accepted, least_gap, history, state, g, flat):
        """Strain and contact energy, gradient and matrix; see `coilspring.solver.interface`."""
        accepted, history, state, g = lent(accepted), lent(history), lent(state), lent(g)
        model, H = view(reals, ints), shaped(flat, (flat.size // ROW, ROW))
        clear(g)
        clear(flat)
        ge = np.empty(6)
        Ke = np.empty((6, 6))
        energy = 0.0
        law, rows = model.law, model.rows  # once: an array taken from the tuple costs as much as the law
        for e in range(rows.shape[0]):
            c, s, l, v, dth = measures_at(state, e)  # noqa: E741
            r = response(law, rows, e, l, v, dth)
            energy += r.U
            gradient(r, c, s, l, v, ge)
            if H.shape[0] > 0 and model.tangent == EXACT:
                hessian(r, c, s, l, v, Ke)
            elif H.shape[0] > 0:
                factor = 12.0 if model.tangent == PAPER else 1.0
                paper_matrix(c, s, rows[e, KAX], rows[e, KSH], rows[e, KFL], rows[e, L0], factor, Ke)
            _add_nodes(g, H, ge, Ke, e, e + 1)
        count = model.pairs.shape[0]
        if count > 0 and least_gap > 0.0 and 2.0 * _bound(model.reach, accepted, state) < least_gap:
            count = 0
        if count > 0:
            energy += _add_pairs(model, history, state, g, H, ge, Ke)
        n = g.size
        for i in range(3):
            if model.fixed[i] > 0.0:
                fix(g, H, n - 3 + i)
        return energy, count

    assemble.__qualname__ = f"assemble_{response.__name__}"  # compiled code knows laws apart by it
    return kernel(assemble)


assemble = assembled(response)


def assemble_of(law, columns):
    """The kernel for a law by its name, or for a `UserLaw` whose table of parameters has so many columns."""
    return assemble if isinstance(law, str) else assembled(law.response(columns))


@kernel
def retract(reals, ints, state, step, factor, before, second, out):
    """See `coilspring.solver.interface`: positions and rotations simply add."""
    copy(state, out)
    for i in range(step.size):
        out[3 + i] += factor * step[i] + second * (before[3 + i] - state[3 + i])


@kernel
def work(reals, ints, load, a, b):
    """Work of a dead load between two states."""
    total = 0.0
    for i in range(load.size):
        total += load[i] * (b[3 + i] - a[3 + i])
    return total


@kernel
def rotate(reals, ints, a, b, v):
    """See `coilspring.solver.interface`: nothing, as half coils are nearly as stiff in all directions."""


@kernel
def displacement_bound(reals, ints, a, b, least):
    """See `coilspring.solver.interface`: bound on all motion, pair motion, share until the first touch."""
    model = view(reals, ints)
    bound = _bound(model.reach, a, b)
    if model.pairs.shape[0] == 0 or bound <= least:
        return bound, 0.0, 1.0
    most, free = approach(_vectors(model, a), _vectors(model, b), model.d, model.mu)
    return bound, most / model.d, free


@kernel
def update_history(reals, ints, state, history):
    """See `coilspring.contact.pairs.accept`."""
    model = view(reals, ints)
    if model.pairs.shape[0] == 0:
        return np.inf
    return accept(spheres(), model, _vectors(model, state), history)


@kernel
def update_pairs(reals, ints, accepted, predicted, state, history):
    """See `coilspring.contact.pairs.update`."""
    model = view(reals, ints)
    if model.mu == 0.0:
        return 0.0
    places = _vectors(model, accepted), _vectors(model, predicted), _vectors(model, state)
    return update(spheres(), model, places, history)


@kernel
def pair_rates(reals, ints, state, motion, history, rates):
    """See `coilspring.solver.interface`."""
    model = view(reals, ints)
    w, t, dw = _vectors(model, state), np.empty(3), np.zeros(3)
    for m in range(rates.shape[0]):
        dw[0], dw[1] = 0.0, 0.0
        for side in range(2):
            x, y = _arm(model, state, model.pairs[m, side])
            p, sign = 3 * (model.attached[model.pairs[m, side]] - 1), 2.0 * side - 1.0
            if p >= 0:
                dw[0] += sign * (motion[p] - y * motion[p + 2])
                dw[1] += sign * (motion[p + 1] + x * motion[p + 2])
        pair_rate(w[m], dw, history[m], model, t, rates[m])


@kernel
def length_gradient(reals, ints, state, history, pair, g):
    """See `coilspring.solver.interface`."""
    model, w, t = view(reals, ints), np.zeros(3), np.empty(3)
    clear(g)
    for side in range(2):
        x, y = _arm(model, state, model.pairs[pair, side])
        n, sign = 3 * model.attached[model.pairs[pair, side]], 2.0 * side - 1.0
        w[0] += sign * (state[n] + x)
        w[1] += sign * (state[n + 1] + y)
    length = gradient_of_length(w, math.sqrt(w[0] ** 2 + w[1] ** 2), history[pair], model, t)
    for side in range(2):
        x, y = _arm(model, state, model.pairs[pair, side])
        p, sign = 3 * (model.attached[model.pairs[pair, side]] - 1), 2.0 * side - 1.0
        if p >= 0:
            g[p] += sign * t[0]
            g[p + 1] += sign * t[1]
            g[p + 2] += sign * (x * t[1] - y * t[0])
    for i in range(3):
        if model.fixed[i] > 0.0:
            g[g.size - 3 + i] = 0.0
    return length


@kernel
def overlap(reals, ints, state):
    """See `coilspring.solver.interface`: of all circles, and beyond the deepest pair."""
    model = view(reals, ints)
    return circle_overlap(_centres(model, state), model.attached, state, model.d)
