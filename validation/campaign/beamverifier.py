"""The verifier of the equivalent beam's paths: residual, stability and critical points.

A critical point is bracketed by the verifier's own Hessian: a stable and an unstable state side by side.
"""

from typing import NamedTuple

import numpy as np
from scipy.linalg import solve_triangular

from coilspring import EquilibriumPath
from validation.campaign import runs
from validation.campaign.energy import BeamEnergy
from validation.campaign.scenes import Case
from validation.campaign.verdict import Verdict

RESIDUAL = 1e-6  # distance to the equilibrium over that from rest, both in the energy norm
REACTION = 1e-6  # of the reaction, by the verifier's own forces in the same state
# Shares of the load by which a state lies before its critical point: the next where it is not found from
# there, since hard pairs change the stiffness on the way.
BEFORE = (4e-5, 4e-6, 4e-7)
CLOSE = 1e-9  # of the displacement from rest: the last correction
LOOSE = 1e-7  # where rounding keeps the corrections from becoming smaller
ROUNDED = 1e-9  # the same, of the forces of the spring at rest: along a soft mode corrections are larger
IDLE = 3  # corrections that became no smaller
MOST_CORRECTIONS = 25
MOST_TRIALS = 40
MOST_SETS = 6  # of closed pairs that are tried
TIGHT = 5e-5  # of the load: where an unstable equilibrium is that near, the bracket is not narrowed further
SHARP = 1e-4  # of the load: a bracket within it needs no other
SHALLOW = 1e-7  # wire diameters of penetration, below which a pair is about to open
FAR = 20.0  # moves beyond this multiple of the tangent's belong to another branch


def verify_states(verdict: Verdict, energy: BeamEnergy, path: EquilibriumPath) -> None:
    """Residual and stability of the last state, of some before, and of the one with the largest residual."""
    if not len(path.times):
        return
    residuals = energy.reduced(energy.residual(path.states, path.times).T)
    worst = int(np.argmax(np.linalg.norm(residuals, axis=0) / path.times))
    for row in sorted({worst} | runs.verified_rows(path)):
        state, time = path.states[row], float(path.times[row])
        verify_state(verdict, energy, state, time)
        if energy.displacement:  # the top must be there, and be held by the force that the path reports
            runs.verify_place(verdict, path, row, float(state[energy.top]))
            held = ["ux" in path.scene.supports.top_held, True]
            off = np.abs(energy.forces(state)[energy.top - 1 : energy.top + 1] - path.loads[row])[held].max()
            most = max(REACTION, runs.force_grain(path, row))
            share = float(off) / runs.largest_load(path, row)
            verdict.ask("reaction", share, most, f"another reaction at time {time:.6g}")


def verify_state(
    verdict: Verdict, energy: BeamEnergy, state: np.ndarray, time: float, grain: float = 0.0
) -> None:
    """One state must be a stable equilibrium at its time. Just before a critical point more is left along the
    softest mode: `grain` is what rounding makes of a hard pair's force, as a share of the load."""
    H, residual = energy.hessian(state), energy.residual(state, time)
    least = energy.least(H)
    verdict.stable(least, time)
    distance = float(np.sqrt(abs(residual @ np.linalg.solve(H, residual)))) / energy.load_norm / time
    most = max(RESIDUAL, grain / max(least, 1e-12) ** 0.5)
    verdict.ask("residual", distance, most, f"no equilibrium at time {time:.6g}")


def verify_critical(verdict: Verdict, energy: BeamEnergy, case: Case, path: EquilibriumPath) -> None:
    """The critical point must lie where the verifier's Hessian changes sign, and the path must end there."""
    critical = runs.sharp_critical(verdict, path)
    if critical is None:
        return
    assert path.critical_bracket is not None
    if len(path.times) and path.times[-1] > critical + path.critical_bracket:
        verdict.complain(f"continued to time {path.times[-1]:.6g} past the critical {critical:.6g}")
    offsets: list[float] = []
    for share in BEFORE:  # from too far before, the softest mode may lead to another critical point
        paths = runs.just_before(verdict, case, path, [share])
        if not paths:
            break
        state, time = paths[0].states[-1], critical * (1.0 - share)
        verify_state(verdict, energy, state, time, runs.force_grain(paths[0]))
        found = bracket(energy, state, time, critical)
        if found is not None:
            offsets.append(found.offset(critical))
            if offsets[-1] <= runs.LOAD:
                break
    if offsets:
        verdict.ask("confirmed", min(offsets), runs.LOAD, "eigenvalue changes sign elsewhere")
    elif paths and opens_there(energy, path):
        verdict.numbers["confirmed"] = path.critical_bracket / critical
    elif paths:
        verdict.complain(f"no eigenvalue changes sign near the critical time {critical:.6g}")


def opens_there(energy: BeamEnergy, path: EquilibriumPath) -> bool:
    """Whether the stiffness jumps across zero where the path ends: with the pairs that touch there the spring
    is stable, without those about to open it is not."""
    state = path.last_state
    assert state is not None
    touching, firm = energy.closed(state), energy.closed(state, SHALLOW)
    return energy.least(energy.hessian(state, touching)) > 0.0 > energy.least(energy.hessian(state, firm))


