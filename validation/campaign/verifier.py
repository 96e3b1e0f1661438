"""The independent verifier: equations of its own, other runs, and overlaps by points of its own."""

from __future__ import annotations

from coilspring import EquilibriumPath
from validation.campaign.beamverifier import energy_of, verify_critical, verify_states
from validation.campaign.overlap import verify_overlap
from validation.campaign.runs import verified_rows, verify_steps
from validation.campaign.scenes import Case
from validation.campaign.verdict import CRITICAL, RIGHT, THROUGH, Verdict, ended
from validation.campaign.wire import wire_forces
from validation.campaign.wireverifier import BETWEEN, BRANCH, CRITICAL_SHIFT, verify_row, verify_wire_critical


def verify(case: Case, path: EquilibriumPath) -> Verdict:
    """Verify a path of a case, complete or not."""
    verdict = Verdict()
    if path.outcome not in (RIGHT, THROUGH, *CRITICAL) and not ended(path):
        verdict.complain(f"{path.outcome}: {path.message}")
    elif case.model == "equivbeam":
        _verify_beam(verdict, case, path)
    else:
        _verify_wire(verdict, case, path)
    return verdict


def _verify_beam(verdict: Verdict, case: Case, path: EquilibriumPath) -> None:
    energy = energy_of(case.scene, path)
    verify_states(verdict, energy, path)
    verify_overlap(verdict, path)
    verify_steps(verdict, case, path)
    if path.outcome in CRITICAL:
        verify_critical(verdict, energy, case, path)


def _verify_wire(verdict: Verdict, case: Case, path: EquilibriumPath) -> None:
    forces, sliding = wire_forces(case.scene, **dict(case.options)), case.scene.contact.sliding  # type: ignore[arg-type]
    for row in sorted(verified_rows(path)):
        verify_row(verdict, forces, path, row)
    verify_overlap(verdict, path)
    verify_steps(verdict, case, path, BRANCH[sliding], CRITICAL_SHIFT[sliding], BETWEEN)
    if path.outcome in CRITICAL:
        verify_wire_critical(verdict, forces, case, path)
