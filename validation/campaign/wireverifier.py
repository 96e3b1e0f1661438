"""The verifier of the wire model's paths: forces in balance, contact as reported, critical points."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from scipy.optimize import brentq

import wirefe
from coilspring import EquilibriumPath
from validation.campaign.runs import (
    FRICTION_TIME,
    LOAD,
    SOLVER,
    force_grain,
    just_before,
    largest_load,
    path_dependent,
    sharp_critical,
    verify_place,
)
from validation.campaign.scenes import Case
from validation.campaign.verdict import Verdict, under
from validation.campaign.wire import WireForces
from validation.campaign.wirepairs import known_pairs
from validation.study.partialsolve import partial_path

BALANCE = 1e-5  # of the load at the worst node; the wire stretches up to 1e6 times less than the spring
BEFORE = (1e-6, 4e-6, 1.6e-5)  # shares of the load by which states lie before their critical point
# The same for the least stiffness, which is smooth there: until a pair opens or closes.
BEFORE_SOFT = ((2e-3, 8e-3, 1.8e-2), (5e-4, 2e-3, 4.5e-3), (1e-4, 4e-4, 9e-4))
WHOLE = 1e-8  # of the largest force: contact must not pull or turn the whole wire
AS_REPORTED = 1e-4  # of the load or the largest force of contact
SOFTENED = 1e-3  # within which it vanishes at the critical time
STRAIGHT = 0.99  # cosine between the moves towards a fold
POINTS = 300  # of an arc-length run
TURN = 5e-3  # of the load: how near the critical time a traced path has points


def verify_row(verdict: Verdict, forces: WireForces, path: EquilibriumPath, row: int) -> None:
    """Forces and moments of one state must balance at every node, contact be as reported, and the state be
    stable."""
    time, rows = float(path.times[row]), path.states[row].reshape(-1, 7)
    # in a mode as stiff as a held pair, what solvers leave in the energy norm is this share of the load
    contact = path.scene.contact
    held = contact.stiffness * float(np.hypot(*path.tips[row, :2])) / largest_load(path, row)
    most = BALANCE if contact.sliding == "free" else max(BALANCE, SOLVER * math.sqrt(held))
    pairs = forces.pairs(path, row)
    verify_balance(verdict, forces, path, row, most)
    if pairs is not None:
        verify_contact(verdict, forces, path, row)
        pairs = pairs.renewed(rows)
    least = forces.least_stiffness(rows, pairs)
    verdict.numbers["least"] = min(least, verdict.numbers.get("least", least))
    if not least > 0.0:
        verdict.complain(f"unstable at time {time:.6g}: least stiffness {least:.2e} of that at rest")


def verify_contact(verdict: Verdict, forces: WireForces, path: EquilibriumPath, row: int) -> None:
    """Contact forces must be those reported, Coulomb's law included, and all pairs be known."""
    assert forces.law is not None
    pairs = known_pairs(forces.points, forces.law, forces.rest, path, row)
    normal, tangential = pairs.forces(path.states[row].reshape(-1, 7))
    count, time = path.contact_forces.shape[1], float(path.times[row])
    if (normal[count:] > 0.0).any():
        verdict.complain(f"pairs that touch are left out at time {time:.6g}")
    load = largest_load(path, row)
    for name, mine, theirs, what in (
        ("normal", normal[:count, None], path.contact_forces[row][:, None], "normal forces"),
        ("friction", tangential[:count], path.friction.force[row], "friction"),
    ):
        size = max(load, float(np.abs(mine).max(initial=0.0)))
        share = float(np.abs(mine - theirs).max(initial=0.0)) / size
        verdict.ask(name, share, max(AS_REPORTED, force_grain(path)), f"other {what} at time {time:.6g}")


def verify_balance(
    verdict: Verdict, forces: WireForces, path: EquilibriumPath, row: int = -1, most: float = BALANCE
) -> None:
    """One state's balance under the load, or with the reaction that the path reports."""
    state, arm = path.states[row], float(np.abs(forces.arms[1, [0, 2], -1]).max())
    pairs = forces.pairs(path, row)
    left = forces.residual(state, path.loads[row], pairs)
    left[:, 3:] /= arm
    share = float(np.abs(left).max()) / largest_load(path, row)
    most = max(most, force_grain(path))
    verdict.ask("residual", share, most, f"forces out of balance at time {path.times[row]:.6g}")
    contact = path.scene.contact
    if pairs is not None and (contact.geometry == "wires" or contact.sliding == "free"):
        # tangential forces of spheres act at their centres, and leave a couple
        whole = float(
            np.abs(resultant(state.reshape(-1, 7), pairs.gradient(state.reshape(-1, 7)), arm)).max()
        )
        size = max(largest_load(path, row), float(np.abs(path.contact_forces[row]).max(initial=0.0)))
        verdict.ask("whole", whole / size, WHOLE, f"contact pulls the wire at time {path.times[row]:.6g}")
    if path.scene.load.displacement:
        verify_place(verdict, path, row, float(path.states[row][-6]))


def resultant(rows: np.ndarray, forces: np.ndarray, arm: float) -> np.ndarray:
    """Resultant force, and moment over an arm, (6,), of forces and moments (nodes, 6)."""
    force, moment = forces[:, :3], forces[:, 3:] + np.cross(rows[:, :3], forces[:, :3])
    return np.concatenate((force.sum(axis=0), moment.sum(axis=0) / arm))


def verify_wire_critical(verdict: Verdict, forces: WireForces, case: Case, path: EquilibriumPath) -> None:
    """Balanced states just before the critical time must tend to a fold there, or the least stiffness must
    vanish, or arc length turn."""
    sharp, driven = sharp_critical(verdict, path), bool(case.scene.load.displacement)
    if sharp is None:
        return
    critical = sharp[0]
    if path_dependent(case.scene, case.model):
        _verify_softening(verdict, forces, case, critical)
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
    """The least stiffness must tend to zero at the critical time: of the wire with its top where it is
    prescribed, and of one whose coils stick or slide, by Coulomb's unsymmetric tangent."""
    found: list[float] = []
    # the critical time of a path with friction itself depends on its substeps by as much
    most = FRICTION_TIME if path_dependent(case.scene, case.model) else SOFTENED
    for shares in BEFORE_SOFT:
        before = just_before(verdict, case, critical, shares)
        if not before:
            return
        least = []
        for _, near in before:
            rows, pairs = near.states[-1].reshape(-1, 7), forces.pairs(near, -1)
            least.append(forces.least_stiffness(rows, None if pairs is None else pairs.renewed(rows)))
        if min(least) <= 0.0:
            what = f"unstable before the critical time {critical:.6g}: least stiffness {min(least):.2e}"
            verdict.complain(what)
            return
        place = vanishing([time for time, _ in before], least)
        found += [] if place is None else [abs(place / critical - 1.0)]
        if found and min(found) <= most:
            break
    if found:
        verdict.ask("confirmed", min(found), most, "the least stiffness vanishes elsewhere")
    else:
        verdict.complain(f"the least stiffness does not tend to zero near {critical:.6g}")


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
