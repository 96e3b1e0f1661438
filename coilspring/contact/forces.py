"""Forces, slips and work of pairs, read off states that were found: `coilspring.contact.law` on arrays."""

from typing import Any

import numpy as np

from coilspring.contact.law import normal_law
from coilspring.path import Friction


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


def tangential_forces(length: np.ndarray, gaps: np.ndarray, histories: np.ndarray) -> tuple[np.ndarray, ...]:
    """Tangential forces of pairs at lengths of slip and gaps, N; by how much they slip in the substep at
    hand, mm, and the work that takes, N mm.
    """
    K = histories["stiffness"]
    stiffness = K * histories["closed"] * (1.0 - histories["released"])
    force = stiffness * length
    slides, gives = force > histories["bound"], histories["released"] > 0.0
    bound = np.where(slides, histories["bound"], 0.0)
    rise = bound * histories["rise"]
    slip = np.where(slides, (force - bound) / np.where(slides, stiffness + rise, 1.0), 0.0)
    force = np.where(slides, bound + rise * slip, force)
    held = np.where(histories["held"] < np.inf, histories["held"], 0.0)  # not known of what touched at rest
    slip, work = (slides * each for each in _sliding(length, gaps, histories, held, force))
    stretch = force / np.where(gives, K, 1.0)
    given = 0.5 * (held * length + force * (length - histories["before"] - stretch))
    return force, np.where(gives, length - stretch, slip), np.where(gives, given, work)


def _sliding(
    length: np.ndarray, gaps: np.ndarray, histories: np.ndarray, held: np.ndarray, force: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """See `coilspring.contact.touching.sliding`; bounds before, and the force held now."""
    begin, end = histories["before"] + histories["ahead"], length + histories["ahead"]
    deep, apart = histories["deep"], np.maximum(gaps, 0.0)
    share = np.divide(deep, deep + apart, out=np.ones_like(deep + apart), where=apart > 0.0)
    end = begin + share * (end - begin)
    begin, end = np.where(end < 0.0, -begin, begin), np.abs(end)
    left = np.maximum(held - histories["whole"] * begin, 0.0)
    beyond = np.maximum(histories["stiffness"] * end - force, 0.0)
    share = np.divide(left, left + beyond, out=np.zeros_like(beyond), where=left > 0.0)
    slip = np.divide(beyond, histories["stiffness"], out=np.zeros_like(beyond), where=beyond > 0.0)
    return slip, 0.5 * (held + share * (force - held) + force) * slip


def pair_friction(vectors: np.ndarray, histories: np.ndarray, law: Any) -> Friction:
    """Tangential forces, slips and frictional work of pairs, from their g (..., pairs, 3) and histories.

    `law` is a `PairLaw`.
    """
    d = law.d
    held, normal = histories["closed"], histories["normal"]
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
    force, slip, work = tangential_forces(length, h - d, histories)
    along = np.where(arcs[..., None], chord - 0.5 * square[..., None] * n, stuck)
    # of an arc on its arm d, over the size of the vector along it
    share = np.where(arcs, force * d / h, force) / np.where(force > 0.0, np.where(arcs, sine, length), 1.0)
    return Friction(
        force=share[..., None] * along,
        slip=(histories["slid"] + slip) * held,
        work=histories["work"] + work * held,
    )
