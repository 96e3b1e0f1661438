"""Stability under Coulomb friction, whose bounds follow the normal forces.

The follower's matrix H is that with the bounds held, which has a potential. With the bounds b = b(q) the
tangent is ``H + U V^T``, U = dg/db and V = db/dq: not symmetric, and its determinant is that of H times
``det(I + V^T H^-1 U)`` (matrix determinant lemma), of the size of the number of pairs that slide.
"""

from __future__ import annotations

import numpy as np

from coilspring.pairlaw import BOUND, ON
from coilspring.stability import Body

NUDGE = 1e-6  # of a bound, and mm or rad of a move, with which differences are taken
AHEAD = (1e-7, 1e-6, 1e-5, 1e-4)  # of the time 0..1: there the tangent is looked at
SLIDES = 1e-9  # least force in a freedom per unit of a bound


def goes_on(body: Body, state: np.ndarray, memory: np.ndarray, load: np.ndarray) -> bool:
    """Whether the determinant of Coulomb's tangent keeps its sign just ahead of `state`, where a path ended.

    Then no critical point shows there: it is the iteration on held bounds that ends.
    """
    if not np.any((memory[:, ON] > 0.0) & np.isfinite(memory[:, BOUND])):
        return False
    H, _ = body.factored(state, memory)
    tangent = body.solved(H, load)
    return all(_determinant(body, body.moved(state, tangent, ahead), memory) > 0.0 for ahead in AHEAD)


def _determinant(body: Body, state: np.ndarray, memory: np.ndarray) -> float:
    """Determinant of Coulomb's tangent over the size of that of the tangent with the bounds held."""
    memory = memory.copy()
    body.kernels.renew(*body.data, state, memory)

    def bounds(step: np.ndarray, factor: float) -> np.ndarray:
        changed = memory.copy()
        body.kernels.renew(*body.data, body.moved(state, step, factor), changed)
        return changed[:, BOUND]

    H, negative = body.factored(state, memory)
    pairs, columns = [], []
    for m in np.flatnonzero((memory[:, ON] > 0.0) & (memory[:, BOUND] > 0.0)):
        low, high = memory.copy(), memory.copy()
        low[m, BOUND] *= 1.0 - NUDGE
        high[m, BOUND] *= 1.0 + NUDGE
        force = (body.gradient(state, high) - body.gradient(state, low)) / (high[m, BOUND] - low[m, BOUND])
        if np.abs(force).max() > SLIDES:
            pairs.append(m)
            columns.append(body.solved(H, force))
    M = np.eye(len(pairs))
    for j, column in enumerate(columns):
        size = NUDGE / max(float(np.abs(column).max()), 1e-300)
        M[:, j] += (bounds(column, size) - bounds(column, -size))[pairs] / (2.0 * size)
    return (-1.0) ** negative * float(np.linalg.det(M))
