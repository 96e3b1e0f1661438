"""Every sentence of the paper that claims a result, judged by our numbers: the mechanics.

Sentences on time and iterations are in `validation.timeclaims`.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from validation.evidence import CaseEvidence, Evidence
from validation.shapes import overlaps

AGREES, DIFFERS, UNDECIDED = "agrees", "differs", "cannot be decided"
VERDICTS = (AGREES, DIFFERS, UNDECIDED)

MATCH = 0.05  # of the peak: as much as 5 % in the modulus, which the paper does not give
SUPERIMPOSED = 0.1  # wire diameters between circles that cannot be told apart in a picture


@dataclass(frozen=True)
class Claim:
    """One sentence and what we find.

    Attributes
    ----------
    source : where the paper says it.
    statement : what it says, in our words.
    ours : our numbers.
    verdict : one of `VERDICTS`.
    why : reason, and what the numbers are measured against.
    """

    source: str
    statement: str
    ours: str
    verdict: str
    why: str

    def __post_init__(self) -> None:
        if self.verdict not in VERDICTS:
            raise ValueError(f"verdict must be one of {VERDICTS}, got {self.verdict!r}")


def mechanics(evidence: Evidence) -> Iterator[Claim]:
    """Claims on displacements and shapes."""
    cases = evidence.cases
    yield _match(evidence)
    yield _superimposed(cases["spring-a-no-contact"], "Figure 4 left", "Spring A without contact", "")
    yield _superimposed(cases["spring-a"], "Figure 4 right", "Spring A with contact", "")
    yield _superimposed(cases["spring-b"], "Figure 6", "Spring B with contact", _sticking(evidence))
    yield _vertical(cases["spring-a"], cases["spring-a-no-contact"])
    yield _softer(cases["spring-a-no-contact"], "without contact")
    yield _softer(cases["spring-a"], "with contact")
    yield _compenetration(cases["spring-a"], cases["spring-a-no-contact"])
    yield _sliding(evidence)
    yield _linear(cases["spring-b-no-contact"])
    yield _telescopes(cases["spring-b-no-contact"])
    yield _under(cases["spring-b-no-contact"])


def _match(evidence: Evidence) -> Claim:
    worst = {name: item.error.curve_max for name, item in evidence.cases.items()}
    listed = ", ".join(
        f"{evidence.cases[name].case.title} {100.0 * value:.2f} %" for name, value in worst.items()
    )
    return Claim(
        "abstract, section 4, conclusions",
        "The proposed model matches static FE, although its half-coil law is simple.",
        f"largest difference of the tip curves: {listed} of the peak",
        AGREES if max(worst.values()) < MATCH else DIFFERS,
        f"Against our wire model on the paper's mesh. Counted as a match below {100.0 * MATCH:.0f} %, "
        "which is what 5 % in the unstated modulus would move.",
    )


def _superimposed(item: CaseEvidence, figure: str, words: str, more: str) -> Claim:
    apart, diameter = item.error.shape_max, item.case.scene.spring.wire_diameter
    return Claim(
        f"section 4, {figure}",
        f"{words}: the deformed shapes of both models can hardly be told apart.",
        f"contact circles at most {apart:.3f} mm apart ({100.0 * apart / diameter:.1f} % of the wire "
        f"diameter), tip curves {100.0 * item.error.curve_max:.2f} %",
        AGREES if apart < SUPERIMPOSED * diameter else DIFFERS,
        "At full load, against the wire model on the paper's mesh; superimposed means below "
        f"{100.0 * SUPERIMPOSED:.0f} % of the wire diameter.{more}",
    )


def _sticking(evidence: Evidence) -> str:
    alike = evidence.sticking.shape_max
    return (
        " The coils of the wire model lie farther to one side. Part of this is the paper's own comparison: "
        f"its FE does not slide, its beam is frictionless; a beam without sliding is at most {alike:.3f} "
        "mm apart."
    )


def _vertical(contact: CaseEvidence, without: CaseEvidence) -> Claim:
    parts = []
    changes = {}
    for label, with_tips, bare_tips in (
        ("wire model", contact.wire.tips, without.wire.tips),
        ("beam", contact.beam.tips, without.beam.tips),
    ):
        changes[label] = 100.0 * (with_tips[-1] / bare_tips[-1] - 1.0)
        ux, uy, rotz = changes[label]
        parts.append(f"{label}: UX {ux:+.1f} %, UY {uy:+.1f} %, ROTZ {rotz:+.1f} %")
    most = all(abs(change[1]) == np.abs(change).max() for change in changes.values())
    return Claim(
        "section 4, Figure 5",
        "Contact changes Spring A's tip displacements, the vertical one above all.",
        "at full load, " + "; ".join(parts),
        AGREES if most else DIFFERS,
        "Change by contact, each model against itself without contact.",
    )


def _softer(item: CaseEvidence, words: str) -> Claim:
    beam = np.abs(item.beam.tips)
    coarse = np.count_nonzero(beam > np.abs(item.wire.tips), axis=0)
    fine = np.count_nonzero(beam > np.abs(item.converged_tips), axis=0)
    steps = len(beam)
    ours = (
        "beam moves farther (UX, UY, ROTZ) in {}, {}, {} of {} substeps; against the mesh-converged wire "
        "model in {}, {}, {}"
    )
    last = 100.0 * (beam[-1] / np.abs(item.wire.tips[-1]) - 1.0)
    always = coarse.min() == steps and fine.min() == steps
    return Claim(
        "section 4, Figure 5",
        f"Spring A {words}: the proposed model is always softer than FE.",
        ours.format(*coarse, steps, *fine),
        AGREES if always else DIFFERS,
        f"At full load the beam differs by {last[0]:+.2f}, {last[1]:+.2f}, {last[2]:+.2f} % from the wire "
        f"model on the paper's mesh, whose own error is {100.0 * item.mesh_error.curve_max:.2f} %: the "
        "sign is decided by the mesh, not by the models.",
    )


def _compenetration(contact: CaseEvidence, without: CaseEvidence) -> Claim:
    diameter = contact.case.scene.spring.wire_diameter
    bare, kept = (overlaps(item.wire.circle_centres(-1), diameter) for item in (without, contact))
    lower = bool(np.argmax(bare) < 0.25 * bare.size)
    return Claim(
        "section 4, explanation of Table 3",
        "Without contact the bottom coils of Spring A run into each other; contact prevents it.",
        f"largest overlap {bare.max():.2f} mm ({100.0 * bare.max() / diameter:.0f} % of the wire diameter) "
        f"without contact, {1e3 * kept.max():.1f} µm with it",
        AGREES if lower and bare.max() > 0.1 * diameter > 10.0 * kept.max() else DIFFERS,
        f"Wire model, in the working plane; the largest overlap is at pair {int(np.argmax(bare))} of "
        f"{bare.size} one turn apart, counted from the bottom end.",
    )


def _sliding(evidence: Evidence) -> Claim:
    path = evidence.frictionless
    load = abs(path.scene.load.force[1])
    ended = path.outcome != "completed"
    where = (
        ""
        if path.critical_time is None
        else f" at t = {path.critical_time:.3f} ({path.critical_time * load:.0f} N)"
    )
    return Claim(
        "section 4",
        "FE of Spring B needs the no-sliding option to converge.",
        f"frictionless wire model: {path.outcome.replace('_', ' ')}{where}; without sliding: completed",
        AGREES if ended else DIFFERS,
        "The reason is not the solver: where coils slide off each other the branch ends, and no nearby "
        "equilibrium exists for a larger load.",
    )


def _linear(item: CaseEvidence) -> Claim:
    beam, wire = (_curvature(path.times, path.tips[:, 1]) for path in (item.beam, item.wire))
    return Claim(
        "section 4, text on Figure 8",
        "Spring B without contact is linear: only compression, no geometric effects.",
        f"largest deviation of UY from proportionality: beam {100.0 * beam:.1g} %, wire model "
        f"{100.0 * wire:.2f} %",
        AGREES if beam < 1e-6 else DIFFERS,
        "True of the proposed model by its force law. The wire model is not quite linear: radius and helix "
        "angle change.",
    )


def _curvature(times: np.ndarray, values: np.ndarray) -> float:
    straight = times * values[-1]
    return float(np.abs(values - straight).max() / abs(values[-1]))


def _telescopes(item: CaseEvidence) -> Claim:
    counts = []
    for path in (item.wire, item.beam):
        heights = path.circle_centres(-1)[:, 1]
        counts.append(int(np.count_nonzero(heights[2:] < heights[:-2])))
    lowest = item.wire.centreline(-1)[:, 1].min()
    spring = item.case.scene.spring
    bottom = float(spring.height(np.array(spring.phase_range[0])))
    return Claim(
        "section 4, explanation of Table 3",
        "Spring B without contact is unrealistic: it telescopes.",
        f"{counts[0]} (wire model) and {counts[1]} (beam) of {heights.size - 2} crossings of the plane lie "
        f"lower than the one a turn before; lowest wire centre at Y = {lowest:.1f} mm, the bottom coil at "
        f"{bottom:.1f} mm",
        AGREES if min(counts) > 0 and lowest < bottom else DIFFERS,
        "At full load: active coils hang below the bottom coil, which leaves them no room to pass.",
    )


def _under(item: CaseEvidence) -> Claim:
    spring, material = item.case.scene.spring, item.case.scene.material
    heights = [spring.active_height + path.tips[-1, 1] for path in (item.wire, item.beam)]
    needed = [material.E * abs(path.tips[-1, 1]) / spring.active_height for path in (item.wire, item.beam)]
    return Claim(
        "section 4, explanation of Table 3",
        "Spring B without contact: the top coil ends under the bottom one.",
        f"top reference point ends at Y = {heights[0]:.1f} mm (wire model) and {heights[1]:.1f} mm (beam), "
        "the bottom one is at 0",
        AGREES if max(heights) < 0.0 else UNDECIDED,
        f"The paper gives no material. With E = {1e-3 * material.E:.0f} GPa the top coil stays above; "
        f"scaling the deflection with 1/E, it would pass below for E under about {1e-3 * min(needed):.0f} "
        "GPa.",
    )
