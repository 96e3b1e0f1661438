"""The verifier of the wire model's paths: forces in balance, contact as reported, critical points."""

import math
from collections.abc import Iterator, Sequence

import numpy as np
from scipy.optimize import brentq

import wirefe
from coilspring import EquilibriumPath
from validation.campaign import runs
from validation.campaign.coulombend import loses_stability
from validation.campaign.scenes import Case
from validation.campaign.verdict import Verdict, under
from validation.campaign.wire import WireForces
from validation.campaign.wirepairs import known_pairs
from validation.study.partialsolve import partial_path

BALANCE = 1e-5  # of the load at the worst node; the wire stretches up to 1e6 times less than the spring
# Shares of the load by which states lie before their critical point: a pair may close or open near it.
BEFORE = ((1e-6, 4e-6, 1.6e-5), (1e-7, 4e-7, 1.6e-6), (3e-8, 1.2e-7, 4.8e-7))
# The same for the least stiffness, which is smooth there: until a pair opens or closes.
BEFORE_SOFT = ((2e-3, 8e-3, 1.8e-2), (5e-4, 2e-3, 4.5e-3), (1e-4, 4e-4, 9e-4))
# Least stiffness next to a critical point. There the last step along the soft mode, taken after the stop
# test, leaves hard pairs out of balance by second order: by up to so many times what is left elsewhere.
SOFT, BENT = 1e-5, 3.0
WHOLE = 1e-8  # of the largest force: contact must not pull or turn the whole wire
AS_REPORTED = 1e-4  # of the load or the largest force of contact
SOFTENED = 1e-3  # within which it vanishes at the critical time
STRAIGHT = 0.99  # cosine between the moves towards a fold
POINTS = 300  # of an arc-length run
TURN = 5e-3  # of the load: how near the critical time a traced path has points


def verify_row(verdict: Verdict, forces: WireForces, path: EquilibriumPath, row: int) -> None:
    """One state must balance at every node and be stable, and contact be as reported."""
    verify_balance(verdict, forces, path, row)
    if path.scene.contact.enabled:
        verify_contact(verdict, forces, path, row)
    verdict.stable(forces.stiffness_of(path, row), float(path.times[row]))


def verify_contact(verdict: Verdict, forces: WireForces, path: EquilibriumPath, row: int) -> None:
    """Contact forces must be those reported, Coulomb's law included, and all pairs be known."""
    pairs = known_pairs(forces.points, forces.law, forces.rest, path, row)
    normal, tangential = pairs.forces(path.states[row].reshape(-1, 7))
    count, time = path.contact_forces.shape[1], float(path.times[row])
    if (normal[count:] > 0.0).any():
        verdict.complain(f"pairs that touch are left out at time {time:.6g}")
    for name, mine, theirs, what in (
        ("normal", normal[:count], path.contact_forces[row], "normal forces"),
        ("friction", tangential[:count], path.friction.force[row], "friction"),
    ):
        size = max(runs.largest_load(path, row), float(np.abs(mine).max(initial=0.0)))
        share = float(np.abs(mine - theirs).max(initial=0.0)) / size
        verdict.ask(
            name, share, max(AS_REPORTED, runs.force_grain(path, row)), f"other {what} at time {time:.6g}"
        )


def verify_balance(verdict: Verdict, forces: WireForces, path: EquilibriumPath, row: int = -1) -> None:
    """One state's balance under the load, or with the reaction that the path reports."""
    rows, load, time = path.states[row].reshape(-1, 7), runs.largest_load(path, row), path.times[row]
    contact, most = path.scene.contact, BALANCE
    if contact.enabled:
        # at a node that the coils on both sides touch, what solvers leave in the energy norm is this share of
        # the load
        stiff = 2.0 * forces.law.sticking * float(np.hypot(*path.tips[row, :2])) / load
        most = max(BALANCE, runs.SOLVER * math.sqrt(stiff))
    arm = float(np.abs(forces.arms[1, [0, 2], -1]).max())
    pairs = forces.pairs(path, row)
    guided = bool(path.scene.load.displacement)
    left = forces.residual(rows, path.loads[row], pairs, guided)
    left[:, 3:] /= arm
    share, most = float(np.abs(left).max()) / load, max(most, runs.force_grain(path, row))
    if share > most and 0.0 < forces.least_stiffness(rows, pairs) < SOFT:
        most *= BENT
    verdict.ask("residual", share, most, f"forces out of balance at time {time:.6g}")
    if contact.enabled and (contact.geometry == "wires" or contact.sliding == "free"):
        # tangential forces of spheres act at their centres, and leave a couple
        force, moment = np.split(pairs.gradient(rows), 2, axis=1)
        moment = (moment + np.cross(rows[:, :3], force)).sum(axis=0) / arm
        whole = float(np.abs([*force.sum(axis=0), *moment]).max())
        size = max(load, float(np.abs(path.contact_forces[row]).max(initial=0.0)))
        verdict.ask("whole", whole / size, WHOLE, f"contact pulls the wire at time {time:.6g}")
    if path.scene.load.displacement:
        runs.verify_place(verdict, path, row, float(rows[-1, 1]))


