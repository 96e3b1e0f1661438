"""The verifier of the wire model's jumps: a sticking pair that opens leads to no equilibrium nearby."""

import math
from collections.abc import Callable
from dataclasses import replace

import numpy as np
from scipy.optimize import brentq

from coilspring import EquilibriumPath
from validation.campaign import runs
from validation.campaign.overlap import ALLOWED, SEEN, excess
from validation.campaign.poses import motion, moved
from validation.campaign.scenes import Case
from validation.campaign.verdict import Verdict, reached, under
from validation.campaign.wire import WireForces
from validation.campaign.wirepairs import Pairs
from validation.campaign.wireverifier import verify_balance

JUST_BEFORE = (1e-6, 1e-5, 1e-4, 1e-3)  # shares of the load by which a state may lie before a jump
# Powers of two by which the stiffness is lowered that holds opening pairs, at first, at least and at most;
# and the share of it that counts as none: it may be that much stiffer than the spring.
FIRST_STEP, LEAST_STEP, MOST_STEP, NONE = 0.5, 1e-3, 4.0, 1e-10
# Wire diameters that one such step may move, and all steps together: more is no release but a jump.
NEAR, NEARBY = 0.05, 0.25
MOST_RELEASES, MOST_CORRECTIONS = 100, 40
LEVEL, LENGTH = 0.5, 1e-3  # share of the energy's slope that a whole step may leave; of a step, so exact
CLOSE = 1e-8  # wire diameters or rad: the last correction
FAR = 0.5  # wire diameters or rad that a step may move: more is no neighbour
OPEN = 1e-3  # wire diameters of penetration at most that are left of a pair just before it opens


def verify_jump(verdict: Verdict, forces: WireForces, case: Case, path: EquilibriumPath) -> None:
    """Just before, the pair must be held in balance; released, it must lead to no stable equilibrium."""
    critical = runs.sharp_critical(verdict, path)
    if critical is None:
        return
    # other substeps may jump a little earlier
    for share in JUST_BEFORE:
        time = critical * (1.0 - share)
        near = reached(case, under(case.scene, time))
        if near.outcome == "completed":
            break
    else:
        runs.ends_early(verdict, path, near, time)
        return
    verify_balance(verdict, forces, near)
    assert path.last_state is not None
    pairs, rows = forces.pairs(near, -1, forces.law.d), near.states[-1].reshape(-1, 7)
    depth = np.minimum(pairs.depth(rows), pairs.depth(path.last_state.reshape(-1, 7)))
    opens = pairs.held & (depth < OPEN * forces.law.d)
    if not opens.any():
        verdict.complain(f"no sticking pair opens at the jump at {critical:.6g}")
    elif not forces.least_stiffness(rows, pairs) > 0.0:
        verdict.complain(f"unstable before the jump at {critical:.6g}")
    else:
        load = near.loads[-1] if case.scene.load.displacement else critical * np.array(case.scene.load.force)
        held = _settled(forces, pairs, rows, load)
        left, last = released(forces, pairs, opens, rows if held is None else held, load)
        verdict.numbers["jump"] = left
        apart = excess(near, last.reshape(1, -1))[0] <= ALLOWED - SEEN  # else it is no state of a spring
        if left == 0.0 and apart:
            verdict.complain(f"a release leads from the jump at {critical:.6g} to an equilibrium nearby")
        elif math.isnan(left):
            verdict.complain(f"the release at the jump at {critical:.6g} was not followed to its end")


def released(
    forces: WireForces, pairs: Pairs, opening: np.ndarray, rows: np.ndarray, load: np.ndarray
) -> tuple[float, np.ndarray]:
    """Share that is left of the stiffness that holds opening pairs where lowering it further loses the stable
    equilibrium, or leads away from it; else 0, or NaN where too many steps do not tell. And the state there.

    Pairs that open on the way are released from there on.
    """
    left, step, start = 1.0, FIRST_STEP, rows
    width = np.maximum(forces.law.d, 2.0 * forces.points.arms(len(rows)))
    begins = np.where(opening, 1.0, np.nan)  # what was left of the others when a pair began to open
    for _ in range(MOST_RELEASES):
        ahead = left * 2.0**-step if left > NONE else 0.0
        share = np.where(np.isnan(begins), 1.0, ahead / begins)
        found = _settled(forces, replace(pairs, share=pairs.share * share), rows, load)
        if found is None or motion(found, rows, forces.law.d) > NEAR * forces.law.d:
            step *= 0.5
            if ahead == 0.0 or step < LEAST_STEP:
                return left, rows
            continue
        if motion(found, start, width) > NEARBY * forces.law.d:
            return left, rows
        rows, left, step = found, ahead, min(2.0 * step, MOST_STEP)
        opens = pairs.held & np.isnan(begins) & (pairs.depth(rows) < 0.0)
        begins[opens] = max(left, NONE)
        if left == 0.0:
            return 0.0, rows
    return math.nan, rows


def _settled(forces: WireForces, pairs: Pairs, rows: np.ndarray, load: np.ndarray) -> np.ndarray | None:
    """Stable equilibrium next to a state, or None, by Newton's method.

    Within a step hard pairs close and open: each goes down to the least energy along it. No pair slides here.
    """
    start = rows

    def unbalanced(state: np.ndarray) -> np.ndarray:
        return forces.residual(state, load, pairs)

    for _ in range(MOST_CORRECTIONS):
        move, size = forces.correction(rows, load, pairs)
        if size <= CLOSE:
            rows = moved(rows, move)
            far = np.linalg.norm(rows[:, :3] - start[:, :3], axis=1).max() > FAR * pairs.law.d
            return None if far or not forces.least_stiffness(rows, pairs) > 0.0 else rows
        if not size < FAR:
            return None
        rows = moved(rows, _length(unbalanced, rows, move) * move)
    return None


def _length(unbalanced: Callable[[np.ndarray], np.ndarray], rows: np.ndarray, move: np.ndarray) -> float:
    """Share of a step where the energy along it is least; 1 where no more than half of its slope is left at
    the end, or it rises from the start."""

    def slope(share: float) -> float:
        return float((unbalanced(moved(rows, share * move)) * move).sum())

    start, end = slope(0.0), slope(1.0)
    if not start < 0.0 or not end > -LEVEL * start:
        return 1.0
    return float(brentq(slope, 0.0, 1.0, rtol=LENGTH, disp=False))
