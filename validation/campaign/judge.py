"""Judge of the equivalent beam's paths: residual, stability, branch and critical points."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from scipy.linalg import solve_triangular

from coilspring import EquilibriumPath, Scene
from coilspring.pairlaw import ON
from validation.campaign.across import across_energy
from validation.campaign.critical import bracket
from validation.campaign.energy import PlaneEnergy, beam_energy
from validation.campaign.overlap import judge_apart
from validation.campaign.scenes import Case
from validation.campaign.verdict import CONFIRMED, CRITICAL, THROUGH, Verdict, fine_steps, reached, under

RESIDUAL = 1e-6  # way to the equilibrium over the way from rest, both in the energy norm
BRANCH = 1e-6  # difference from the fine run over the largest displacement,
SOLVER = 1e-8  # or this over the root of the least stiffness: what solvers leave, in the energy norm
ROUNDING = 4.0 * 2.0**-52  # of the spring's height: positions are no finer
LOAD = 1e-4  # within which a critical point is bracketed
BEFORE = 4e-5  # share of the load by which a state lies before its critical point
UNCHANGED = (1.0, 1.0, 1.0)
HALVINGS = 9  # of a share of the load, to where nothing has touched
ROWS = 3  # states of a path that are judged, the last among them


def judge_beam(case: Case, path: EquilibriumPath) -> Verdict:
    """Judge a path of the equivalent beam, complete or not."""
    verdict, energy = Verdict(), energy_of(case.scene, path)
    if path.outcome not in ("completed", THROUGH, *CRITICAL):
        verdict.complain(f"{path.outcome}: {path.message}")
        return verdict
    judge_states(verdict, energy, path)
    judge_apart(verdict, path)
    judge_branch(verdict, path, reached(case, steps=fine_steps(case)))
    if path.outcome in CRITICAL:
        judge_critical(verdict, energy, case, path)
    return verdict


def energy_of(scene: Scene, path: EquilibriumPath) -> PlaneEnergy:
    """Energy of the beam in the plane in which a path was found."""
    if path.options["plane"] == "across":
        return across_energy(scene)
    return beam_energy(scene, str(path.options["law"]))


def judge_states(verdict: Verdict, energy: PlaneEnergy, path: EquilibriumPath) -> None:
    """Residual and stability of the last state, of some before, and of the one with the largest residual."""
    count = len(path.times)
    if not count:
        return
    residuals = energy.gradients(path.states) - path.times[:, None] * energy.force
    rows = {int(np.argmax(energy.share(residuals.T) / path.times))}
    rows |= {count - 1 - (count * k) // ROWS for k in range(ROWS)} & set(range(count))
    for row in sorted(rows):
        judge_state(verdict, energy, path.states[row], float(path.times[row]))


def judge_state(verdict: Verdict, energy: PlaneEnergy, state: np.ndarray, time: float) -> None:
    """One state must be a stable equilibrium at its time."""
    H = energy.hessian(state)
    residual = energy.gradient(state) - time * energy.force
    least = float(np.linalg.eigvalsh(energy.relative(H))[0])
    if not least > 0.0:
        verdict.complain(f"unstable at time {time:.6g}: least eigenvalue {least:.2e} of that at rest")
    way = float(np.sqrt(abs(residual @ np.linalg.solve(H, residual))))
    whole = float(np.linalg.norm(solve_triangular(energy.rest_factor, energy.force, lower=True))) * time
    verdict.ask("residual", way / whole, RESIDUAL, f"no equilibrium at time {time:.6g}")
    verdict.numbers["least"] = min(least, verdict.numbers.get("least", least))


def apart(
    path: EquilibriumPath, other: EquilibriumPath, back: Sequence[float] = UNCHANGED
) -> tuple[float, float]:
    """Difference of the tips over the largest displacement: at the last common time, and the largest.

    Rotations count as displacements at the coil's diameter; `back` are factors of the other path's tips.
    """
    _, mine, theirs = np.intersect1d(path.times, other.times, return_indices=True)
    if not mine.size:
        return 0.0, 0.0
    size = np.array([1.0, 1.0, max(path.scene.spring.mean_diameter)])
    tips, others = path.tips[mine] * size, other.tips[theirs] * size * back
    shares = np.abs(tips - others).max(axis=1) / np.abs(others).max()
    return float(shares[-1]), float(shares.max())


def grain(path: EquilibriumPath) -> float:
    """What the rounding of the positions makes of the largest displacement, as a share of it."""
    largest = np.abs(path.tips[:, :2]).max(initial=0.0)
    return ROUNDING * path.scene.spring.active_height / largest if largest > 0.0 else 0.0


def force_grain(path: EquilibriumPath) -> float:
    """What the rounding of the positions makes of a contact force, as a share of the load.

    A hard pair's force is its stiffness times a difference of positions that are as large as the spring.
    """
    contact, depth = path.scene.contact, path.max_penetration.max(initial=0.0)
    if not depth > 0.0:
        return 0.0
    stiffness = 2.0 * contact.stiffness * contact.exponent * depth ** (contact.exponent - 1.0)
    return ROUNDING * path.scene.spring.active_height * stiffness / math.hypot(*path.scene.load.force)


def remembered(
    case: Case, path: EquilibriumPath, other: EquilibriumPath, back: Sequence[float] = UNCHANGED
) -> bool:
    """Whether two runs with friction part because of what their pairs remember: each has a history of its own
    from its first touch on, since a pair remembers where it was when its substep ended.

    Then they agree under a share of the load at whose end neither remembers any.
    """
    if path.scene.contact.sliding == "free" or not (_touched(path) or _touched(other)):
        return False
    for share in 0.5 ** np.arange(1, HALVINGS):
        early = [reached(case, under(run.scene, share)) for run in (path, other)]
        if not any(_touched(run) for run in early):
            same = all(run.outcome == "completed" for run in early)
            return same and apart(early[0], early[1], back)[1] <= BRANCH
    return False


def _touched(path: EquilibriumPath) -> bool:
    """Whether a pair is remembered or touches at a stored time."""
    assert path.memories is not None
    return bool((path.memories[:, :, ON] > 0.0).any() or path.active_contacts.any())


def judge_branch(
    verdict: Verdict,
    path: EquilibriumPath,
    fine: EquilibriumPath,
    most: float = BRANCH,
    most_shift: float = LOAD,
    most_between: float = 0.0,
) -> None:
    """The path must be the fine run's, and end as that does; `most_between` is for states before the last."""
    most = max(most, SOLVER / max(verdict.numbers.get("least", 1.0), 1e-12) ** 0.5, grain(path))
    last, largest = apart(path, fine)
    verdict.ask("branch", last, most, "off the branch of the fine run")
    verdict.ask("branch", largest, max(most, most_between), "off the branch of the fine run on the way")
    if fine.outcome == "not_converged":
        verdict.complain(f"{path.outcome}, but the fine run ends as {fine.outcome}: {fine.message}")
    elif _kind(path) != _kind(fine):
        verdict.differ(f"{path.outcome}, but the fine run ends as {fine.outcome}: {fine.message}")
    elif path.end_bracket is not None and fine.end_bracket is not None:
        shift = abs(sum(path.end_bracket) / sum(fine.end_bracket) - 1.0)
        verdict.ask("critical_shift", shift, most_shift, "another critical time than the fine run's")


