"""Forces of pairs, read off states that were found: `coilspring.contact.law` on arrays."""

import numpy as np

from coilspring.contact.law import normal_law


def normal_forces(penetrations: np.ndarray, K: float | np.ndarray, k: float) -> np.ndarray:
    """Normal forces of pairs, N, from their penetrations (..., pairs), mm; of those that are open none.

    `K` is that of all, or of each pair, (pairs,), N/mm^k.
    """
    forces = np.zeros_like(penetrations)
    closed = penetrations > 0.0
    each = zip(penetrations[closed].tolist(), np.broadcast_to(K, closed.shape)[closed].tolist(), strict=True)
    # one by one: a law for numbers may branch
    forces[closed] = [normal_law(penetration, stiffness, k)[1] for penetration, stiffness in each]
    return forces


def tangential_sizes(length: np.ndarray, histories: np.ndarray) -> np.ndarray:
    """Tangential forces of pairs at lengths of slip, N."""
    stiffness, bound = histories["stiffness"], histories["bound"]
    force = stiffness * histories["closed"] * (1.0 - histories["released"]) * length
    slides = force > bound
    bound = np.where(slides, bound, 0.0)
    rise = bound * histories["rise"]
    slip = np.where(slides, (force - bound) / np.where(slides, stiffness + rise, 1.0), 0.0)
    return np.where(slides, bound + rise * slip, force)


def tangential_forces(vectors: np.ndarray, histories: np.ndarray, d: float) -> np.ndarray:
    """Tangential forces of pairs, (..., pairs, 3), N, from the vectors between their centres, of the length d
    where they touch, and their histories."""
    normal = histories["normal"]
    arcs = np.isfinite(histories["bound"]) | histories["grazes"]
    g = vectors - histories["vector"]
    stuck = g - (g * normal).sum(axis=-1, keepdims=True) * normal
    h = np.linalg.norm(vectors, axis=-1)
    n = vectors / h[..., None]
    chord = n - normal
    square = (chord**2).sum(axis=-1)
    sine = np.sqrt(square * (1.0 - 0.25 * square))
    angle = 2.0 * np.arcsin(np.minimum(0.5 * np.sqrt(square), 1.0))
    length = np.where(arcs, d * angle, np.linalg.norm(stuck, axis=-1))
    force = tangential_sizes(length, histories)
    along = np.where(arcs[..., None], chord - 0.5 * square[..., None] * n, stuck)
    # of an arc on its arm d, over the size of the vector along it
    share = np.where(arcs, force * d / h, force) / np.where(force > 0.0, np.where(arcs, sine, length), 1.0)
    return share[..., None] * along
