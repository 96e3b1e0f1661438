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
    return np.array(  # of small arrays faster than to stack them
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
    return np.array((a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]))


def stepped(near: np.ndarray) -> list[tuple[np.ndarray, np.ndarray]]:
    """Positions and quaternions (3 or 4, steps, ..., items) of the nodes of items, (slots, ..., items, 7):
    each step moves, or turns about, one direction of one node by a complex number."""
    count = len(near)
    step = TINY * np.eye(6 * count).reshape(count, 6, -1, *(1,) * (near.ndim - 2))
    spin = np.concatenate((np.zeros_like(step[:, :1]), 0.5 * step[:, 3:]), axis=1)
    rows = np.moveaxis(near, -1, 1)[:, :, None]
    return [
        (row[:3] + 1j * step[slot, :3], row[3:] + 1j * product(spin[slot], row[3:]))
        for slot, row in enumerate(rows)
    ]


def differences(function: Callable[[np.ndarray], np.ndarray], near: np.ndarray, d: float) -> np.ndarray:
    """Central differences (6 slots, ..., items) of a function of the nodes of items, (slots, items, 7).

    All moves of a slot are put to it at once, (slots, moves, items, 7); it returns (..., moves, items).
    """
    size = NUDGE * np.array([d, d, d, 1.0, 1.0, 1.0])
    moves, found = np.concatenate((np.diag(size), -np.diag(size))), []
    for slot, rows in enumerate(near):
        there = np.repeat(near[:, None], len(moves), axis=1)
        there[slot] = moved(rows, moves[:, None])
        plus, minus = np.split(function(there), 2, axis=-2)
        found.append(np.moveaxis((plus - minus) / (2.0 * size[:, None]), -2, 0))
    return np.concatenate(found)


def like(x: np.ndarray, values: np.ndarray) -> np.ndarray:
    """Values (components, items) beside `x`, (components, ..., items)."""
    return values.reshape(len(values), *(1,) * (x.ndim - 2), -1)


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
    """Rows (..., 7) after moves and spins (..., 6)."""
    spin = move[..., 3:]
    half = 0.5 * np.linalg.norm(spin, axis=-1, keepdims=True)
    turn = np.concatenate((np.cos(half), 0.5 * np.sinc(half / math.pi) * spin), axis=-1)
    q = np.moveaxis(product(np.moveaxis(turn, -1, 0), np.moveaxis(rows[..., 3:], -1, 0)), 0, -1)
    q /= np.linalg.norm(q, axis=-1, keepdims=True)
    return np.concatenate((rows[..., :3] + move[..., :3], q), axis=-1)


def motion(one: np.ndarray, two: np.ndarray, width: float | np.ndarray) -> float:
    """Upper bound on the motion of all within half a width of a node between two states: of the wire's
    diameter, its surface at the nodes; each node may have its own."""
    turned = np.minimum(*(np.linalg.norm(one[:, 3:] + sign * two[:, 3:], axis=1) for sign in (1.0, -1.0)))
    # |q - q'| d >= d sin(angle / 2)
    return float((np.linalg.norm((one - two)[:, :3], axis=1) + turned * width).max())