def _kind(path: EquilibriumPath) -> str:
    """Outcome of a path; which kind of critical point it is may be told apart by rounding alone."""
    return CONFIRMED if path.outcome in CRITICAL else path.outcome


def sharp_critical(verdict: Verdict, path: EquilibriumPath) -> tuple[float, float] | None:
    """Critical time and the width of its bracket, which must be small; None where the path has none."""
    if path.critical_time is None or path.critical_bracket is None:
        verdict.complain(f"{path.outcome} without a critical time")
        return None
    share = path.critical_bracket / path.critical_time
    verdict.ask("bracket", share, LOAD, "critical time is not that sharp")
    return path.critical_time, path.critical_bracket


def just_before(verdict: Verdict, case: Case, critical: float, time: float) -> EquilibriumPath | None:
    """The case under the part of its load that acts at `time`; None where that is not reached."""
    path = reached(case, under(case.scene, time))
    if path.outcome != "completed":
        verdict.complain(f"just before the critical time {critical:.6g}: {path.outcome}")
        return None
    return path


def judge_critical(verdict: Verdict, energy: PlaneEnergy, case: Case, path: EquilibriumPath) -> None:
    """The critical point must lie where the judge's Hessian changes sign, and the path must end there."""
    sharp = sharp_critical(verdict, path)
    if sharp is None:
        return
    critical, width = sharp
    if len(path.times) and path.times[-1] > critical + width:
        verdict.complain(f"continued to time {path.times[-1]:.6g} past the critical {critical:.6g}")
    time = critical * (1.0 - BEFORE)
    before = just_before(verdict, case, critical, time)
    if before is None:
        return
    judge_state(verdict, energy, before.states[-1], time)
    found = bracket(energy, before.states[-1], time, critical)
    if found is None:
        verdict.complain(f"no eigenvalue changes sign near the critical time {critical:.6g}")
        return
    verdict.ask("confirmed", found.distance(critical), LOAD, "eigenvalue changes sign elsewhere")
