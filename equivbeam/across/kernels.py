"""Residual, matrix and contact of the beam in the plane across: the kernels that the path follower calls."""

from __future__ import annotations

import math

import numpy as np

from coilspring.compiled import clear, kernel, part
from coilspring.pairlaw import ON, pair_potential
from coilspring.pairvectors import approach, remember, renew_bounds
from equivbeam.across.band import ROW
from equivbeam.across.model import FIRST, view
from equivbeam.across.pairs import CHI_L, FREEDOMS, LENGTH, RHO_L, derivatives, places, vectors, way, windings
from equivbeam.band import hold
from equivbeam.halfcoil import gradient, hessian, measures_at
from equivbeam.helix import helix


@part
def _add(g, H, ge, Ke, first, count):
    """Scatter `count` freedoms from the node `first` on; node 0 is clamped."""
    p, n = 3 * (first - 1), g.size
    for i in range(count):
        if not 0 <= p + i < n:
            continue
        g[p + i] += ge[i]
        if H.shape[0] > 0:
            for j in range(i, min(count, n - p)):
                H[p + i, j - i] += Ke[i, j]


@part
def _bound(model, a, b, one, other):
    """Bound on how far any circle's centre moved between two states, from them and their windings."""
    moved = turned = drawn = 0.0
    for i in range(0, a.size, 3):
        moved = max(moved, math.sqrt((a[i] - b[i]) ** 2 + (a[i + 1] - b[i + 1]) ** 2))
        turned = max(turned, abs(a[i + 2] - b[i + 2]))
    reach = model.reach
    for e in range(len(one)):
        # rates of the radius and of the angle, which raises by twice the radius at most, grow with the length
        rate = max(one[e, CHI_L], other[e, CHI_L])
        swell = max(abs(one[e, RHO_L]), abs(other[e, RHO_L]))
        drawn = max(drawn, (swell + 2.0 * reach * rate) * abs(one[e, LENGTH] - other[e, LENGTH]))
    return moved + reach * turned + drawn


@part
def _add_pairs(model, memory, state, wound, g, H):
    """Contact energy; adds its gradient and Hessian. Only pairs that touch are scattered."""
    energy = 0.0
    w, e, f, Hg = np.empty(3), np.empty(3), np.empty(3), np.empty((3, 3))
    many = FREEDOMS if H.shape[0] > 0 else 0
    J, ge, g6 = np.empty((3, FREEDOMS)), np.empty(FREEDOMS), np.empty(6)
    C, K6 = np.empty((many, many)), np.empty((many // 2, many // 2))
    circles, pairs, arm, d = model.circles, model.pairs, model.arm, model.d
    place = places(model.node, circles, state)
    for m in range(len(pairs)):
        way(circles, pairs, arm, wound, place, m, w)
        h2 = w[0] * w[0] + w[1] * w[1] + w[2] * w[2]
        if h2 >= d * d and memory[m, ON] == 0.0:
            continue
        energy += pair_potential(w, math.sqrt(h2), d, model.kc, model.k, memory[m], e, f, Hg)
        derivatives(circles, pairs, arm, wound, place, m, f, J, C, g6, K6)
        for i in range(FREEDOMS):
            ge[i] = J[0, i] * f[0] + J[1, i] * f[1] + J[2, i] * f[2]
            for n in range(3):
                w[n] = J[0, i] * Hg[0, n] + J[1, i] * Hg[1, n] + J[2, i] * Hg[2, n]
            for j in range(many):
                C[i, j] += w[0] * J[0, j] + w[1] * J[1, j] + w[2] * J[2, j]
        _add(g, H, ge, C, pairs[m, FIRST], FREEDOMS)
    return energy


@kernel
def assemble(reals, ints, anchor, clearance, memory, state, g, flat):
    """Strain and contact energy, gradient and matrix; see `coilspring.kernelset` for the contract."""
    model = view(reals, ints)
    H = flat.reshape((flat.size // ROW, ROW))
    clear(g)
    clear(flat)
    ge, Ke = np.empty(6), np.empty((6, 6))
    energy, rows = 0.0, model.rows
    for e in range(rows.shape[0]):
        c, s, l, v, dth = measures_at(state, e)  # noqa: E741
        r = helix(rows, e, l, v, dth)
        energy += r.U
        gradient(r, c, s, l, v, ge)
        if H.shape[0] > 0:
            hessian(r, c, s, l, v, Ke)
        _add(g, H, ge, Ke, e, 6)
    count = model.pairs.shape[0]
    wound = windings(rows if count > 0 else rows[:0], state)
    if count > 0 and clearance > 0.0:
        moved = 2.0 * _bound(model, anchor, state, windings(rows, anchor), wound)
        count = 0 if moved < clearance else count
    if count > 0:
        energy += _add_pairs(model, memory, state, wound, g, H)
    for i in range(3):
        if model.held[i] > 0.0:
            hold(g, H, g.size - 3 + i)
    return energy, count


@kernel
def motion(reals, ints, a, b, least):
    """See `coilspring.kernelset`: bound on all motion, pair motion, share of the way to the first touch."""
    model = view(reals, ints)
    one, other = windings(model.rows, a), windings(model.rows, b)
    bound = _bound(model, a, b, one, other)
    if model.pairs.shape[0] == 0 or bound <= least:
        return bound, 0.0, 1.0
    most, free = approach(vectors(model, a, one), vectors(model, b, other), model.d)
    return bound, most / model.d, free


@kernel
def commit(reals, ints, state, memory):
    """See `coilspring.pairvectors.remember`."""
    model = view(reals, ints)
    between = vectors(model, state, windings(model.rows, state))
    return remember(between, memory, model.mu, model.kc, model.d)


@kernel
def renew(reals, ints, state, memory):
    """See `coilspring.pairvectors.renew_bounds`."""
    model = view(reals, ints)
    if model.mu == 0.0:
        return 0.0
    between = vectors(model, state, windings(model.rows, state))
    return renew_bounds(between, memory, model.mu, model.kc, model.k, model.d)


@kernel
def overlap(reals, ints, state):
    """See `coilspring.kernelset`: of pairs, and of those that have changed places along the axis."""
    model = view(reals, ints)
    between = vectors(model, state, windings(model.rows, state))
    whole, pairs = -np.inf, 0.0
    for m in range(len(between)):
        x, y, z = between[m, 0], between[m, 1], between[m, 2]
        depth = model.d - math.sqrt(x * x + y * y + z * z)
        pairs = max(pairs, depth)
        whole = max(whole, model.d - math.sqrt(x * x + z * z) if y < 0.0 else depth)
    return whole, whole - pairs
