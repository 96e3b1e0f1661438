"""Where a path jumps since a sticking pair opens: releases of the verifier's own lead to no equilibrium."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from coilspring import EquilibriumPath
from validation.campaign.poses import moved
from validation.campaign.runs import sharp_critical
from validation.campaign.scenes import Case
from validation.campaign.verdict import Verdict, reached, under
from validation.campaign.wire import WireForces
from validation.campaign.wirepairs import Pairs
from validation.campaign.wireverifier import verify_balance

BEFORE = (1e-6, 1e-5, 1e-4, 1e-3)  # shares of the load by which a state may lie before the jump
FIRST_STEP, LEAST_STEP = 1.0 / 16.0, 1e-4  # of what the opening pairs hold, released at a time
MOST_CORRECTIONS = 15
CLOSE = 1e-8  # wire diameters or rad: the last correction
FAR = 0.5  # wire diameters or rad that a step may move: more is no neighbour
OPEN = 1e-3  # wire diameters of penetration at most that are left of a pair just before it opens


def verify_jump(verdict: Verdict, forces: WireForces, case: Case, path: EquilibriumPath) -> None:
    """Just before, the pair must be held in balance; released, it must lead to no stable equilibrium."""
    sharp, near = sharp_critical(verdict, path), None
    if sharp is None:
        return
    assert path.last_state is not None
    for share in BEFORE:  # other substeps may jump a little earlier
        near = reached(case, under(case.scene, sharp[0] * (1.0 - share)))
        if near.outcome == "completed":
            break
    else:
        verdict.complain(f"no equilibrium just before the jump at {sharp[0]:.6g}")
        return
    verify_balance(verdict, forces, near)
    pairs, rows = forces.pairs(near, -1, forces.d), near.states[-1].reshape(-1, 7)
    if pairs is None:
        verdict.complain("a jump without contact")
        return
    ends = path.last_state.reshape(-1, 7)
    opening = pairs.held & (np.minimum(pairs.depth(rows), pairs.depth(ends)) < OPEN * forces.d)
    if not opening.any():
        verdict.complain(f"no sticking pair opens at the jump at {sharp[0]:.6g}")
    elif not forces.least_stiffness(rows, pairs) > 0.0:
        verdict.complain(f"unstable before the jump at {sharp[0]:.6g}")
    else:
        load = near.loads[-1] if case.scene.load.displacement else sharp[0] * np.array(case.scene.load.force)
        held = _settled(forces, pairs, rows, load)
        left = released(forces, pairs, opening, rows if held is None else held, load)
        verdict.numbers["jump"] = left
        if left == 0.0:
            verdict.complain(f"a release leads from the jump at {sharp[0]:.6g} to an equilibrium nearby")


def released(
    forces: WireForces, pairs: Pairs, opening: np.ndarray, rows: np.ndarray, load: np.ndarray
) -> float:
    """Share that is left of what opening pairs hold where releasing it loses the stable equilibrium, or leads
    away from it by a wire diameter; else 0.

    Pairs that open on the way are released from there on.
    """
    start = rows
    left, step, begins = 1.0, FIRST_STEP, np.where(opening, 1.0, np.inf)
    while left > 0.0:
        ahead = max(left - step, 0.0)
        share = np.where(np.isfinite(begins), ahead / np.where(np.isfinite(begins), begins, 1.0), 1.0)
        found = _settled(forces, replace(pairs, share=share), rows, load)
        if found is None or np.abs(found - start)[:, :3].max() > forces.d:
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
