"""Closing sections of the report: how things were counted and timed, sliding, and what was assumed."""

from __future__ import annotations

from validation.reproduce import assumptions
from validation.study.cases import PathStore
from validation.study.document import Heading, Picture, Text
from validation.study.statements import Facts, Part, statement

element_note = Text(
    "The paper calls its elements 2D beams, but it constrains UZ, ROTX and ROTY of the top node, which "
    "only 3D beams have. It gives no material, contact stiffness or exponent; ours are assumptions, "
    "examined below."
)


@statement("times.how")
def how_timed(f: Facts) -> str:
    return (
        "Median [quartiles]. CPU time of the solve alone, kernels compiled, without building the model "
        f"or writing files; both models in one process, alternately, {f['timing.rounds']} rounds, the "
        "first discarded; one thread. The ratio is formed within each round. Both solve the same scene "
        f"in the same {f['setting.steps']} substeps, the equivalent beam with its exact tangent unless the "
        "column says otherwise; ratio and reduction are those of the exact tangent."
    )


@statement("times.where")
def where_timed(f: Facts) -> str:
    return (
        f"Measured on {f['machine.date']} on {f['machine.processor']}, {f['machine.cores']} cores available, "
        f"{f['machine.system']}; {f['machine.versions']}. The paper's seconds come from its own codes and "
        "machine: they cannot be compared with ours."
    )


def timing_section() -> list[Part]:
    """How Table 3 was measured, where and when."""
    beside = "The models' errors differ: `coilcheck workprecision` compares their times at equal error."
    return [how_timed, where_timed, Text(beside)]


@statement("iterations.stop")
def stop_test(f: Facts) -> str:
    decrement = f["setting.decrement"]
    return (
        "One iteration is one factorisation, rejected attempts included; the factorisation at rest "
        "counts in the first substep. A substep has converged when the Newton decrement falls below "
        f"{decrement:g} of the reference work, that is {decrement**0.5:g} of the displacements in the energy "
        "norm. The paper does not state its stop test, so its absolute counts cannot be compared, only how "
        "they grow."
    )


def counting_section() -> list[Part]:
    """Stop test and counting rule of Figure 8."""
    return [
        Heading(2, "How iterations are counted (Figure 8)"),
        stop_test,
        Text(
            "With the paper's tangent (its shear-flexible beam matrix, with the factor that its Phi "
            "lacks in print, and the exact contact stiffness) every substep starts from the last state, as "
            "the paper did, and needs an energy line search once coils touch. With the exact tangent a "
            "substep starts from the tangent's prediction; in a linear stretch it needs no factorisation "
            "at all, hence no bars there. Peaks are substeps in which pairs close, and which are then "
            "divided."
        ),
    ]


@statement("sliding.free")
def free_sliding(f: Facts) -> str:
    if f["limit.outcome"] == "completed":
        return "The frictionless wire model of Spring B completed: the paper's reason is not found."
    time = f["limit.time"]
    critical = "" if time is None else f" at t = {time:.4f} ({time * f['limit.load']:.1f} N)"
    reached = (
        f"With frictionless spheres the wire model of Spring B ends in a **{f['limit.outcome']}**{critical}. "
        f"The last substep reached is t = {f['limit.last']:.2f}, with UY = {f['limit.uy']:.2f} mm and "
        f"{f['limit.closed']} closed pairs."
    )
    if time is None:
        return f"{reached} That is no critical point of the spring: the paper's reason is not found."
    return (
        f"{reached} There the tangent becomes singular: coils of the cone are "
        "about to slide off each other, and no equilibrium nearby carries a larger load. Beyond it a "
        "solver can only jump, and where it lands depends on its steps, so no number is printed beyond it. "
        "That this is why the paper had to switch sliding off is plausible; the paper does not say."
    )


@statement("sliding.held")
def no_sliding(f: Facts) -> str:
    values = f["sticking.uy"]
    listed = ", ".join(f"{uy:.4f} mm ({n})" for uy, n in zip(values, f["sticking.steps"], strict=True))
    spread = (max(values) - min(values)) / abs(min(values))
    return (
        f"Up to t = {f['limit.last']:.2f} UY differs by {f['limit.difference']:.3f} mm from the solution "
        "without sliding. With the no-sliding option, defined as a tangential spring of the contact "
        "stiffness from the first touch on, the path goes on to full load. That rule depends on the substeps "
        "in which pairs "
        f"close: UY at full load is {listed} for the number of substeps in brackets, a spread of "
        f"{spread:.1e}."
    )


def sliding_section(pictured: bool) -> list[Part]:
    """What becomes of the wire model of Spring B without the no-sliding option."""
    picture = Picture(
        "sliding.png", "Spring B, wire model: with sticking contact, and frictionless up to its limit point."
    )
    heading = Heading(2, "Why the paper may have had to switch sliding off")
    return [heading, free_sliding, no_sliding, *([picture] if pictured else [])]


@statement("assumed.material")
def material(f: Facts) -> str:
    return (
        f"**Material.** The paper gives none: E = {f['material.E']:.0f} MPa and nu = {f['material.nu']:g} "
        f"(G = {f['material.G']:.0f} MPa), spring steel, are assumed in both models. How the equivalent "
        "beam's tips change with it, against the default:"
    )


@statement("assumed.margin")
def margin(f: Facts) -> str:
    over = f["limit.beam"]
    if over is None:
        return f"The frictionless beam of Spring B ends as {f['limit.beam_outcome']} beyond its full load."
    near = abs(1.0 - 1.0 / over) < f["threshold.match"]  # of the modulus
    return (
        f"The frictionless beam of Spring B ends in a {f['limit.beam_outcome']} at {over:.3f} times the "
        "paper's load: there its coils slide off each other too. "
        + ("So whether" if near else "That is so far from it that whether")
        + " the proposed model reaches full load at all "
        + ("rests" if near else "does not rest")
        + " on the material, which the paper does not give."
    )


@statement("assumed.contact")
def stiffness(f: Facts) -> str:
    return (
        f"**Contact stiffness.** The paper gives none. K = {f['contact.stiffness']:g} N/mm for each of the "
        f"{f['setting.pairs']} sphere pairs per turn, {f['contact.beam']:.2g} times that for each pair of "
        f"the beam's circles; exponent {f['contact.exponent']:g}. Changes against the default of the same "
        "model:"
    )


def assumptions_section(store: PathStore) -> list[Part]:
    """What the paper leaves open, and how much it moves the results."""
    return [
        Heading(2, "What was assumed"),
        material,
        assumptions.material_table(store),
        margin,
        stiffness,
        assumptions.penalty_table(store),
        Text(
            "**Start phase.** The paper does not say at which angle to the working plane the active wire "
            "begins; we let it begin in the plane. Turning the helix about its axis changes the wire "
            "model's answer, as the table by start phase says; the paper's law knows the side alone, the "
            "helix law knows the phase."
        ),
    ]
