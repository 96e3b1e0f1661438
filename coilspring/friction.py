"""Stability under Coulomb friction, whose bounds follow the normal forces.

The follower's matrix H is that with the bounds held, which has a potential. With the bounds b = b(q) the
tangent is ``H + U V^T``, U = dg/db and V = db/dq: not symmetric, and its determinant is that of H times
``det(I + V^T H^-1 U)`` (matrix determinant lemma), of the size of the number of pairs that slide.
"""

from __future__ import annotations

import numpy as np

from coilspring.kernelset import Kernels
from coilspring.pairlaw import BOUND, ON
from coilspring.stability import factored

NUDGE = 1e-6  # of a bound, and mm or rad of a move, with which differences are taken
AHEAD = (1e-7, 1e-6, 1e-5, 1e-4)  # of the time 0..1: there the tangent is looked at
SLIDES = 1e-9  # least force in a freedom per unit of a bound


def goes_on(
    kernels: Kernels,
    data: tuple[np.ndarray, np.ndarray],
    state: np.ndarray,
    memory: np.ndarray,
    load: np.ndarray,
    matrix_size: int,
) -> bool:
    """Whether the determinant of Coulomb's tangent keeps its sign just ahead of `state`, where a path ended.

    Then no critical point shows there: it is the iteration on held bounds that ends.
    """
    if not np.any((memory[:, ON] > 0.0) & np.isfinite(memory[:, BOUND])):
        return False
    H, _ = factored(kernels, data, state, memory, load.size, matrix_size)
    tangent = load.copy()
    kernels.solve(*data, H, tangent)
    states = [_moved(kernels, data, state, tangent, ahead) for ahead in AHEAD]
    return all(_determinant(kernels, data, moved, memory, load, matrix_size) > 0.0 for moved in states)


def _moved(
    kernels: Kernels, data: tuple[np.ndarray, np.ndarray], state: np.ndarray, step: np.ndarray, factor: float
) -> np.ndarray:
    out = state.copy()
    kernels.retract(*data, state, step, factor, state, 0.0, out)
    return out


def _determinant(
    kernels: Kernels,
    data: tuple[np.ndarray, np.ndarray],
    state: np.ndarray,
    memory: np.ndarray,
    load: np.ndarray,
    matrix_size: int,
) -> float:
    """Determinant of Coulomb's tangent over the size of that of the tangent with the bounds held."""
    memory = memory.copy()
    kernels.renew(*data, state, memory)

    def gradient(memory: np.ndarray) -> np.ndarray:
        g = np.empty_like(load)
        kernels.assemble(*data, state, 0.0, memory, state, g, np.empty(0))
        return g

    def bounds(step: np.ndarray, factor: float) -> np.ndarray:
        changed = memory.copy()
        kernels.renew(*data, _moved(kernels, data, state, step, factor), changed)
        return changed[:, BOUND]

    H, negative = factored(kernels, data, state, memory, load.size, matrix_size)
    pairs, columns = [], []
    for m in np.flatnonzero((memory[:, ON] > 0.0) & (memory[:, BOUND] > 0.0)):
        low, high = memory.copy(), memory.copy()
        low[m, BOUND] *= 1.0 - NUDGE
        high[m, BOUND] *= 1.0 + NUDGE
        force = (gradient(high) - gradient(low)) / (high[m, BOUND] - low[m, BOUND])
        if np.abs(force).max() > SLIDES:
            kernels.solve(*data, H, force)
            pairs.append(m)
            columns.append(force)
    M = np.eye(len(pairs))
    for j, column in enumerate(columns):
        size = NUDGE / max(float(np.abs(column).max()), 1e-300)
        M[:, j] += (bounds(column, size) - bounds(column, -size))[pairs] / (2.0 * size)
    return (-1.0) ** negative * float(np.linalg.det(M))
