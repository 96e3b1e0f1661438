"""Closing sections of the report: how things were counted and timed, sliding, and what was assumed."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from coilspring import Material
from coilspring.newton import DECREMENT
from validation import assumptions
from validation.cases import PathStore
from validation.document import Block, Heading, Picture, Text
from validation.evidence import Evidence
from validation.timing import Timing

ELEMENT_NOTE = (
    "The paper calls its elements 2D beams, but it constrains UZ, ROTX and ROTY of the top node, which "
    "only 3D beams have. It gives no material, contact stiffness or exponent; ours are assumptions, "
    "examined below."
)


def timing_notes(timings: Sequence[Timing], where: Mapping[str, str]) -> list[Block]:
    """How Table 3 was measured, where and when."""
    return [
        Text(
            "Median [quartiles]. CPU time of the solve alone, kernels compiled, without building the model "
            f"or writing files; both models in one process, alternately, {timings[0].rounds} rounds, the "
            "first discarded; one thread. The ratio is formed within each round. Both solve the same scene "
            "in the same 50 substeps, the equivalent beam with its exact tangent unless the column says "
            "otherwise; ratio and reduction are those of the exact tangent."
        ),
        Text(
            f"Measured on {where['date']} on {where['processor']}, {where['cores']} cores available, "
            f"{where['system']}; {where['versions']}. The paper's seconds come from its own codes and "
            "machine; only the ratios can be compared."
        ),
    ]


def iteration_notes() -> list[Block]:
    """Stop test and counting rule of Figure 8."""
    return [
        Heading(2, "How iterations are counted (Figure 8)"),
        Text(
            "One iteration is one factorisation, rejected attempts included; the factorisation at rest "
            "counts in the first substep. A substep has converged when the Newton decrement falls below "
            f"{DECREMENT:g} of the reference work, that is 1e-8 of the displacements in the energy norm. "
            "The paper does not state its stop test, so its absolute counts cannot be compared, only how "
            "they grow."
        ),
        Text(
            "With the paper's tangent (its shear-flexible beam matrix, with the factor 12 that its Phi "
            "lacks in print, and the exact contact stiffness) every substep starts from the last state, as "
            "the paper did, and needs an energy line search once coils touch. With the exact tangent a "
            "substep starts from the tangent's prediction; in a linear stretch it needs no factorisation "
            "at all, hence counts of 0. Peaks are substeps in which pairs close, and which are then "
            "divided."
        ),
    ]


def _stepped(evidence: Evidence) -> str:
    """UY of Spring B without sliding by number of substeps, and the spread."""
    values = evidence.stepped
    listed = ", ".join(f"{uy:.4f} mm ({steps})" for steps, uy in values.items())
    spread = (max(values.values()) - min(values.values())) / abs(min(values.values()))
    return f"{listed} for the number of substeps in brackets, a spread of {spread:.1e}"


def sliding_notes(evidence: Evidence, pictured: bool) -> list[Block]:
    """What becomes of the wire model of Spring B without the no-sliding option."""
    path, held = evidence.frictionless, evidence.cases["spring-b"].wire
    load = abs(path.scene.load.force[1])
    blocks: list[Block] = [Heading(2, "Why the paper had to switch sliding off")]
    if path.outcome == "completed":
        return [
            *blocks,
            Text("The frictionless wire model of Spring B completed: the paper's reason is not found."),
        ]
    last = path.times[-1]
    critical = (
        ""
        if path.critical_time is None
        else f" at t = {path.critical_time:.4f} ({path.critical_time * load:.1f} N)"
    )
    blocks.append(
        Text(
            "With frictionless spheres the wire model of Spring B ends in a "
            f"**{path.outcome.replace('_', ' ')}**{critical}. The last substep reached is t = {last:.2f}, "
            f"with UY = {path.tips[-1, 1]:.2f} mm and {path.active_contacts[-1]} closed pairs. There the "
            "tangent becomes singular: coils of the cone are about to slide off each other, and no "
            "equilibrium nearby carries a larger load. Beyond it a solver can only jump, and where it "
            "lands depends on its steps, so no number is printed beyond it. Up to that load sliding hardly "
            f"matters: UY differs by {abs(path.tips[-1, 1] - held.tips[len(path.times) - 1, 1]):.3f} mm "
            "from the solution without sliding. With the no-sliding option, defined as a tangential spring "
            "of the contact stiffness from the first touch on, the path goes on to full load. That rule "
            f"depends on the substeps in which pairs close: UY at full load is {_stepped(evidence)}."
        )
    )
    if pictured:
        blocks.append(
            Picture(
                "sliding.png",
                "Spring B, wire model: without sliding, and frictionless up to its limit point.",
            )
        )
    return blocks


def assumption_notes(store: PathStore, evidence: Evidence) -> list[Block]:
    """What the paper leaves open, and how much it moves the results."""
    material = Material()
    return [
        Heading(2, "What was assumed"),
        Text(
            f"**Material.** The paper gives none: E = {material.E:.0f} MPa and nu = {material.nu:g} (G = "
            f"{material.G:.0f} MPa), spring steel, are assumed in both models. How the equivalent beam's "
            "tips change with it, against the default:"
        ),
        assumptions.material_table(store),
        *_margin(evidence),
        Text(
            "**Contact stiffness.** The paper gives none. K = 1e4 N/mm for each of the 4 sphere pairs a "
            "turn, twice that for each of the beam's 2 circle pairs; exponent 1. Changes against the "
            "default of the same model:"
        ),
        assumptions.penalty_table(store),
        Text(
            "**Start phase.** The paper does not say at which angle to the working plane the active wire "
            "begins; we let it begin in the plane. Turning the helix about its axis changes the wire "
            "model's answer; the paper's law knows the side alone, the helix law knows the phase:"
        ),
        assumptions.phase_table(store),
    ]


def _margin(evidence: Evidence) -> list[Block]:
    """How far above its full load the frictionless beam of Spring B ends, where it does."""
    path = evidence.overloaded
    if path.critical_time is None:
        return []
    return [
        Text(
            f"The frictionless beam of Spring B ends in a {path.outcome.replace('_', ' ')} at "
            f"{evidence.overload:.3f} times the paper's load: there its coils slide off each other too. So "
            "whether the proposed model reaches full load at all rests on the material, which the paper "
            "does not give."
        )
    ]
