"""The verifier of the wire model's paths: forces in balance, friction within its bound, critical points."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from scipy.optimize import brentq

import wirefe
from coilspring import EquilibriumPath
from validation.campaign.runs import LOAD, SOLVER, just_before, largest_load, sharp_critical, verify_place
from validation.campaign.scenes import Case
from validation.campaign.slipping import highest_load, sliding_pairs
from validation.campaign.verdict import Verdict, under
from validation.campaign.wire import WireForces, friction_of
from validation.study.partialsolve import partial_path

BALANCE = 1e-5  # of the load at the worst node; the wire stretches up to 1e6 times less than the spring
BEFORE = (1e-6, 4e-6, 1.6e-5)  # shares of the load by which states lie before their critical point
BEFORE_SLIDING = 5e-3  # the same with coils that slide: limit points of other substeps lie within this share
BEFORE_SOFT = (2e-3, 8e-3, 1.8e-2)  # the same for the least stiffness: nearer it is rounding
SOFTENED = 1e-3  # within which it vanishes at the critical time
STRAIGHT = 0.99  # cosine between the moves towards a fold
POINTS = 300  # of an arc-length run
TURN = 5e-3  # of the load: how near the critical time a traced path has points


def verify_row(verdict: Verdict, forces: WireForces, path: EquilibriumPath, row: int) -> None:
    """Forces and moments of one state must balance at every node, friction stay within its bound."""
    time = float(path.times[row])
    friction = friction_of(path, row)
    contact = path.scene.contact
    # in a mode as stiff as a held pair, what solvers leave in the energy norm is this share of the load
    held = contact.stiffness * float(np.hypot(*path.tips[row, :2])) / largest_load(path, row)
    most = BALANCE if contact.sliding == "free" else max(BALANCE, SOLVER * math.sqrt(held))
    verify_balance(verdict, forces, path, row, most)
    if contact.sliding == "coulomb" and len(friction[0]):
        normal = contact.coefficient * path.contact_forces[row]
        excess = np.linalg.norm(friction[1], axis=1) - normal
        share = float(excess.max() / max(normal.max(), 1e-300))
        verdict.ask("friction", share, 1e-4, f"friction beyond its bound at time {time:.6g}")


def verify_balance(
    verdict: Verdict, forces: WireForces, path: EquilibriumPath, row: int = -1, most: float = BALANCE
) -> None:
    """One state's balance under the load, or with the reaction that the path reports."""
    left = forces.residual(path.states[row], path.loads[row], friction_of(path, row))
    left[:, 3:] /= float(np.abs(forces.arm[[0, 2]]).max())
    share = float(np.abs(left).max()) / largest_load(path, row)
    verdict.ask("residual", share, most, f"forces out of balance at time {path.times[row]:.6g}")
    if path.scene.load.displacement:
        verify_place(verdict, path, row, float(path.states[row][-6]))


def verify_wire_critical(verdict: Verdict, forces: WireForces, case: Case, path: EquilibriumPath) -> None:
    """Balanced states just before the critical time must tend to a fold there, or arc length must turn.

    Where friction follows the path, arc length is another one: what Coulomb's law alone tells is verified.
    """
    sharp, driven = sharp_critical(verdict, path), bool(case.scene.load.displacement)
    if sharp is None:
        return
    critical, sliding = sharp[0], case.scene.contact.sliding
    if sliding == "coulomb" and path.outcome == "limit_point" and not driven:
        _verify_slipping(verdict, forces, case, critical)
    if sliding != "free":
        return
    before = just_before(verdict, case, critical, BEFORE)
    for _, near in before:
        verify_balance(verdict, forces, near)
    if not before:
        return
    positions = [near.states[-1].reshape(-1, 7)[:, :3].ravel() for _, near in before]
    found = fold(positions, [time for time, _ in before])
    if found is not None:
        verdict.ask("confirmed", abs(found / critical - 1.0), LOAD, "states tend to a fold elsewhere")
    elif driven:
        _verify_softening(verdict, forces, case, critical)
    else:
        _verify_turn(verdict, case, critical)


def _verify_softening(verdict: Verdict, forces: WireForces, case: Case, critical: float) -> None:
    """The least stiffness of the constrained wire must tend to zero at the critical time: arc length would
    need a load."""
    before = just_before(verdict, case, critical, BEFORE_SOFT)
    if not before:
        return
    least = [forces.least_stiffness(near.states[-1].reshape(-1, 7)) for _, near in before]
    found = vanishing([time for time, _ in before], least)
    if min(least) <= 0.0:
        what = f"unstable before the critical time {critical:.6g}: least stiffness {min(least):.2e}"
        verdict.complain(what)
    elif found is None:
        verdict.complain(f"the least stiffness does not tend to zero near {critical:.6g}")
    else:
        share = abs(found / critical - 1.0)
        verdict.ask("confirmed", share, SOFTENED, "the least stiffness vanishes elsewhere")


def _verify_slipping(verdict: Verdict, forces: WireForces, case: Case, critical: float) -> None:
    """Where coils slide on each other before a limit point, Coulomb's law must reach its highest load
    there."""
    for time, before in just_before(verdict, case, critical, [BEFORE_SLIDING]):
        verify_balance(verdict, forces, before)
        if not sliding_pairs(forces, before).any():
            return
        highest = highest_load(forces, before, time, critical)
        if highest is None:
            verdict.complain(f"Coulomb's law reaches no highest load near {critical:.6g}")
            return
        share = abs(highest / critical - 1.0)
        verdict.ask("confirmed", share, BEFORE_SLIDING, "the load is highest elsewhere")


def fold(positions: Sequence[np.ndarray], times: Sequence[float]) -> float | None:
    """Time of the fold that three equilibria tend to, the latest first; None where they tend to none.

    Before a fold at T the state moves along one mode as the root of T - t.
    """
    last, first = positions[0] - positions[1], positions[1] - positions[2]
    moves = float(np.linalg.norm(last)), float(np.linalg.norm(first))
    if last @ first < STRAIGHT * moves[0] * moves[1]:
        return None

    def excess(T: float) -> float:
        a, b, c = (math.sqrt(T - time) for time in times)
        return (b - a) / (c - b) - moves[0] / moves[1]

    low, high = times[0], times[0] + (times[0] - times[2])
    if excess(low) * excess(high) > 0.0:
        return None
    return float(brentq(excess, low, high))


def vanishing(times: Sequence[float], least: Sequence[float]) -> float | None:
    """Time at which a stiffness vanishes that falls over the three times given, the latest first.

    Next to a bifurcation it falls as the time left, next to a fold as its root: the power which a straight
    line through the first and last fits best in the middle is taken; None where it falls otherwise.
    """
    found = []
    for power in (1.0, 2.0):
        a, b, c = (value**power for value in least)
        slope = (a - c) / (times[0] - times[2])
        if slope >= 0.0:
            continue
        bend = abs(b - c - slope * (times[1] - times[2])) / abs(a - c)
        roots = np.roots(np.polyfit(np.array(times) - times[0], [a, b, c], 2))
        ahead = roots[(roots.imag == 0.0) & (roots.real >= 0.0)].real
        if ahead.size:
            found.append((bend, times[0] + float(ahead.min())))
    return min(found)[1] if found else None


def _verify_turn(verdict: Verdict, case: Case, critical: float) -> None:
    """The traced path must be stable up to the critical time and not beyond."""
    traced = partial_path(
        wirefe.trace, under(case.scene, 1.05 * critical), points=POINTS, **dict(case.options)
    )
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
