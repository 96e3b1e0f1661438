"""The report on the reproduction: verdict first, then what it rests on."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence

from validation.reproduce.claims import (
    AGREES,
    CASE_NAMES,
    MECHANICS,
    UNDECIDED,
    VERDICTS,
    Claim,
    curves,
    match,
    phase_range,
    softer_bare,
    softer_contact,
)
from validation.reproduce.evidence import CaseEvidence, Evidence
from validation.reproduce.methods import (
    assumptions_section,
    counting_section,
    element_note,
    sliding_section,
    timing_section,
)
from validation.reproduce.phases import phase_table
from validation.reproduce.tables import table1, table2, table3
from validation.reproduce.timeclaims import TIMES
from validation.study.cases import PathStore
from validation.study.document import Heading, Picture, Table, Text
from validation.study.scenes import EXACT_ROD
from validation.study.statements import Facts, Part, percent, statement

CLAIMS: tuple[Claim, ...] = (*MECHANICS, *TIMES)

TITLE = "Coil contact in helical springs: the paper's tables and figures, reproduced"
_FRAME = "working plane. Contact circles to scale; the frame is enlarged beside it."
_FARTHER = (
    "and by how much the equivalent beam moves farther than the wire model on the paper's mesh (share of "
    "the wire model's peak; negative: stiffer)."
)
CAPTIONS = {
    "fig4": "Figure 4. Spring A at full load, (a) without and (b) with coil contact. The wire model is drawn "
    "in pieces that alternate with the beam's, so that both can be seen where they coincide. The scale "
    "holds in the plane of the picture.",
    "fig4-plane": f"Figure 4, {_FRAME}",
    "fig5": f"Figure 5. Spring A: tip displacements with and without contact, {_FARTHER}",
    "fig6": "Figure 6. Spring B at full load, (a) without contact and (b) with contact.",
    "fig6-plane": f"Figure 6, {_FRAME}",
    "fig7": f"Figure 7. Spring B: load against deflection with and without contact, {_FARTHER}",
    "fig8": "Figure 8. Equivalent beam: iterations (factorisations) in every substep. "
    "The first substep includes the factorisation at rest.",
}


def compose(
    evidence: Evidence, facts: Facts, store: PathStore, pictured: bool, notes: Sequence[str]
) -> list[Part]:
    """The report's parts.

    Parameters
    ----------
    evidence : what the tables show.
    facts : what the sentences are computed from.
    store : of the paths behind the tables of assumptions.
    pictured : whether the PNG files of all figures stand beside the report.
    notes : what did not go as planned, one sentence each.
    """
    shown: list[Part] = [Picture(f"{name}.png", caption) for name, caption in CAPTIONS.items()]
    return [
        Heading(1, TITLE),
        Heading(2, "Verdict"),
        verdict,
        (mesh, half_coil, limit_wire, limit_beam, tangent),
        *(Text(note) for note in notes),
        Heading(2, "What was compared"),
        compared,
        Heading(2, "What the paper says, sentence by sentence"),
        claim_table(facts),
        *_errors(evidence),
        Heading(2, "Which model is softer, by start phase"),
        phases,
        phase_table(evidence.phases),
        *((Heading(2, "Figures"), *shown) if pictured else ()),
        Heading(2, "Tables"),
        Heading(3, "Table 1. Springs"),
        table1(),
        Heading(3, "Table 2. Wire model"),
        table2(),
        element_note,
        Heading(3, "Table 3. Solution time"),
        table3(evidence.times),
        *timing_section(),
        *counting_section(),
        *sliding_section(pictured),
        *assumptions_section(store),
    ]


@statement("verdict")
def verdict(f: Facts) -> str:
    error = {name: percent(value) for name, value in curves(f).items()}
    ratios = [f[f"{name}.time.ratio"] for name in CASE_NAMES]
    return (
        f"**{_matching(f)}, {_costing(f, min(ratios))}.** Against a wire model on the paper's own FE mesh "
        f"its tip curves differ by at most {error['spring-a']} (Spring A) and {error['spring-b']} (Spring "
        f"B) with contact, {error['spring-a-no-contact']} and {error['spring-b-no-contact']} without, and "
        f"it takes {_parts(ratios)} of the time. Our verdicts on the paper's statements are, on mechanics: "
        f"{_count(f, MECHANICS)}; on time and iterations: {_count(f, TIMES)}."
    )


def _parts(ratios: Sequence[float]) -> str:
    """Of the time, from the largest to the least."""
    low, high = min(ratios), max(ratios)
    return f"1/{low:.0f} to 1/{high:.0f}" if low > 1.0 else f"{1.0 / high:.2g} to {1.0 / low:.2g}"


def _matching(f: Facts) -> str:
    if match.assess(f).verdict == AGREES:
        return "The proposed model matches the wire model where the helix starts in the working plane"
    far = [f[f"{name}.title"] for name, value in curves(f).items() if value >= f["threshold.match"]]
    return f"The proposed model does not match the wire model ({', '.join(far)})"


def _costing(f: Facts, least: float) -> str:
    if least * f["threshold.cheap"] >= 1.0:
        return "at a small part of its cost"
    return "at a lower cost" if least > 1.0 else "and is not cheaper"


def _count(f: Facts, claims: Sequence[Claim]) -> str:
    counts = Counter(item.assess(f).verdict for item in claims)
    return ", ".join(f"{name} {counts[name]}" for name in VERDICTS if counts[name])


@statement("verdict.mesh")
def mesh(f: Facts) -> str:
    own, error = f["spring-a.mesh"], f["spring-a.curve"]
    more = "more" if own > error else "less"
    which = (
        "Which of the two is softer cannot be decided: it depends on the start phase of the helix, which the "
        "paper does not give."
        if UNDECIDED in (softer_bare.assess(f).verdict, softer_contact.assess(f).verdict)
        else "Which of the two is softer is in the table over the start phases."
    )
    return (
        f"Spring A: the models differ by {percent(error)}, the FE mesh itself errs by {percent(own)}, "
        f"which is {more}. Over the start phases they differ by {phase_range(f, 'few')}. {which}"
    )


@statement("verdict.half-coil")
def half_coil(f: Facts) -> str:
    error, curved = f["spring-b-no-contact.curve"], f["linear.wire"]
    return (
        f"Spring B without contact: the models differ by {percent(error)} at most. The wire model's UY "
        f"deviates by {percent(curved)} from proportionality: radius and helix angle change, which the "
        "half-coil law leaves out."
    )


@statement("verdict.limit-wire")
def limit_wire(f: Facts) -> str:
    if f["limit.time"] is None:
        return f"Spring B, FE: without the no-sliding option our wire model ends as {f['limit.outcome']}."
    return (
        "Spring B, FE: the paper needed the no-sliding option. A plausible reason is that without it the "
        f"branch of our wire model ends in a {f['limit.outcome']} at {f['limit.time']:.2f} of the load."
    )


@statement("verdict.limit-beam")
def limit_beam(f: Facts) -> str:
    over = f["limit.beam"]
    if over is None:
        return "Spring B, proposed model (frictionless): beyond its full load it ends as "
        f"{f['limit.beam_outcome']}."
    return (
        f"Spring B, proposed model (frictionless): its branch ends in a {f['limit.beam_outcome']} at "
        f"{over:.3f} times the paper's load. A modulus about {percent(abs(1.0 - 1.0 / over), 0)} "
        f"{'lower' if over > 1.0 else 'higher'} than assumed would put that end at the paper's load."
    )


@statement("verdict.tangent")
def tangent(f: Facts) -> str:
    growth = {name: f[f"growth.{name}.end"] / f[f"growth.{name}.begin"] for name in ("paper", "exact")}
    helped = {
        name: f[f"spring-a.{count}"] / f[f"spring-a-no-contact.{count}"]
        for name, count in (("paper", "paper_iterations"), ("exact", "iterations"))
    }
    both = growth["paper"] > growth["exact"] and helped["paper"] < 1.0 <= helped["exact"]
    return (
        f"Iterations of Spring A grow by a factor of {growth['paper']:.1f} along the load with the paper's "
        f"tangent matrix and {growth['exact']:.1f} with the exact one; contact changes their number by a "
        f"factor of {helped['paper']:.2f} and {helped['exact']:.2f}."
        + (" Growth, and contact that helps, belong to that matrix." if both else "")
    )


@statement("compared")
def compared(f: Facts) -> str:
    return (
        "The **equivalent beam** (the paper's proposed model): one element for each half coil on the "
        "spring's axis, equations (1)-(9), and contact circles, equations (10)-(13), in the working plane. "
        "The **wire model** (the paper's FE): geometrically exact shear-flexible beam elements along the "
        f"wire, {f['setting.elements']} straight ones per turn, {f['setting.pairs']} sphere pairs per turn, "
        f"rigid closed end turns. Both follow the same dead load in {f['setting.steps']} equal substeps. "
        "Lengths in mm, forces in N, stresses in MPa, angles in rad; time goes in proportion to the load "
        "and ends at full load."
    )


def claim_table(f: Facts) -> Table:
    """One row for each claim."""
    rows = []
    for item in CLAIMS:
        found = item.assess(f)
        rows.append((item.source, item.statement, found.ours, found.verdict, found.why))
    return Table(
        ("where", "the paper says, in our words", "our numbers", "verdict", "why; measured against what"),
        tuple(rows),
    )


@statement("phases")
def phases(f: Facts) -> str:
    degrees = f["phases.bare.degrees"]
    always = [
        f"{angle} degrees"
        for angle, count in zip(degrees, f["phases.bare.softer"], strict=True)
        if count == f["setting.steps"]
    ]
    where = f"at {', '.join(always)}" if always else "at no phase"
    near = max(f["phases.many.difference"]) < f["threshold.match"]
    matter = "their places hardly matter" if near else "their places matter too"
    return (
        "By how much the equivalent beam moves farther than the wire model at full load, and in how many of "
        "the substeps, for UX, UY and ROTZ of Spring A. Without contact the beam is "
        f"softer in all components and all substeps {where}. With {f['setting.pairs']} pairs per turn the "
        "spheres turn with the helix, out of the plane in which the spring bends; with "
        f"{f['setting.many_pairs']} {matter}. The tip curves differ by "
        f"{phase_range(f, 'bare')} without contact, {phase_range(f, 'few')} with {f['setting.pairs']} "
        f"pairs per turn and {phase_range(f, 'many')} with {f['setting.many_pairs']}; at {_least(f)} degrees "
        f"they come nearest with {f['setting.pairs']}."
    )


def _least(f: Facts) -> str:
    """The two phases at which the models are nearest."""
    ranked = sorted(zip(f["phases.few.difference"], f["phases.few.degrees"], strict=True))
    return " and ".join(str(angle) for angle in sorted(angle for _, angle in ranked[:2]))


@statement("errors")
def errors(f: Facts) -> str:
    return (
        "Curve: difference of the tip displacements at the same load over the wire model's peak, worst "
        "component. Shape: distance between the centres of the contact circles at full load. The "
        f"mesh's own error is a Richardson estimate from {f['setting.elements']} and "
        f"{f['setting.fine_elements']} elements per turn (same contact pairs), whose error falls "
        "with the square of the element length. All at a start phase in the working plane."
    )


def _errors(evidence: Evidence) -> list[Part]:
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
        Heading(2, "Deviation of the models"),
        errors,
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
