"""Quaternions and the deformation of a rod's element between two poses, real or complex, in plain numpy."""

import math
from collections.abc import Callable

import numpy as np

SMALL = 1e-3  # sine below which series stand for the trigonometric functions
TINY = 1e-30  # of a complex step
NUDGE = 1e-6  # wire diameters or rad, with which differences are taken


def product(p: np.ndarray, q: np.ndarray) -> np.ndarray:
    """Product of quaternions (4, ...)."""
    a, b, c, d = p
    w, x, y, z = q
    return np.stack(
        (a * w - b * x - c * y - d * z, a * x + b * w + c * z - d * y, a * y - b * z + c * w + d * x,
         a * z + b * y - c * x + d * w)
    )  # fmt: skip


def rotated(q: np.ndarray, v: np.ndarray) -> np.ndarray:
    """Vectors (3, ...) turned by quaternions (4, ...)."""
    cross = _cross(q[1:], v)
    return v + 2.0 * (q[0] * cross + _cross(q[1:], cross))


def strain(one: tuple[np.ndarray, np.ndarray], two: tuple[np.ndarray, np.ndarray]) -> np.ndarray:
    """(W1)-(W3): (v, theta), shape (6, ...), from positions and frames of both ends."""
    between = product(_inverse(one[1]), two[1])
    between = np.where(between[0].real < 0.0, -between, between)
    w, vector = between[0], between[1:]
    square = (vector**2).sum(axis=0)
    near = np.abs(square) < SMALL**2
    sine = np.sqrt(np.where(near, 1.0, square))
    ratio = square / w**2
    scale = np.where(near, 2.0 / w * (1.0 - ratio / 3.0 + ratio**2 / 5.0), 2.0 * np.arctan(sine / w) / sine)
    theta = scale * vector
    half = np.concatenate(((1.0 + w)[None], vector))
    half = half / np.sqrt((half**2).sum(axis=0))
    u = rotated(_inverse(product(one[1], half)), two[0] - one[0])
    angle2 = (theta**2).sum(axis=0)
    angle = np.sqrt(np.where(near, 1.0, angle2))
    c = np.where(
        near,
        1.0 / 24.0 + 7.0 * angle2 / 5760.0,
        (0.5 * angle / np.sin(0.5 * angle) - 1.0) / np.where(near, 1.0, angle2),
    )
    v = (1.0 + c * angle2) * u - c * theta * (theta * u).sum(axis=0)
    return np.concatenate((v, theta))


def _inverse(q: np.ndarray) -> np.ndarray:
    return np.concatenate((q[:1], -q[1:]))


def _cross(a: np.ndarray, b: np.ndarray) -> np.ndarray:  # numpy's takes five times as long
    return np.stack((a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]))


def stepped(near: np.ndarray) -> list[tuple[np.ndarray, np.ndarray]]:
    """Positions and quaternions (3 or 4, steps, items) of the nodes of items, (slots, items, 7): each step
    moves, or turns about, one direction of one node by a complex number."""
    shift = 1j * TINY * np.eye(6 * len(near)).reshape(len(near), 6, -1, 1)
    spin = np.concatenate((np.ones_like(shift[:, :1]), 0.5 * shift[:, 3:]), axis=1)
    return [
        (row[:, :3].T[:, None] + shift[slot, :3], product(spin[slot], row[:, 3:].T[:, None]))
        for slot, row in enumerate(near)
    ]


def differences(function: Callable[[np.ndarray], np.ndarray], near: np.ndarray, d: float) -> np.ndarray:
    """Central differences (6 slots, ...) of a function of the nodes of items, (slots, items, 7)."""
    found = []
    for slot, i in np.ndindex(len(near), 6):
        move, sides = np.zeros((near.shape[1], 6)), []
        move[:, i] = size = NUDGE * (d if i < 3 else 1.0)
        for sign in (1.0, -1.0):
            there = near.copy()
            there[slot] = moved(there[slot], sign * move)
            sides.append(function(there))
        found.append((sides[0] - sides[1]) / (2.0 * size))
    return np.array(found)


def summed(nodes: np.ndarray, parts: np.ndarray, count: int) -> np.ndarray:
    """Sum (count, 6) of what items, (6 slots, items), give to their nodes, (slots, items)."""
    total = np.zeros((count, 6))
    np.add.at(total, nodes, parts.reshape(len(nodes), 6, -1).swapaxes(1, 2))
    return total


def assembled(nodes: np.ndarray, K: np.ndarray, count: int) -> np.ndarray:
    """Sum (6 count, 6 count) of the matrices of items, (6 slots, 6 slots, items)."""
    total, dofs = np.zeros((6 * count,) * 2), (6 * nodes[:, None] + np.arange(6)[:, None]).reshape(len(K), -1)
    np.add.at(total, (dofs[:, None], dofs[None]), K)
    return total


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