class Point(NamedTuple):
    """An equilibrium, and its least eigenvalue in units of that at rest."""

    state: np.ndarray
    time: float
    least: float


class Bracket(NamedTuple):
    """A stable and an unstable equilibrium next to each other."""

    stable: Point
    unstable: Point

    def offset(self, time: float) -> float:
        """Offset of `time` from the farther end, over `time`."""
        return max(abs(end.time - time) for end in self) / time


def bracket(energy: BeamEnergy, state: np.ndarray, time: float, critical: float) -> Bracket | None:
    """Bracket the critical point at `critical` from the stable equilibrium `state` at the lower `time`.

    The curve of equilibria is followed along the softest mode, over which the load rises and falls; where
    that mode does no work (a bifurcation) the same branch is continued by the load.
    """
    H = energy.hessian(state)
    start = Point(state, time, energy.least(H))
    if start.least <= 0.0:
        return None
    found = _along_mode(energy, start, H, critical)
    if found is not None and found.offset(critical) <= SHARP:
        return found
    return _by_load(energy, start, H, critical) or found


def _along_mode(energy: BeamEnergy, start: Point, H: np.ndarray, critical: float) -> Bracket | None:
    """Narrow the sign change of the least eigenvalue over the distance along the softest mode."""
    soft = np.linalg.eigh(energy.relative(H))[1][:, 0]
    mode = solve_triangular(energy.rest_factor, soft, lower=True, trans="T")
    work = float(mode @ energy.rate(start.state))
    if work == 0.0:
        return None
    row = np.append(np.sign(work) * energy.rest_factor @ soft, 0.0)
    distance = 3.0 * (critical - start.time) * abs(work) / start.least  # a parabola has its top at 2
    low, nearest, high, farthest = start, 0.0, None, np.inf
    for _ in range(MOST_TRIALS):
        point = _settled(energy, start, low, row, distance, energy.closed(low.state))
        if point is None:
            distance = 0.5 * (nearest + distance)
            continue
        if point.least > 0.0:
            low, nearest = point, distance
        else:
            high, farthest = point, distance
        if high is None:
            distance *= 2.0
            continue
        if abs(high.time - critical) <= TIGHT * critical:
            break
        share = low.least / (low.least - high.least)
        distance = nearest + min(max(share, 0.1), 0.9) * (farthest - nearest)
    return None if high is None else Bracket(low, high)


def _by_load(energy: BeamEnergy, start: Point, H: np.ndarray, critical: float) -> Bracket | None:
    """Continue the branch by the load to as far beyond the critical point as `start` lies before it."""
    beyond = 2.0 * (critical - start.time)
    tangent = np.linalg.solve(H, energy.rate(start.state)) * beyond
    ahead = start.state.copy()
    ahead[energy.free] += tangent
    row = np.append(np.zeros(energy.free.size), 1.0)
    # the pairs are those that touch at the start: the tangent may open some that hardly do
    guess, closed = Point(ahead, start.time + beyond, np.nan), energy.closed(start.state)
    found = _settled(energy, start, guess, row, beyond, closed)
    if found is None or found.least > 0.0:
        return None
    moved = np.linalg.norm((found.state - start.state)[energy.free])
    return None if moved > FAR * np.linalg.norm(tangent) else Bracket(start, found)


def _settled(
    energy: BeamEnergy, start: Point, guess: Point, row: np.ndarray, distance: float, closed: np.ndarray
) -> Point | None:
    """Equilibrium near a guess, where `row` times the change of displacements and time since `start` is a
    distance: by Newton's method with `closed` pairs held closed, which leaves no kinks, until they are."""
    free = energy.free
    loose, matrix = max(LOOSE, ROUNDED / start.least), np.tile(row, (len(row), 1))
    for _ in range(MOST_SETS):
        state, time = energy.placed(guess.state.copy(), guess.time), guess.time
        shares: list[float] = []
        for _ in range(MOST_CORRECTIONS):
            left, matrix[:-1, :-1], rate = energy.linearized(state, time, closed)
            matrix[:-1, -1] = -rate
            change = np.append((state - start.state)[free], time - start.time)
            missing = np.append(-left, distance - row @ change)
            try:
                step = np.linalg.solve(matrix, missing)
            except np.linalg.LinAlgError:
                return None
            if not np.isfinite(step).all():
                return None
            state[free] += step[:-1]
            time += step[-1]
            state = energy.placed(state, time)
            # by the step, not by the residual: hard contact turns rounding of positions into large forces
            share = float(np.linalg.norm(energy.rest_factor.T @ step[:-1])) / energy.load_norm / abs(time)
            idle = len(shares) > IDLE and min(shares[-IDLE:]) > 0.5 * min(shares[:-IDLE])
            if share <= CLOSE or (share <= loose and idle):
                break
            shares.append(share)
        else:
            return None
        now = energy.closed(state)
        if (now == closed).all():
            return Point(state, time, energy.least(energy.hessian(state)))
        closed = now
    return None
