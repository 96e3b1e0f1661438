"""Judge of the wire model's paths: forces in balance, friction within its bound, branch, critical points."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from scipy.optimize import brentq

import wirefe
from coilspring import EquilibriumPath
from validation.campaign.judge import (
    LOAD,
    SOLVER,
    apart,
    judge_branch,
    just_before,
    remembered,
    sharp_critical,
)
from validation.campaign.overlap import judge_apart
from validation.campaign.scenes import Case
from validation.campaign.slipping import highest_load, sliding_pairs
from validation.campaign.verdict import CRITICAL, THROUGH, Verdict, ended, fine_steps, reached, under
from validation.campaign.wire import WireForces, friction_of, wire_forces
from validation.reached import as_far

BALANCE = 1e-5  # of the load at the worst node; the wire stretches up to 1e6 times less than the spring
# difference from the fine run over the largest displacement; with friction it depends on the substeps
BRANCH = {"free": 1e-6, "none": 2e-2, "coulomb": 2e-2}
BETWEEN = 1e-4  # where a column passes its buckling load all but neutral, before the last common state
CRITICAL_SHIFT = {"free": LOAD, "none": 2e-2, "coulomb": 2e-2}
ROWS = 3
BEFORE = (1e-6, 4e-6, 1.6e-5)  # shares of the load by which states lie before their critical point
BEFORE_SLIDING = 5e-3  # the same with coils that slide: limit points of other substeps lie within this share
STRAIGHT = 0.99  # cosine between the moves towards a fold
POINTS = 300  # of an arc-length run
TURN = 5e-3  # of the load: how near the critical time a traced path has points


def judge_wire(case: Case, path: EquilibriumPath) -> Verdict:
    """Judge a path of the wire model, complete or not."""
    verdict, sliding = Verdict(), case.scene.contact.sliding
    if path.outcome not in ("completed", THROUGH, *CRITICAL) and not ended(path):
        verdict.complain(f"{path.outcome}: {path.message}")
        return verdict
    forces = wire_forces(case.scene, **dict(case.options))  # type: ignore[arg-type]
    count = len(path.times)
    for row in sorted({count - 1 - (count * k) // ROWS for k in range(ROWS)} & set(range(count))):
        judge_row(verdict, forces, path, row)
    judge_apart(verdict, path)
    fine, compared = reached(case, steps=fine_steps(case)), Verdict()
    if ended(path) or ended(fine):
        compared.ask("branch", apart(path, fine)[1], BRANCH[sliding], "off the branch of the fine run")
    else:
        judge_branch(compared, path, fine, BRANCH[sliding], CRITICAL_SHIFT[sliding], BETWEEN)
    verdict.take(compared, bool(compared.differences) and remembered(case, path, fine))
    if path.outcome in CRITICAL:
        _judge_critical(verdict, forces, case, path)
    return verdict


def judge_row(verdict: Verdict, forces: WireForces, path: EquilibriumPath, row: int) -> None:
    """Forces and moments of one state must balance at every node, friction stay within its bound."""
    time = float(path.times[row])
    friction = friction_of(path, row)
    contact = path.scene.contact
    # in a mode as stiff as a held pair, what solvers leave in the energy norm is this share of the load
    held = contact.stiffness * float(np.hypot(*path.tips[row, :2])) / (time * float(np.hypot(*forces.load)))
    most = BALANCE if contact.sliding == "free" else max(BALANCE, SOLVER * math.sqrt(held))
    judge_balance(verdict, forces, path.states[row], time, friction, most)
    if contact.sliding == "coulomb" and len(friction[0]):
        normal = contact.coefficient * path.contact_forces[row]
        excess = np.linalg.norm(friction[1], axis=1) - normal
        share = float(excess.max() / max(normal.max(), 1e-300))
        verdict.ask("friction", share, 1e-4, f"friction beyond its bound at time {time:.6g}")


def judge_balance(
    verdict: Verdict,
    forces: WireForces,
    state: np.ndarray,
    time: float,
    friction: tuple[np.ndarray, np.ndarray],
    most: float = BALANCE,
) -> None:
    """One state's balance."""
    left = forces.residual(state, time, friction)
    left[:, 3:] /= float(np.abs(forces.arm[[0, 2]]).max())
    share = float(np.abs(left).max() / (time * np.hypot(*forces.load)))
    verdict.ask("residual", share, most, f"forces out of balance at time {time:.6g}")


