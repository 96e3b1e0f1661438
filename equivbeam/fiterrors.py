"""What a fit determines, and how well: of its residuals and their derivatives J by shares of parameters."""

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

# Singular values of the derivatives, of residuals over peaks by relative changes, over the largest one or 1:
# differences leave up to 6e-10 of what is zero; the weakest direction that was met in the paper's springs
# and in guided ones is 2e-7 (an exponent beside a penalty).
RESOLVED = 1e-8
TRADED = 1e-3  # relative change of a parameter, for another's by its whole value, that counts
OTHERWISE = 0.05  # share of a parameter's effect that others beside it need not have, to stand for it
TURNS = 0.2  # of the range of the load, by which it goes back where a branch ends
SHAPES = 2  # of a misfit: the slowest along the curve that the parameters cannot follow


def independent(J: np.ndarray) -> list[int]:
    """Columns, from the first on, that add to the rank; J are residuals over peaks by shares."""
    kept: list[int] = []
    least = RESOLVED * max(float(np.linalg.norm(J, 2)), 1.0) if J.size else 0.0
    for i in range(J.shape[1]):
        if np.linalg.matrix_rank(J[:, [*kept, i]], tol=least) > len(kept):
            kept.append(i)
    return kept


def undetermined(J: np.ndarray, fitted: np.ndarray, doubtful: list[int]) -> np.ndarray:
    """Whether each parameter has a part in the null space, or is `doubtful`, shape (parameters,).

    A parameter that was not fitted is undetermined together with those whose change makes up for its own.
    """
    lost = np.ones(J.shape[1], dtype=bool)
    lost[[*fitted, *doubtful]] = False
    instead = np.linalg.lstsq(J[:, fitted], J[:, lost], rcond=None)[0]
    lost[fitted] = (np.abs(instead) > TRADED).any(axis=1)
    lost[doubtful] = True
    return lost


def instead_of(J: np.ndarray, fitted: np.ndarray, i: int) -> np.ndarray:
    """Which of the fitted parameters can stand for another one, i: all but `OTHERWISE` of what it moves."""
    shares = np.linalg.lstsq(J[:, fitted], J[:, i], rcond=None)[0]
    left = np.linalg.norm(J[:, i] - J[:, fitted] @ shares)
    size = float(np.linalg.norm(J[:, i]))
    if size <= RESOLVED or left >= OTHERWISE * size:
        return fitted[:0]
    return fitted[np.abs(shares) * np.linalg.norm(J[:, fitted], axis=0) > OTHERWISE * size]


def spread(
    J: np.ndarray, fitted: np.ndarray, residuals: np.ndarray, times: np.ndarray
) -> tuple[np.ndarray, int]:
    """Changes of the shares, in each column with one of them by its standard error; degrees of freedom.

    The diagonal holds the standard errors, nan where there is none. Independent errors of the points have the
    same mean square in every direction of the residuals. A misfit of the model varies slowly along the
    curve: the mean square in the `SHAPES` slowest directions that are left is taken where it is larger.
    """
    found = np.full((J.shape[1], J.shape[1]), np.nan)
    spare = residuals.size - fitted.size
    if spare <= 0 or means(residuals, times).size <= fitted.size:  # points of one force tell one thing
        return found, 0
    found[:, fitted] = 0.0
    variance, freedom = residuals @ residuals / spare, spare
    slow = _slow(J[:, fitted], residuals, times)[:spare]
    if slow.size and slow @ slow / slow.size > variance:
        variance, freedom = slow @ slow / slow.size, slow.size
    inverse = np.linalg.pinv(J[:, fitted])
    covariance = inverse @ inverse.T  # of residuals with the variance 1
    found[np.ix_(fitted, fitted)] = np.sqrt(variance / np.diag(covariance)) * covariance
    return found, freedom


def correlations(J: np.ndarray, fitted: np.ndarray) -> np.ndarray:
    """Correlations of the parameters' errors, (parameters, parameters); nan of those not `fitted`."""
    found = np.full((J.shape[1], J.shape[1]), np.nan)
    inverse = np.linalg.pinv(J[:, fitted])
    sizes = np.linalg.norm(inverse, axis=1)
    found[np.ix_(fitted, fitted)] = inverse @ inverse.T / np.outer(sizes, sizes)
    return found


