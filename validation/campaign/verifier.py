"""The independent verifier: equations of its own, other runs, and overlaps by points of its own."""

from __future__ import annotations

from coilspring import EquilibriumPath
from validation.campaign.beamverifier import verify_critical, verify_states
from validation.campaign.energy import beam_energy
from validation.campaign.overlap import verify_overlap
from validation.campaign.runs import verified_rows, verify_steps
from validation.campaign.scenes import Case
from validation.campaign.verdict import CRITICAL, JUMP, VERIFIED, Verdict
from validation.campaign.wire import wire_forces
from validation.campaign.wirejump import verify_jump
from validation.campaign.wireverifier import verify_row, verify_wire_critical


def verify(case: Case, path: EquilibriumPath) -> Verdict:
    """Verify a path of a case, complete or not."""
    verdict, beam = Verdict(), case.model == "equivbeam"
    if not verdict.stop("path", path) and path.outcome not in VERIFIED:
        verdict.complain(f"{path.outcome}: {path.message}")
        return verdict
    if beam:
        energy = beam_energy(case.scene, str(path.options["law"]))
        verify_states(verdict, energy, path)
    else:
        forces = wire_forces(case.scene, **case.options)
        for row in sorted(verified_rows(path)):
            verify_row(verdict, forces, path, row)
    verify_overlap(verdict, path)
    verify_steps(verdict, case, path)
    if path.outcome in CRITICAL:
        if beam:
            verify_critical(verdict, energy, case, path)
        else:
            verify_wire_critical(verdict, forces, case, path)
    elif path.outcome == JUMP:
        verify_jump(verdict, forces, case, path)
    return verdict
