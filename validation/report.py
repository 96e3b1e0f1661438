"""The report on the reproduction: verdict first, then what it rests on."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence

from validation.cases import FINE_MESH, PAPER_MESH
from validation.claims import AGREES, DIFFERS, UNDECIDED, Claim, mechanics
from validation.document import Block, Bullets, Heading, Picture, Table, Text
from validation.evidence import CaseEvidence, Evidence
from validation.exactrod import EXACT_ROD
from validation.methods import ELEMENT_NOTE, iteration_notes, sliding_notes, timing_notes
from validation.tables import table1, table2, table3
from validation.timeclaims import times

TITLE = "Coil contact in helical springs: the paper's tables and figures, reproduced"
_FRAME = "working plane. Contact circles to scale; the frame is enlarged beside it."
_FARTHER = (
    "and by how much the equivalent beam moves farther than the wire model on the paper's mesh (share of "
    "the wire model's peak; negative: stiffer)."
)
CAPTIONS = {
    "fig4": "Figure 4. Spring A at full load, (a) without and (b) with coil contact. The wire model is drawn "
    "as bands around the beam's wire, 8 % thicker than it, so that both can be seen where they coincide.",
    "fig4-plane": f"Figure 4, {_FRAME}",
    "fig5": f"Figure 5. Spring A: tip displacements with and without contact, {_FARTHER}",
    "fig6": "Figure 6. Spring B at full load, (a) without contact, where it telescopes, "
    "and (b) with contact.",
    "fig6-plane": f"Figure 6, {_FRAME}",
    "fig7": f"Figure 7. Spring B: load against deflection with and without contact, {_FARTHER}",
    "fig8": "Figure 8. Equivalent beam: iterations (factorisations) in every substep. "
    "The first substep includes the factorisation at rest.",
}


def judge(evidence: Evidence) -> tuple[Claim, ...]:
    """All claims of the paper with their verdicts."""
    return (*mechanics(evidence), *times(evidence))


def compose(
    evidence: Evidence,
    claims: Sequence[Claim],
    assumed: Sequence[Block],
    pictured: bool,
    notes: Sequence[str],
) -> tuple[Block, ...]:
    """The report's blocks.

    Parameters
    ----------
    evidence : what the report rests on.
    claims : from `judge`.
    assumed : closing section on the assumptions.
    pictured : whether the PNG files of all figures stand beside the report.
    notes : what did not go as planned, one sentence each.
    """
    timings = tuple(evidence.timings.values())
    shown = [Picture(f"{name}.png", caption) for name, caption in CAPTIONS.items()]
    return (
        Heading(1, TITLE),
        *_verdict(evidence, claims),
        *(Text(note) for note in notes),
        *_compared(),
        Heading(2, "What the paper says, sentence by sentence"),
        claim_table(claims),
        *_errors(evidence),
        *([Heading(2, "Figures"), *shown] if pictured else []),
        Heading(2, "Tables"),
        Heading(3, "Table 1. Springs"),
        table1(),
        Heading(3, "Table 2. Wire model"),
        table2(),
        Text(ELEMENT_NOTE),
        Heading(3, "Table 3. Solution time"),
        table3(timings),
        *timing_notes(timings, evidence.machine),
        *iteration_notes(),
        *sliding_notes(evidence, pictured),
        *assumed,
    )


def _verdict(evidence: Evidence, claims: Sequence[Claim]) -> list[Block]:
    cases = evidence.cases
    error = {name: f"{100.0 * item.error.curve_max:.2f} %" for name, item in cases.items()}
    mesh = 100.0 * cases["spring-a"].mesh_error.curve_max
    ratios = [item.ratio.median for item in evidence.timings.values()]
    mechanical = len(tuple(mechanics(evidence)))
    return [
        Heading(2, "Verdict"),
        Text(
            "**The proposed model matches the wire model, at a small part of its cost.** Against a wire "
            f"model on the paper's own FE mesh its tip curves differ by at most {error['spring-a']} "
            f"(Spring A) and {error['spring-b']} (Spring B) with contact, {error['spring-a-no-contact']} "
            f"and {error['spring-b-no-contact']} without, and it takes 1/{min(ratios):.0f} to "
            f"1/{max(ratios):.0f} of the time. Of the paper's statements, those on mechanics: "
            f"{_count(claims[:mechanical])}; those on time and iterations: {_count(claims[mechanical:])}."
        ),
        Bullets(
            (
                f"Spring A: the models differ by {error['spring-a']}, the FE mesh itself errs by "
                f"{mesh:.2f} %. Which of the two is softer is decided by the mesh.",
                f"Spring B without contact: the models differ by {error['spring-b-no-contact']} at most. "
                "The wire's radius and helix angle change, which the half-coil law leaves out.",
                *_limits(evidence),
                "Growing iteration counts of Spring A, and contact that helps convergence, belong to the "
                "paper's tangent matrix; with the exact tangent neither is seen.",
            )
        ),
    ]


def _count(claims: Sequence[Claim]) -> str:
    counts = Counter(claim.verdict for claim in claims)
    numbers = [f"{counts[AGREES]} agree with our numbers", f"{counts[DIFFERS]} differ"]
    numbers += [f"{counts[UNDECIDED]} cannot be decided"] if counts[UNDECIDED] else []
    return ", ".join(numbers)


def _limits(evidence: Evidence) -> list[str]:
    """Where Spring B's coils slide off each other."""
    found = []
    wire, beam = evidence.frictionless, evidence.overloaded
    if wire.critical_time is not None:
        found.append(
            "Spring B, FE: the paper needed the no-sliding option because without it the branch ends in a "
            f"{wire.outcome.replace('_', ' ')} at {wire.critical_time:.2f} of the load."
        )
    if beam.critical_time is not None:
        found.append(
            "Spring B, proposed model (frictionless): its branch ends in the same way, at "
            f"{evidence.overload:.3f} times the paper's load. A modulus about "
            f"{100.0 * (1.0 - 1.0 / evidence.overload):.0f} % lower than assumed would put that end at the "
            "paper's load."
        )
    return found


