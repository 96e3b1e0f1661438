"""Moves and spins of a wire's nodes, for differences and steps of the verifier."""

from __future__ import annotations

import math

import numpy as np

from validation.campaign.poses import product

NUDGE = 1e-6  # wire diameters or rad, with which differences are taken


def width(i: int, d: float) -> float:
    """Width of a central difference in a degree of freedom of a node."""
    return 2.0 * NUDGE * (d if i < 3 else 1.0)


def nudged(rows: np.ndarray, nodes: np.ndarray | int, i: int, h: float, d: float) -> np.ndarray:
    """Rows with some nodes moved in, or turned about, one direction."""
    move = np.zeros((len(rows), 6))
    move[nodes, i] = h * (d if i < 3 else 1.0)
    return moved(rows, move.ravel())


def moved(rows: np.ndarray, move: np.ndarray) -> np.ndarray:
    """Rows after the moves and spins of all nodes."""
    move = move.reshape(-1, 6)
    spin = move[:, 3:]
    half = 0.5 * np.linalg.norm(spin, axis=1)
    turn = np.concatenate((np.cos(half)[None], 0.5 * np.sinc(half / math.pi) * spin.T))
    out = rows.copy()
    out[:, :3] += move[:, :3]
    out[:, 3:] = product(turn, rows[:, 3:].T).T
    out[:, 3:] /= np.linalg.norm(out[:, 3:], axis=1, keepdims=True)
    return out
