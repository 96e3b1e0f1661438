"""The verifier's own steps along a path with Coulomb friction, to where the wire loses its stability.

Next to such a point the directions in which pairs slide turn ever faster, and the stiffness falls within the
last thousandth of the load: it cannot be extrapolated from farther away.
"""

from dataclasses import replace

import numpy as np

from coilspring import EquilibriumPath
from validation.campaign.poses import motion, moved
from validation.campaign.wire import WireForces
from validation.campaign.wirepairs import Pairs

# Shares of the load: the longest step, and that below which none is tried; how one that fails is shortened.
LONGEST, SHORTEST, SHORTER = 2e-4, 1e-7, 0.25
MOST_STEPS, MOST_CORRECTIONS = 80, 12
CLOSE, FAR = 1e-9, 0.05  # wire diameters or rad: the last correction, and the most of one
REACH = 1.0  # wire diameters: farther pairs are not looked at,
NEARBY = 0.05  # and by so much a step may move the wire
OVER = 1e-9  # of its bound: with so much more a pair slides
SOFTENED = 0.2  # of the stiffness at the start: no more is left before it vanishes


def loses_stability(forces: WireForces, path: EquilibriumPath, most: float) -> float | None:
    """Factor of a path's last load or displacement at which Coulomb's law loses its stable equilibrium; None
    where that is not seen up to the factor `most`, or another pair touches before.

    Steps of the implicit Euler method, shorter where one fails. At the end little is left of the stiffness,
    or the next step, however short, makes it negative, or a sliding pair is about to open, without which
    it is.
    """
    start = rows = path.states[-1].reshape(-1, 7)
    pairs = forces.pairs(path, -1, REACH * forces.law.d)
    before, last = rows, LONGEST  # the state before, and the step from there
    factor, step, left = 1.0, LONGEST, [forces.least_stiffness(rows, pairs.renewed(rows))]
    for _ in range(MOST_STEPS):
        ahead = rows.copy()
        ahead[-1, 1] += step * sum(path.scene.load.displacement)
        found = _settled(forces, pairs.renewed(rows), ahead, (factor + step) * path.loads[-1])
        if found is not None and motion(found[0], rows, forces.law.d) > NEARBY * forces.law.d:
            found = None
        beyond = -np.inf if found is None else forces.least_stiffness(found[0], found[1].renewed(found[0]))
        if found is not None and beyond > 0.0:
            before, last, factor = rows, step, factor + step
            (rows, pairs), step = found, min(2.0 * step, LONGEST)
            left.append(beyond)
            far = motion(rows, start, forces.law.d) > 0.5 * REACH * forces.law.d
            if factor > most or far or (~pairs.held & (pairs.depth(rows) > 0.0)).any():
                return None
        elif step < SHORTEST:
            ends = len(left) > 1 and (found is not None or left[-1] <= SOFTENED * left[0])
            return factor if ends or _opens(forces, pairs.renewed(rows), rows, before, last) else None
        else:
            step *= SHORTER
    return None


def _opens(forces: WireForces, pairs: Pairs, rows: np.ndarray, before: np.ndarray, step: float) -> bool:
    """Whether a sliding pair opens within the shortest step, as the last one tells, and the wire is unstable
    without it."""
    opens = pairs.slides & (step * pairs.steps_to_opening(rows, before) <= SHORTEST)
    return bool(opens.any()) and forces.least_stiffness(rows, pairs.of(~opens)) < 0.0


def _settled(
    forces: WireForces, pairs: Pairs, rows: np.ndarray, load: np.ndarray
) -> tuple[np.ndarray, Pairs] | None:
    """Equilibrium near a state, and which pairs slide in it, or None where Newton's method finds none."""
    for _ in range(MOST_CORRECTIONS):
        pairs = replace(pairs, slides=_slides(pairs, rows))
        move, size = forces.correction(rows, load, pairs)
        rows = moved(rows, FAR / max(size, FAR) * move)
        if size <= CLOSE:
            return rows, replace(pairs, slides=_slides(pairs, rows))
    return None


def _slides(pairs: Pairs, rows: np.ndarray) -> np.ndarray:
    """Pairs of which sticking, from where they are renewed, would take more than the bound."""
    if pairs.law.mu == np.inf:
        return np.zeros_like(pairs.held)
    normal, force = replace(pairs, slides=np.zeros_like(pairs.slides)).forces(rows)
    bound = pairs.law.mu * normal
    return pairs.held & (np.linalg.norm(force, axis=1) > (1.0 + OVER) * bound)