def _compared() -> list[Block]:
    return [
        Heading(2, "What was compared"),
        Text(
            "The **equivalent beam** (the paper's proposed model): one element for each half coil on the "
            "spring's axis, equations (1)-(9), and contact circles (10)-(13) in the working plane. The "
            "**wire model** (the paper's FE): geometrically exact shear-flexible beam elements along the "
            f"wire, {PAPER_MESH['elements_per_turn']} straight ones a turn, {PAPER_MESH['pairs_per_turn']} "
            "sphere pairs a turn, rigid closed end turns. Both follow the same dead load in 50 equal "
            "substeps. Lengths in mm, forces in N, stresses in MPa, angles in rad; time runs from 0 to 1 "
            "in proportion to the load."
        ),
    ]


def claim_table(claims: Sequence[Claim]) -> Table:
    """One row for each claim."""
    rows = tuple((c.source, c.statement, c.ours, c.verdict, c.why) for c in claims)
    return Table(
        ("where", "the paper says, in our words", "our numbers", "verdict", "why; measured against what"),
        rows,
    )


def _errors(evidence: Evidence) -> list[Block]:
    rows = tuple(_error_row(item) for item in evidence.cases.values())
    header = (
        "case",
        "beam against wire model: curve max / rms (%)",
        "shape max / rms (mm)",
        "wire mesh's own error: curve max / rms (%)",
        "shape max / rms (mm)",
        "beam against mesh-converged wire model: curve max (%)",
    )
    exact = [row for item in evidence.cases.values() for row in _exact_rows(item)]
    return [
        Heading(2, "How far apart the models are"),
        Text(
            "Curve: difference of the tip displacements at the same load over the wire model's peak, worst "
            "component. Shape: distance between the centres of the contact circles at full load. The "
            f"mesh's own error is a Richardson estimate from {PAPER_MESH['elements_per_turn']} and "
            f"{FINE_MESH['elements_per_turn']} elements a turn (same contact pairs), whose error falls "
            "with the square of the element length."
        ),
        Table(header, rows),
        Text(
            "Without contact both can be measured against the exact Cosserat rod: an independent shooting "
            "solution, made for this project and not published elsewhere."
        ),
        Table(
            ("case", "tip at full load", "exact rod", "wire model", "error (%)", "beam", "error (%)"),
            tuple(exact),
        ),
    ]


def _error_row(item: CaseEvidence) -> tuple[str, ...]:
    cells = [item.case.title]
    for error in (item.error, item.mesh_error):
        cells.append(f"{100.0 * error.curve_max:.2f} / {100.0 * error.curve_rms:.2f}")
        cells.append(f"{error.shape_max:.3f} / {error.shape_rms:.3f}")
    return (*cells, f"{100.0 * item.converged_error:.2f}")


def _exact_rows(item: CaseEvidence) -> list[tuple[str, ...]]:
    rows = []
    exact = EXACT_ROD.get(item.case.name, {}).get(1.0, ())
    for name, value, wire, beam in zip(
        ("UX (mm)", "UY (mm)", "ROTZ (rad)"), exact, item.wire.tips[-1], item.beam.tips[-1], strict=False
    ):
        if value:
            cells = [item.case.title, name, f"{value:.4f}"]
            for tip in (wire, beam):
                cells += [f"{tip:.4f}", f"{100.0 * (tip / value - 1.0):+.2f}"]
            rows.append(tuple(cells))
    return rows