def verify_wire_critical(verdict: Verdict, forces: WireForces, case: Case, path: EquilibriumPath) -> None:
    """Balanced states just before must tend to a fold there, or a pair open without which the wire is
    unstable, or arc length turn, or the least stiffness vanish."""
    critical = runs.sharp_critical(verdict, path)
    if critical is None:
        return
    if runs.path_dependent(case):
        _verify_softening(verdict, forces, case, path)
        return
    found = None
    for shares in BEFORE:
        if found is not None or shares[0] * critical < (path.critical_bracket or 0.0):
            continue
        before = runs.just_before(verdict, case, path, shares)
        for near in before:
            verify_balance(verdict, forces, near)
        if not before:
            return
        positions = [near.states[-1].reshape(-1, 7)[:, :3].ravel() for near in before]
        times = [critical * (1.0 - share) for share in shares]
        found = fold(positions, times)
        if found is None:
            found = kink(forces, before, times, critical * (1.0 + shares[0]))
    if found is not None:
        verdict.ask("confirmed", abs(found / critical - 1.0), runs.LOAD, "states tend to a fold elsewhere")
    elif case.scene.load.displacement:
        _verify_softening(verdict, forces, case, path)
    else:
        _verify_turn(verdict, forces, case, path)


def _verify_softening(verdict: Verdict, forces: WireForces, case: Case, path: EquilibriumPath) -> None:
    """The wire, with its top where it is prescribed, must lose its stability at the critical time: by
    Coulomb's unsymmetric tangent where its coils stick or slide."""
    assert path.critical_time is not None
    critical, off = path.critical_time, math.inf
    # the critical time of a path with friction itself depends on its substeps by as much
    most = runs.FRICTION_TIME if runs.path_dependent(case) else SOFTENED
    before = len(verdict.complaints) + len(verdict.others)
    for time in _unstable_times(verdict, forces, case, path, most):
        off = min(off, abs(time / critical - 1.0))
        if off <= most:
            break
    if len(verdict.complaints) + len(verdict.others) > before:
        return
    said = path.undecided_time
    if off > most and said is not None and abs(said / critical - 1.0) <= runs.LOAD:
        verdict.others.append(path)  # it says that it may go on from there, with other forces
    elif off < math.inf:
        verdict.ask("confirmed", off, most, "the wire loses its stability elsewhere")
    else:
        verdict.complain(f"the least stiffness does not tend to zero near {critical:.6g}")


def _unstable_times(
    verdict: Verdict, forces: WireForces, case: Case, path: EquilibriumPath, most: float
) -> Iterator[float]:
    """Times at which the wire loses its stability: the least stiffness vanishes, as states tell that come
    ever nearer to the critical time; or, where coils stick or slide, it is lost in the verifier's own steps,
    up to a share `most` beyond that time."""
    assert path.critical_time is not None
    critical = path.critical_time
    nearest: list[tuple[float, EquilibriumPath]] = []  # the last states, each a share of the time before
    for shares in BEFORE_SOFT:
        before = runs.just_before(verdict, case, path, shares)
        if not before:
            break  # with friction one of them ends before
        least = [forces.stiffness_of(near) for near in before]
        if min(least) <= 0.0:
            where = f"the critical time {critical:.6g}"
            verdict.complain(f"unstable before {where}: least stiffness {min(least):.2e}")
            return
        times = [critical * (1.0 - share) for share in shares]
        found = vanishing(times, least)
        if found is not None:
            yield found
        nearest.insert(0, (shares[0], before[0]))
    if runs.path_dependent(case):
        for share, near in nearest:
            factor = loses_stability(forces, near, (1.0 + most) / (1.0 - share))
            if factor is not None:
                yield critical * factor * (1.0 - share)


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


def kink(
    forces: WireForces, before: Sequence[EquilibriumPath], times: Sequence[float], end: float
) -> float | None:
    """Time, up to an `end` just ahead, at which pairs open without which the wire is unstable; else None.

    There the path has a kink, beyond which it goes back. A pair's force falls to zero in proportion to the
    time left: it is extrapolated from two equilibria, the latest first.
    """
    pairs = forces.pairs(before[0], -1)
    rows = [near.states[-1].reshape(-1, 7) for near in before[:2]]
    left = (times[0] - times[1]) * pairs.steps_to_opening(*rows)
    opens = times[0] + left <= end
    if not opens.any() or forces.least_stiffness(rows[0], pairs.of(~opens)) >= 0.0:
        return None
    return times[0] + float(left.min())


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


def _verify_turn(verdict: Verdict, forces: WireForces, case: Case, path: EquilibriumPath) -> None:
    """The traced path must be stable up to the critical time and not beyond.

    Where none of its states is unstable the least stiffness must tend to zero: it ends before, or a step led
    past a bifurcation onto the branch that is stable beyond. Past a limit point there is none.
    """
    assert path.critical_time is not None
    critical = path.critical_time
    scene = under(case.scene, 1.05 * critical)
    traced = partial_path(wirefe.trace, scene, points=POINTS, **dict(case.options))
    times = 1.05 * critical * traced.times
    assert traced.negative_pivots is not None
    unstable = np.flatnonzero(traced.negative_pivots)
    if not unstable.size and times.max(initial=0.0) >= critical and path.outcome == "limit_point":
        verdict.complain(f"arc length finds no limit point near {critical:.6g}, last time {times[-1]:.6g}")
        return
    if not unstable.size:
        _verify_softening(verdict, forces, case, path)
        return
    turn = int(unstable[0])
    passed = float(times[:turn].max(initial=0.0)) / critical - 1.0
    verdict.ask("passed", passed, runs.LOAD, "arc length is stable beyond the critical time")
    highest = float(times[: turn + 1].max())
    verdict.ask("confirmed", 1.0 - highest / critical, TURN, "arc length turns elsewhere")
