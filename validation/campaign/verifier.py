"""Judge of the equivalent beam's paths: residual, stability, branch and critical points."""

from __future__ import annotations

import numpy as np
from scipy.linalg import solve_triangular

from coilspring import EquilibriumPath, Scene
from validation.campaign.critical import bracket
from validation.campaign.energy import BeamEnergy, beam_energy
from validation.campaign.overlap import judge_apart
from validation.campaign.runs import LOAD, force_grain, judge_steps, largest_load
from validation.campaign.scenes import Case
from validation.campaign.verdict import CRITICAL, THROUGH, Verdict, reached, under

RESIDUAL = 1e-6  # way to the equilibrium over the way from rest, both in the energy norm
PLACE = 1e-10  # of the prescribed way: the top is there to what rounding sums up to
REACTION = 1e-6  # of the reaction, told by the judge's own forces in the same state
BEFORE = 4e-5  # share of the load by which a state lies before its critical point
ROWS = 3  # states of a path that are judged, the last among them


def judge_beam(case: Case, path: EquilibriumPath) -> Verdict:
    """Judge a path of the equivalent beam, complete or not."""
    verdict, energy = Verdict(), energy_of(case.scene, path)
    if path.outcome not in ("completed", THROUGH, *CRITICAL):
        verdict.complain(f"{path.outcome}: {path.message}")
        return verdict
    judge_states(verdict, energy, path)
    judge_apart(verdict, path)
    judge_steps(verdict, case, path)
    if path.outcome in CRITICAL:
        judge_critical(verdict, energy, case, path)
    return verdict


def energy_of(scene: Scene, path: EquilibriumPath) -> BeamEnergy:
    """Energy of the beam by the law with which a path was found."""
    energy = beam_energy(scene, str(path.options["law"]))
    return energy.driven(*scene.load.displacement) if scene.load.displacement else energy


def judge_states(verdict: Verdict, energy: BeamEnergy, path: EquilibriumPath) -> None:
    """Residual and stability of the last state, of some before, and of the one with the largest residual."""
    count = len(path.times)
    if not count:
        return
    residuals = energy.gradients(path.states) - (0.0 if energy.way else path.times[:, None] * energy.force)
    rows = {int(np.argmax(energy.share(residuals.T) / path.times))}
    rows |= {count - 1 - (count * k) // ROWS for k in range(ROWS)} & set(range(count))
    for row in sorted(rows):
        judge_state(verdict, energy, path.states[row], float(path.times[row]))
        if energy.way:
            judge_reaction(verdict, energy, path, row)


def judge_reaction(verdict: Verdict, energy: BeamEnergy, path: EquilibriumPath, row: int) -> None:
    """The top must be where it is prescribed, and be held there by the force that the path reports."""
    state, time, told = path.states[row], float(path.times[row]), float(path.loads[row, 1])
    judge_place(verdict, path, row, float(state[energy.top]))
    share = abs(float(energy.forces(state)[energy.top]) - told) / largest_load(path, row)
    verdict.ask("reaction", share, max(REACTION, force_grain(path)), f"another reaction at time {time:.6g}")


def judge_place(verdict: Verdict, path: EquilibriumPath, row: int, y: float) -> None:
    """The top's y must be where it is prescribed."""
    scene, time = path.scene, float(path.times[row])
    (way,) = scene.load.displacement
    share = abs(y - scene.spring.active_height - time * way) / abs(way)
    verdict.ask("place", share, PLACE, f"top elsewhere at time {time:.6g}")


def judge_state(verdict: Verdict, energy: BeamEnergy, state: np.ndarray, time: float) -> None:
    """One state must be a stable equilibrium at its time."""
    H = energy.hessian(state)
    residual = energy.residual(state, time)
    least = float(np.linalg.eigvalsh(energy.relative(H))[0])
    if not least > 0.0:
        verdict.complain(f"unstable at time {time:.6g}: least eigenvalue {least:.2e} of that at rest")
    way = float(np.sqrt(abs(residual @ np.linalg.solve(H, residual))))
    whole = float(np.linalg.norm(solve_triangular(energy.rest_factor, energy.force, lower=True))) * time
    verdict.ask("residual", way / whole, RESIDUAL, f"no equilibrium at time {time:.6g}")
    verdict.numbers["least"] = min(least, verdict.numbers.get("least", least))


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


def judge_critical(verdict: Verdict, energy: BeamEnergy, case: Case, path: EquilibriumPath) -> None:
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
