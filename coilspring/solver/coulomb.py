"""Where a path with Coulomb friction ends: at a limit point of Coulomb's law, or of the iteration only.

The follower's matrix has a potential. With the bounds of friction held as numbers it is H; with the bounds
b = b(q) of Coulomb's law the tangent is ``H + U V^T``, U = dg/db and V = db/dq: not symmetric, and its
determinant is that of H times ``det(I + V^T H^-1 U)`` (matrix determinant lemma), of the size of the
number of pairs that slide.
"""

import numpy as np

from coilspring.solver.body import Body

NUDGE = 1e-6  # of a bound, with which differences are taken
MOVE = 1e-5  # wire diameters or rad, the same
SLACK = 1e-3  # of a bound: pairs nearer to it slide on
SLIDES = 1e-9  # least force in a dof per unit of a bound
NEAR_LIMIT = 0.1  # largest determinant near a limit point
FALLS = (1e-6, 3e-5)  # wire diameters of the way between which the determinant's fall is measured
AHEAD = (1e-7, 1e-6, 1e-5, 1e-4)  # of the time 0..1: there its sign is evaluated


def time_left(body: Body, state: np.ndarray, history: np.ndarray, load: np.ndarray, diameter: float) -> float:
    """Time from `state`, where a path ended, to the limit point ahead under Coulomb's law; infinite where
    none shows.

    There the determinant of Coulomb's tangent is zero. It falls with the way along the path, and that is
    the root of the time that is left: so left is half the time in which the determinant would vanish at
    the rate at hand.
    """
    here, rate = coulomb(body, state, history, load, diameter)
    if -NEAR_LIMIT < here <= 0.0:
        return 0.0
    if not here > 0.0:
        return np.inf
    small = MOVE * diameter / float(np.abs(rate).max())
    speed = body.distance(state, body.moved(state, rate, small)) / (small * diameter)
    first, last = (
        coulomb(body, body.moved(state, rate, distance / speed), history, load, diameter)[0]
        for distance in FALLS
    )
    if not last < first < NEAR_LIMIT:
        return np.inf
    return 0.5 * (FALLS[1] - FALLS[0]) / speed * first / (first - last)


def goes_on(body: Body, state: np.ndarray, history: np.ndarray, load: np.ndarray, diameter: float) -> bool:
    """Whether the determinant of Coulomb's tangent keeps its sign just ahead of `state`, where a path ended.

    Then no critical point shows there: it is the iteration on renewed bounds that ends.
    """
    _, rate = coulomb(body, state, history, load, diameter)
    states = (body.moved(state, rate, time) for time in AHEAD)
    return all(coulomb(body, there, history, load, diameter)[0] > 0.0 for there in states)


def coulomb(
    body: Body, state: np.ndarray, history: np.ndarray, load: np.ndarray, diameter: float
) -> tuple[float, np.ndarray]:
    """Determinant of Coulomb's tangent over the size of that of H, and the tangent's solution for `load`.

    Pairs at their bounds slide on.
    """
    history = history.copy()
    history["rise"] = 0.0
    body.update_pairs(state, history)
    held = np.flatnonzero(history["closed"] & (history["bound"] > 0.0))
    history["bound"][held] *= 1.0 - SLACK

    def bounds(step: np.ndarray) -> np.ndarray:
        size = MOVE * diameter / max(float(np.abs(step).max()), 1e-300)
        ends = history.copy(), history.copy()
        for end, factor in zip(ends, (size, -size), strict=True):
            body.update_pairs(body.moved(state, step, factor), end)
        return history["steepness"] * (ends[1]["gap"] - ends[0]["gap"]) / (2.0 * size)

    H, negative = body.factored(state, history)
    rate, here = body.solved(H, load), body.gradient(state, history)
    pairs, columns = [], []
    for m in held:
        lower = history.copy()
        lower["bound"][m] *= 1.0 - NUDGE
        force = (here - body.gradient(state, lower)) / (history["bound"][m] - lower["bound"][m])
        if np.abs(force).max() > SLIDES:
            pairs.append(m)
            columns.append(body.solved(H, force))
    if not pairs:
        return (-1.0) ** negative, rate
    M = np.eye(len(pairs)) + np.array([bounds(column)[pairs] for column in columns]).T
    rate = rate - np.array(columns).T @ np.linalg.solve(M, bounds(rate)[pairs])
    return (-1.0) ** negative * float(np.linalg.det(M)), rate
