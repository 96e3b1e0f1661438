"""Critical points bracketed by the verifier's own Hessian: a stable and an unstable state side by side."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from scipy.linalg import solve_triangular

from validation.campaign.energy import BeamEnergy

CLOSE = 1e-9  # of the displacement from rest: the last correction
LOOSE = 1e-7  # where rounding keeps the corrections from becoming smaller
MOST_CORRECTIONS = 25
MOST_TRIALS = 40
MOST_SETS = 6  # of closed pairs that are tried
TIGHT = 5e-5  # of the load: where an unstable equilibrium is that near, the bracket is not narrowed further
ENOUGH = 1e-4  # of the load: a bracket within it needs no other
FAR = 20.0  # moves beyond this multiple of the tangent's belong to another branch


@dataclass(frozen=True)
class Bracket:
    """Loads and least eigenvalues of a stable and of an unstable equilibrium next to each other.

    Attributes
    ----------
    stable, unstable : times of the two.
    least : least eigenvalues of the two, in units of those at rest.
    """

    stable: float
    unstable: float
    least: tuple[float, float]

    def offset(self, time: float) -> float:
        """Offset of `time` from the farther end, over `time`."""
        return max(abs(self.stable - time), abs(self.unstable - time)) / time


def bracket(energy: BeamEnergy, state: np.ndarray, time: float, critical: float) -> Bracket | None:
    """Bracket the critical point at `critical` from the stable equilibrium `state` at the lower `time`.

    The curve of equilibria is followed along the softest mode, over which the load rises and falls; where
    that mode does no work (a bifurcation) the same branch is continued by the load.
    """
    start = _Start.of(energy, state, time)
    if start.least <= 0.0:
        return None
    found = _along_mode(energy, start, critical)
    if found is not None and found.offset(critical) <= ENOUGH:
        return found
    return _by_load(energy, start, critical) or found


@dataclass(frozen=True)
class _Start:
    """A stable equilibrium, its softest mode, the linear form that measures distances along it, and what
    time does to the spring."""

    state: np.ndarray
    time: float
    least: float
    mode: np.ndarray
    form: np.ndarray
    rate: np.ndarray

    @classmethod
    def of(cls, energy: BeamEnergy, state: np.ndarray, time: float) -> _Start:
        values, vectors = np.linalg.eigh(energy.relative(energy.hessian(state)))
        soft = vectors[:, 0]
        mode = solve_triangular(energy.rest_factor, soft, lower=True, trans="T")
        rate = energy.rate(state)
        sign = 1.0 if mode @ rate >= 0.0 else -1.0
        return cls(state, time, float(values[0]), sign * mode, sign * energy.rest_factor @ soft, rate)


def _along_mode(energy: BeamEnergy, start: _Start, critical: float) -> Bracket | None:
    """Narrow the sign change of the least eigenvalue over the distance along the softest mode."""
    work = float(start.mode @ start.rate)
    if work <= 0.0:
        return None
    distance = 3.0 * (critical - start.time) * work / start.least  # a parabola has its top at 2
    low, high = (0.0, start.state, start.time, start.least), None
    for _ in range(MOST_TRIALS):
        solved = _corrected(energy, low[1], low[2], start, distance)
        if solved is None:
            distance = 0.5 * (low[0] + distance)
            continue
        point = (distance, *solved, energy.least(solved[0]))
        if point[3] > 0.0:
            low = point
        else:
            high = point
        if high is None:
            distance *= 2.0
            continue
        if abs(high[2] - critical) <= TIGHT * critical:
            break
        share = low[3] / (low[3] - high[3])
        distance = low[0] + min(max(share, 0.1), 0.9) * (high[0] - low[0])
    return None if high is None else Bracket(low[2], high[2], (low[3], high[3]))


def _corrected(
    energy: BeamEnergy, state: np.ndarray, time: float, start: _Start, distance: float
) -> tuple[np.ndarray, float] | None:
    """Equilibrium at the given distance along the mode, in state and load."""

    def short(q: np.ndarray) -> float:
        return float(distance - start.form @ (q - start.state)[energy.free])

    return _settled(energy, state, time, short, start.form)


def _settled(
    energy: BeamEnergy,
    state: np.ndarray,
    time: float,
    short: Callable[[np.ndarray], float] | None = None,
    form: np.ndarray | None = None,
) -> tuple[np.ndarray, float] | None:
    """Equilibrium near `state`, at `time` or where `short` vanishes, whose closed pairs are those assumed."""
    closed = energy.closed(state)
    for _ in range(MOST_SETS):
        found = _newton(energy, closed, state, time, short, form)
        if found is None:
            return None
        now = energy.closed(found[0])
        if (now == closed).all():
            return found
        closed = now
    return None


def _newton(
    energy: BeamEnergy,
    closed: np.ndarray,
    state: np.ndarray,
    time: float,
    short: Callable[[np.ndarray], float] | None,
    form: np.ndarray | None,
) -> tuple[np.ndarray, float] | None:
    """Newton's method with the closed pairs held closed, which leaves no kinks."""
    state, size = energy.placed(state.copy(), time), energy.free.size
    matrix = np.zeros((size + 1, size + 1))
    matrix[size, size] = 1.0
    if form is not None:
        matrix[size, :size], matrix[size, size] = form, 0.0
    before = np.inf
    for _ in range(MOST_CORRECTIONS):
        residual = energy.residual(state, time, closed)
        matrix[:size, :size], matrix[:size, size] = energy.hessian(state, closed), -energy.rate(state, closed)
        try:
            step = np.linalg.solve(matrix, np.append(-residual, short(state) if short else 0.0))
        except np.linalg.LinAlgError:
            return None
        if not np.isfinite(step).all():
            return None
        state[energy.free] += step[:size]
        time += step[size]
        state = energy.placed(state, time)
        # by the step, not by the residual: hard contact turns rounding of positions into large forces
        share = energy.moved(step[:size]) / abs(time)
        if share <= CLOSE or (before <= LOOSE and share > 0.5 * before):
            return state, time
        before = share
    return None


def _by_load(energy: BeamEnergy, start: _Start, critical: float) -> Bracket | None:
    """Continue the branch by the load to as far beyond the critical point as `start` lies before it."""
    time = 2.0 * critical - start.time
    ahead = start.state.copy()
    tangent = np.linalg.solve(energy.hessian(start.state), start.rate) * (time - start.time)
    ahead[energy.free] += tangent
    found = _settled(energy, ahead, time)
    if found is None:
        return None
    moved = np.linalg.norm((found[0] - start.state)[energy.free])
    least = energy.least(found[0])
    if moved > FAR * np.linalg.norm(tangent) or least > 0.0 or start.least < 0.0:
        return None
    return Bracket(start.time, time, (start.least, least))