def _judge_critical(verdict: Verdict, forces: WireForces, case: Case, path: EquilibriumPath) -> None:
    """Balanced states just before the critical time must tend to a fold there, or arc length must turn."""
    sharp = sharp_critical(verdict, path)
    if sharp is None:
        return
    critical, _ = sharp
    if case.scene.contact.sliding == "coulomb" and path.outcome == "limit_point":
        _judge_slipping(verdict, forces, case, critical)
    if case.scene.contact.sliding != "free":
        return  # judged by the fine run: where friction follows the path, arc length is another one
    positions = []
    for share in BEFORE:
        time = critical * (1.0 - share)
        before = just_before(verdict, case, critical, time)
        if before is None:
            return
        judge_balance(verdict, forces, before.states[-1], time, friction_of(before, -1))
        positions.append(before.states[-1].reshape(-1, 7)[:, :3].ravel())
    found = fold(positions, [critical * (1.0 - share) for share in BEFORE])
    if found is None:
        _judge_turn(verdict, case, critical)
    else:
        verdict.ask("confirmed", abs(found / critical - 1.0), LOAD, "states tend to a fold elsewhere")


def _judge_slipping(verdict: Verdict, forces: WireForces, case: Case, critical: float) -> None:
    """Where coils slide on each other before a limit point, Coulomb's law must reach its highest load
    there."""
    time = critical * (1.0 - BEFORE_SLIDING)
    before = just_before(verdict, case, critical, time)
    if before is None:
        return
    judge_balance(verdict, forces, before.states[-1], time, friction_of(before, -1))
    if not sliding_pairs(forces, before).any():
        return
    highest = highest_load(forces, before, time, critical)
    if highest is None:
        verdict.complain(f"Coulomb's law reaches no highest load near {critical:.6g}")
        return
    verdict.ask("confirmed", abs(highest / critical - 1.0), BEFORE_SLIDING, "the load is highest elsewhere")


def fold(positions: Sequence[np.ndarray], times: Sequence[float]) -> float | None:
    """Time of the fold that three equilibria tend to, the latest first; None where they tend to none.

    Before a fold at T the state moves along one mode as the root of T - t.
    """
    last, first = positions[0] - positions[1], positions[1] - positions[2]
    ways = float(np.linalg.norm(last)), float(np.linalg.norm(first))
    if last @ first < STRAIGHT * ways[0] * ways[1]:
        return None

    def excess(T: float) -> float:
        a, b, c = (math.sqrt(T - time) for time in times)
        return (b - a) / (c - b) - ways[0] / ways[1]

    low, high = times[0], times[0] + (times[0] - times[2])
    if excess(low) * excess(high) > 0.0:
        return None
    return float(brentq(excess, low, high))


def _judge_turn(verdict: Verdict, case: Case, critical: float) -> None:
    """The traced path must be stable up to the critical time and not beyond."""
    traced = as_far(wirefe.trace, under(case.scene, 1.05 * critical), points=POINTS, **dict(case.options))
    times = 1.05 * critical * traced.times
    assert traced.negative_pivots is not None
    unstable = np.flatnonzero(traced.negative_pivots)
    if not unstable.size:
        verdict.complain(f"arc length finds no critical point near {critical:.6g}, last time {times[-1]:.6g}")
        return
    turn = int(unstable[0])
    highest = float(times[: turn + 1].max())
    passed = float(times[:turn].max(initial=0.0)) / critical - 1.0
    verdict.ask("passed", passed, LOAD, "arc length is stable beyond the critical time")
    verdict.ask("confirmed", 1.0 - highest / critical, TURN, "arc length turns elsewhere")
