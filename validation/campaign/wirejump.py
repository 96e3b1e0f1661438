"""Where a path jumps since a sticking pair opens: releases of the verifier's own lead to no equilibrium."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from coilspring import EquilibriumPath
from validation.campaign.poses import moved
from validation.campaign.runs import just_before, sharp_critical
from validation.campaign.scenes import Case
from validation.campaign.verdict import Verdict
from validation.campaign.wire import WireForces
from validation.campaign.wirepairs import Pairs
from validation.campaign.wireverifier import verify_balance

BEFORE = 1e-6  # share of the load by which the state lies before the jump
FIRST_STEP, LEAST_STEP = 1.0 / 16.0, 1e-4  # of what the opening pairs hold, released at a time
MOST_CORRECTIONS = 15
CLOSE = 1e-8  # wire diameters or rad: the last correction
FAR = 0.5  # wire diameters or rad that a step may move: more is no neighbour
OPEN = 1e-3  # wire diameters of penetration at most that are left of a pair just before it opens


def verify_jump(verdict: Verdict, forces: WireForces, case: Case, path: EquilibriumPath) -> None:
    """Just before, the pair must be held in balance; released, it must lead to no stable equilibrium."""
    sharp = sharp_critical(verdict, path)
    if sharp is None:
        return
    critical = sharp[0]
    for _, near in just_before(verdict, case, critical, [BEFORE]):
        verify_balance(verdict, forces, near)
        pairs, rows = forces.pairs(near, -1, forces.d), near.states[-1].reshape(-1, 7)
        if pairs is None or not (opening := _opening(pairs, rows)).any():
            verdict.complain(f"no sticking pair is about to open at the jump at {critical:.6g}")
            return
        if not forces.least_stiffness(rows, pairs) > 0.0:
            verdict.complain(f"unstable before the jump at {critical:.6g}")
        left = released(forces, pairs, opening, rows, near.loads[-1])
        verdict.numbers["jump"] = left
        if left == 0.0:
            verdict.complain(f"a release leads from the jump at {critical:.6g} to an equilibrium nearby")


def _opening(pairs: Pairs, rows: np.ndarray) -> np.ndarray:
    """Which pairs are about to open: held ones that hardly touch any more."""
    return pairs.held & (pairs.depth(rows) < OPEN * pairs.law.d)


def released(
    forces: WireForces, pairs: Pairs, opening: np.ndarray, rows: np.ndarray, load: np.ndarray
) -> float:
    """Share that is left of what opening pairs hold where releasing it loses the stable equilibrium, else 0.

    Pairs that open on the way are released from there on.
    """
    left, step, begins = 1.0, FIRST_STEP, np.where(opening, 1.0, np.inf)
    while left > 0.0:
        ahead = max(left - step, 0.0)
        share = np.where(np.isfinite(begins), ahead / np.where(np.isfinite(begins), begins, 1.0), 1.0)
        found = _settled(forces, replace(pairs, share=share), rows, load)
        if found is None:
            step *= 0.5
            if step < LEAST_STEP:
                return left
            continue
        rows, left, step = found, ahead, 2.0 * step
        opens = pairs.held & ~np.isfinite(begins) & (pairs.depth(rows) < 0.0)
        begins[opens] = max(left, LEAST_STEP)
    return 0.0


def _settled(forces: WireForces, pairs: Pairs, rows: np.ndarray, load: np.ndarray) -> np.ndarray | None:
    """Stable equilibrium next to a state, or None."""
    start, free = rows, forces.free
    for _ in range(MOST_CORRECTIONS):
        left = forces.residual(rows.ravel(), load, pairs).ravel()[free]
        J = forces.tangent(rows, pairs)
        move = np.zeros(forces.fixed.size)
        move[free] = np.linalg.solve(J, -left)
        size = np.abs(move.reshape(-1, 6) / [*[pairs.law.d] * 3, 1.0, 1.0, 1.0]).max()
        if not size < FAR:
            return None
        rows = moved(rows, move)
        if size <= CLOSE:
            far = np.linalg.norm(rows[:, :3] - start[:, :3], axis=1).max() > FAR * pairs.law.d
            return None if far or not forces.least_stiffness(rows, pairs) > 0.0 else rows
    return None
