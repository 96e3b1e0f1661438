"""The verifier of the equivalent beam's paths: residual, stability and critical points."""

from __future__ import annotations

import numpy as np

from coilspring import EquilibriumPath
from validation.campaign.critical import bracket
from validation.campaign.energy import BeamEnergy
from validation.campaign.runs import (
    LOAD,
    force_grain,
    just_before,
    largest_load,
    sharp_critical,
    verified_rows,
    verify_place,
)
from validation.campaign.scenes import Case
from validation.campaign.verdict import Verdict

RESIDUAL = 1e-6  # distance to the equilibrium over that from rest, both in the energy norm
REACTION = 1e-6  # of the reaction, by the verifier's own forces in the same state
BEFORE = 4e-5  # share of the load by which a state lies before its critical point


def verify_states(verdict: Verdict, energy: BeamEnergy, path: EquilibriumPath) -> None:
    """Residual and stability of the last state, of some before, and of the one with the largest residual."""
    if not len(path.times):
        return
    residuals = energy.reduced(energy.residual(path.states, path.times).T)
    worst = int(np.argmax(np.linalg.norm(residuals, axis=0) / path.times))
    for row in sorted({worst} | verified_rows(path)):
        verify_state(verdict, energy, path.states[row], float(path.times[row]))
        if energy.displacement:
            verify_reaction(verdict, energy, path, row)


def verify_reaction(verdict: Verdict, energy: BeamEnergy, path: EquilibriumPath, row: int) -> None:
    """The top must be where it is prescribed, and be held there by the force that the path reports."""
    state, time, reported = path.states[row], float(path.times[row]), float(path.loads[row, 1])
    verify_place(verdict, path, row, float(state[energy.top]))
    share = abs(float(energy.forces(state)[energy.top]) - reported) / largest_load(path, row)
    verdict.ask("reaction", share, max(REACTION, force_grain(path)), f"another reaction at time {time:.6g}")


def verify_state(verdict: Verdict, energy: BeamEnergy, state: np.ndarray, time: float) -> None:
    """One state must be a stable equilibrium at its time."""
    H, residual = energy.hessian(state), energy.residual(state, time)
    least = energy.least(H)
    if not least > 0.0:
        verdict.complain(f"unstable at time {time:.6g}: least eigenvalue {least:.2e} of that at rest")
    distance = float(np.sqrt(abs(residual @ np.linalg.solve(H, residual))))
    verdict.ask(
        "residual", distance / energy.load_norm / time, RESIDUAL, f"no equilibrium at time {time:.6g}"
    )
    verdict.numbers["least"] = min(least, verdict.numbers.get("least", least))


def verify_critical(verdict: Verdict, energy: BeamEnergy, case: Case, path: EquilibriumPath) -> None:
    """The critical point must lie where the verifier's Hessian changes sign, and the path must end there."""
    sharp = sharp_critical(verdict, path)
    if sharp is None:
        return
    critical, width = sharp
    if len(path.times) and path.times[-1] > critical + width:
        verdict.complain(f"continued to time {path.times[-1]:.6g} past the critical {critical:.6g}")
    for time, before in just_before(verdict, case, critical, [BEFORE]):
        verify_state(verdict, energy, before.states[-1], time)
        found = bracket(energy, before.states[-1], time, critical)
        if found is None:
            verdict.complain(f"no eigenvalue changes sign near the critical time {critical:.6g}")
        else:
            verdict.ask("confirmed", found.offset(critical), LOAD, "eigenvalue changes sign elsewhere")
