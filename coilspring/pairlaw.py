"""Penalty contact of a pair: one law for both models.

With the centres of a pair, g = cB - cA and h = |g|, the potential is ``K max(0, d - h)^(k+1)/(k+1)``.
Where sliding is off, a closed pair also has ``1/2 K |e|^2`` with ``e = (I - n0 n0^T)(g - g0)``, g0 and n0
being the vector and its direction at the end of the substep in which the pair closed.

With Coulomb friction the tangential force K |e| is bounded by ``mu F``: return mapping (Simo & Hughes
1998, Computational Inelasticity, chapter 2). Within a substep the bound is a number (Tresca's law), so
that the pair keeps a potential, K |e|^2 / 2 up to the bound and linear beyond; the path follower renews
the bound until it is that of the normal force. What slid is taken off e when the substep is accepted.
"""

from __future__ import annotations

import math

import numpy as np

from coilspring.compiled import clear, clear_table, part
from coilspring.path import Friction

# A pair's row of the contact memory: whether it is held, g0 (3), n0 (3), the bound of its tangential
# force, the length it has slid, and the work that friction has taken.
ON, G0, N0, BOUND, SLID, WORK = 0, 1, 4, 7, 8, 9
MEMORY = 10


@part
def stretch(g, row, e):
    """Tangential vector e = (I - n0 n0^T)(g - g0) of a held pair; returns its length."""
    along, square = 0.0, 0.0
    for i in range(3):
        along += row[N0 + i] * (g[i] - row[G0 + i])
    for i in range(3):
        e[i] = g[i] - row[G0 + i] - along * row[N0 + i]
        square += e[i] * e[i]
    return math.sqrt(square)


@part
def hold(g, h, K, row, e):
    """Update a pair's memory where it touches at the end of a substep.

    A new pair is remembered as it is. One that slid keeps the stretch that its bound allows, turned
    into its present tangent plane.
    """
    if row[ON] == 0.0:
        for i in range(3):
            row[G0 + i] = g[i]
            row[N0 + i] = g[i] / h
        row[ON], row[BOUND], row[SLID], row[WORK] = 1.0, math.inf, 0.0, 0.0
        return
    length = stretch(g, row, e)
    if K * length <= row[BOUND]:
        return
    way = length - row[BOUND] / K
    row[SLID] += way
    row[WORK] += row[BOUND] * way
    out, square = 0.0, 0.0
    for i in range(3):
        row[N0 + i] = g[i] / h
        out += e[i] * row[N0 + i]
    for i in range(3):
        e[i] -= out * row[N0 + i]
        square += e[i] * e[i]
    share = row[BOUND] / (K * math.sqrt(square)) if square > 0.0 else 0.0
    for i in range(3):
        row[G0 + i] = g[i] - share * e[i]


@part
def pair_potential(g, h, d, K, k, row, e, f, H):
    """Energy of a pair as a function of g; fills its gradient f (3,) and Hessian H (3, 3).

    `row` is the pair's row of the contact memory; `e` is scratch (3,).
    """
    energy = 0.0
    clear(f)
    clear_table(H)
    delta = d - h
    if delta > 0.0:
        F = K * delta**k
        slope = K * k * delta ** (k - 1.0)
        turn = F / h
        energy = F * delta / (k + 1.0)
        for i in range(3):
            ni = g[i] / h
            f[i] = -F * ni
            H[i, i] = -turn
            for j in range(3):
                H[i, j] += (slope + turn) * ni * g[j] / h
    if row[ON] > 0.0:
        length = stretch(g, row, e)
        if K * length <= row[BOUND]:
            slope, radial = K, 0.0
            energy += 0.5 * K * length**2
        else:
            slope = row[BOUND] / length
            radial = -slope / length**2
            energy += row[BOUND] * (length - 0.5 * row[BOUND] / K)
        for i in range(3):
            f[i] += slope * e[i]
            H[i, i] += slope
            for j in range(3):
                H[i, j] += radial * e[i] * e[j] - slope * row[N0 + i] * row[N0 + j]
    return energy


def pair_friction(vectors: np.ndarray, memories: np.ndarray, K: float) -> Friction:
    """Tangential forces, slips and frictional work of pairs, from their g (..., pairs, 3) and memories."""
    held = memories[..., ON] > 0.0
    normal = memories[..., N0 : N0 + 3]
    g = vectors - memories[..., G0 : G0 + 3]
    e = (g - (g * normal).sum(axis=-1, keepdims=True) * normal) * held[..., None]
    length = np.linalg.norm(e, axis=-1)
    force = np.minimum(K * length, np.where(held, memories[..., BOUND], 0.0))
    way = length - force / K
    share = np.divide(force, length, out=np.zeros_like(force), where=length > 0.0)
    return Friction(
        force=share[..., None] * e,
        slip=memories[..., SLID] * held + way,
        work=memories[..., WORK] * held + force * way,
    )