def _slow(J: np.ndarray, residuals: np.ndarray, times: np.ndarray) -> np.ndarray:
    """Parts of the residuals in the slowest directions that are normal to the derivatives."""
    columns = residuals.size // times.size
    places = (np.argsort(np.argsort(times, kind="stable")) + 0.5) / times.size
    waves = np.cos(np.pi * np.outer(places, np.arange(SHAPES + J.shape[1])))
    waves = np.kron(waves, np.eye(columns))
    waves -= J @ (np.linalg.pinv(J) @ waves)
    U, sizes, _ = np.linalg.svd(waves, full_matrices=False)
    return (U.T @ residuals)[sizes > RESOLVED * sizes[0]][: SHAPES * columns]


def means(residuals: np.ndarray, times: np.ndarray) -> np.ndarray:
    """Means of the residuals at each time, in order, shape (times that differ, columns): points that a bench
    has written twice, or while it waited, are one."""
    _, place, count = np.unique(times, return_inverse=True, return_counts=True)
    columns = residuals.reshape(times.size, -1).T
    return np.stack([np.bincount(place, column) / count for column in columns], axis=1)


def root_mean_square(values: np.ndarray) -> float:
    """Of all values."""
    return float(np.sqrt(np.mean(values**2)))


class Branch(NamedTuple):
    """Points of loading, or of unloading, in the order of the load."""

    times: np.ndarray  # (points,) all different
    means: np.ndarray  # (points, columns) see `means`


def branches(residuals: np.ndarray, times: np.ndarray) -> list[Branch]:
    """Loading and unloading, in turn, in the order of the points.

    A branch ends where the load goes back by more than `TURNS` of its range. All are one in another order.
    """
    way, turns, end, most = 0.0, [], 0, TURNS * np.ptp(times)
    for i, time in enumerate(times):
        on = time - times[end]
        if way * on < -most or (way == 0.0 and abs(on) > most):
            turns += [end + 1] if way else []
            way, end = np.sign(on), i
        elif way * on > 0.0 or (way and on == 0.0):
            end = i
    rows = residuals.reshape(times.size, -1)
    pieces = list(zip(np.split(rows, turns), np.split(times, turns), strict=True))
    found = [Branch(np.unique(time), means(row, time)) for row, time in pieces]
    whole = Branch(np.unique(times), means(residuals, times))
    known = sum(max(branch.times.size - 2, 0) for branch in found)
    return found if 2 * known > whole.times.size - 2 else [whole]


def scatter(parts: Sequence[Branch]) -> float:
    """Root mean square of the means on `branches` about their neighbours, without what varies slowly; nan of
    too few."""
    bends = np.concatenate([np.diff(part.means, 2, axis=0) for part in parts])
    return root_mean_square(bends) / math.sqrt(6.0) if bends.size else np.nan


def hysteresis(parts: Sequence[Branch]) -> float:
    """Mean difference of loading and unloading at one load, of the largest column; 0 without both."""
    ways = [[part for part in parts[first::2] if part.times.size > 2] for first in (0, 1)]
    if not all(ways):
        return 0.0
    times, values = [], []
    for way in ways:
        time = np.concatenate([part.times for part in way])
        order = np.argsort(time, kind="stable")
        times.append(time[order])
        values.append(np.concatenate([part.means for part in way])[order])
    low, high = max(time[0] for time in times), min(time[-1] for time in times)
    at = np.concatenate([time[(time >= low) & (time <= high)] for time in times])
    columns = range(values[0].shape[1])
    apart = [
        np.interp(at, times[0], values[0][:, k]) - np.interp(at, times[1], values[1][:, k]) for k in columns
    ]
    return float(np.abs(np.mean(apart, axis=1)).max()) if at.size else 0.0


def constant_part(J: np.ndarray, residuals: np.ndarray) -> float:
    """Share of the residuals' square that a constant beside the parameters takes away."""
    constant = 1.0 - J @ np.linalg.pinv(J).sum(axis=1)
    size = float(constant @ constant) * float(residuals @ residuals)
    return float(constant @ residuals) ** 2 / size if size > RESOLVED**2 else 0.0
