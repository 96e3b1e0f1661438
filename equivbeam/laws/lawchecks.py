"""What must hold of a user's law before a spring is solved with it, and where it ends a path.

At rest the energy is finite and has a minimum. Around rest its first derivatives are continuous.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Protocol

import numpy as np

from coilspring.errors import InputError
from equivbeam.laws.haringx import L0

FORCE = 1e-9  # at rest, over the largest stiffness times the length
STIFFNESS = 1e-12  # least eigenvalue at rest over the largest
GRID = 24  # intervals of a line along which kinks are searched
RANGE = (0.5, 0.4, 0.4)  # to both sides of rest: of l and v over l0, and of dtheta, rad
LINES = ((1, 0, 0), (0, 1, 0), (0, 0, 1), (1, 1, 1), (1, -1, 1))
JUMP = 1e-4  # of a first derivative, over the largest stiffness at rest times the range
HALVINGS = 30
BESIDE = 1e-6  # of sizes: so near to rest the stiffness is that at rest, unless it jumps there
BEYOND = 1.02  # times the way from rest: where a path that ended would have gone on
U, FIRST, SECOND = 0, slice(1, 4), (4, 5, 6, 5, 7, 9, 6, 9, 8)  # of a table: energy, gradient, Hessian


class Law(Protocol):
    """What is checked: a law by its name, and its energy and derivatives, see `equivbeam.laws.userlaw`."""

    @property
    def name(self) -> str: ...

    def evaluated(self, rows: np.ndarray, index: np.ndarray, points: np.ndarray) -> np.ndarray: ...


def state_text(l: float, v: float, turn: float) -> str:  # noqa: E741
    """A state of a half coil for messages."""
    return f"(l = {l:.6g} mm, v = {v:.3g} mm, dtheta = {turn:.3g} rad)"


def checked_rest(law: Law, rows: np.ndarray) -> np.ndarray:
    """Diagonal of the stiffness matrix at rest of every half coil, shape (half coils, 3).

    `InputError`: at rest the energy is not finite, has no minimum or no positive stiffness, or it has a kink.
    """
    rest = np.zeros((len(rows), 3))
    rest[:, 0] = rows[:, L0]
    found = law.evaluated(rows, np.arange(len(rows)), rest)
    size = np.ones_like(rest)
    size[:, :2] = rows[:, [L0]]  # lengths and shears over the length at rest

    def require(good: np.ndarray, what: str, why: Callable[[int], str] = lambda bad: "") -> None:
        if not good.all():
            bad = int(np.argmin(good))
            place = f"energy of half coil {bad + 1} {what} at rest {state_text(*rest[bad])}"
            raise InputError(f"law {law.name}: {place}{why(bad)}")

    require(np.isfinite(found).all(axis=1), "is not finite, or its derivatives are not,")
    eigenvalues = _eigenvalues(found, size)
    least, scale = eigenvalues[:, 0], np.abs(eigenvalues).max(axis=1)
    for step in BESIDE * np.concatenate((np.eye(3), -np.eye(3))):  # it may jump at rest
        there = law.evaluated(rows, np.arange(len(rows)), rest + step * size)
        finite = np.isfinite(there).all(axis=1)  # where it is not, a path ends
        least[finite] = np.minimum(least[finite], _eigenvalues(there[finite], size[finite])[:, 0])
    different = np.unique(rows, axis=0, return_index=True)[1]  # most springs repeat one half coil
    index = np.repeat(different, GRID)
    for line in LINES:
        points = np.linspace(-1.0, 1.0, GRID + 1)[:, None] * np.multiply(line, RANGE)
        begin, end = (np.tile(each, (len(different), 1)) * size[index] for each in (points[:-1], points[1:]))
        _refuse_kink(law, rows, (size, scale), index, (rest[index] + begin, rest[index] + end))
    require(
        np.abs(found[:, FIRST] * size).max(axis=1) <= FORCE * scale,
        "has no minimum",
        lambda bad: f": its derivatives there are ({', '.join(f'{x:.3g}' for x in found[bad, FIRST])})",
    )
    share = least / np.where(scale > 0.0, scale, 1.0)
    require(
        least > STIFFNESS * scale,
        "has a stiffness that is not positive",
        lambda bad: f": the least eigenvalue of its stiffness matrix is {share[bad]:.3g} of the largest",
    )
    return found[:, [4, 7, 8]]


def _eigenvalues(found: np.ndarray, size: np.ndarray) -> np.ndarray:
    """Of the stiffness matrices of half coils, by shares of their sizes, shape (half coils, 3)."""
    stiffness = found[:, SECOND].reshape(-1, 3, 3) * size[:, :, None] * size[:, None, :]
    return np.linalg.eigvalsh(stiffness)


def _refuse_kink(
    law: Law,
    rows: np.ndarray,
    at_rest: tuple[np.ndarray, np.ndarray],
    index: np.ndarray,
    between: tuple[np.ndarray, np.ndarray],
) -> None:
    """Refuse a jump of the energy or of its first derivatives between states of the half coils `index`.

    It is found by halving where the ends differ too much: in a smooth law the difference of two gradients
    tends to that of the Hessian times the distance. `at_rest` are sizes and stiffnesses of all half coils.
    """
    (size, scale), (begin, end) = at_rest, between
    low, high = law.evaluated(rows, index, begin), law.evaluated(rows, index, end)
    for _ in range(HALVINGS):
        change = _unexplained(low, high, end - begin, size[index], scale[index])
        index, begin, end, low, high = (each[change > JUMP] for each in (index, begin, end, low, high))
        if not index.size:
            return
        middle = 0.5 * (begin + end)
        half = law.evaluated(rows, index, middle)
        first = _unexplained(low, half, middle - begin, size[index], scale[index])
        second = _unexplained(half, high, end - middle, size[index], scale[index])
        left = (first >= second)[:, None]
        begin, end = np.where(left, begin, middle), np.where(left, middle, end)
        low, high = np.where(left, low, half), np.where(left, half, high)
    raise InputError(
        f"law {law.name}: energy of half coil {index[0] + 1} has a kink at {state_text(*end[0])}"
    )


def _unexplained(
    low: np.ndarray, high: np.ndarray, step: np.ndarray, size: np.ndarray, scale: np.ndarray
) -> np.ndarray:
    """What of the changes of energy and forces the derivatives do not explain, over the stiffness at rest."""
    with np.errstate(all="ignore"):
        mean = 0.5 * (low + high)
        second = mean[:, SECOND].reshape(-1, 3, 3)
        forces = high[:, FIRST] - low[:, FIRST] - np.einsum("kij,kj->ki", second, step)
        energy = high[:, U] - low[:, U] - np.einsum("ki,ki->k", mean[:, FIRST], step)
        worst = np.maximum(np.abs(forces * size).max(axis=1), np.abs(energy)) / scale
    return np.where(np.isfinite(worst), worst, 0.0)  # no finite energy ends a path, but is no kink


def not_finite(law: Law, rows: np.ndarray, points: np.ndarray) -> str:
    """Which half coil has no finite energy at points (half coils, 3) or a little farther from rest."""
    rest = np.zeros_like(points)
    rest[:, 0] = rows[:, L0]
    for share in np.linspace(1.0, BEYOND, 9):
        at = rest + share * (points - rest)
        bad = ~np.isfinite(law.evaluated(rows, np.arange(len(rows)), at)).all(axis=1)
        if bad.any():
            coil = int(np.argmax(bad))
            return f"law {law.name}: energy of half coil {coil + 1} is not finite at {state_text(*at[coil])}"
    return ""
