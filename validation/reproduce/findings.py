"""Findings, each computed from recorded evidence: ``python -m validation.reproduce.findings``."""

from __future__ import annotations

import textwrap
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from validation.reproduce.claims import (
    AGREES,
    CASE_NAMES,
    UNDECIDED,
    curves,
    match,
    phase_range,
    softer_bare,
    softer_contact,
)
from validation.reproduce.records import Records
from validation.reproduce.timeclaims import cost
from validation.study.output import write_text
from validation.study.statements import Facts, Statement, percent, statement

PAGE = Path("docs/findings.md")
WIDTH = 110
HEAD = """\
# Findings

Written by `python -m validation.reproduce.findings` from recorded results: each finding with its numbers and
the place where they are measured. Material, penalty and much else of the paper's springs had to be assumed
([effect of these](../reports/sensitivity/sensitivity.md)); nothing here is compared with a measured spring.
Full load unless said otherwise; *curve* is the largest difference of the top's displacements over the
reference's peak.
"""
REPORT = "../reports/paper/report.md"
SENTENCES = f"[Report]({REPORT}#what-the-paper-says-sentence-by-sentence)"
PHASES = f"[Report]({REPORT}#which-model-is-softer-by-start-phase)"
SENSITIVITY = "../reports/sensitivity/sensitivity.md"
SOLID = "solid: standing.{}.{}.{}"
BODY = "[Solid](../reports/solid/solid.md)"
BUDGET = "[Error budget](error-budget.md#the-papers-four-cases)"
FOUR = "errorbudget/fourcases > table={} | row={} | case={} > value"
INPUT = "sensitivity/sensitivity > case={} | model={} | input={} | value={} > {}"
TOUCHING_B, BARE_A, BARE_B = "Spring B", "Spring A w/o contacts", "Spring B w/o contacts"
ALIKE = 0.01  # per cent: what is less is the same


def span(values: Sequence[float], digits: int) -> str:
    """Least to largest."""
    return f"{min(values):.{digits}f} to {max(values):.{digits}f}"


# On the paper's claims


@statement("findings.match")
def matching(f: Facts) -> str:
    error = {name: percent(value) for name, value in curves(f).items()}
    meshes = [100.0 * f[f"{name}.mesh"] for name in CASE_NAMES]
    verb = "matches" if match.assess(f).verdict == AGREES else "does not match"
    return (
        f"**The equivalent beam {verb} the wire model where the helix starts in the working plane.** "
        f"Curves deviate by at most {error['spring-a']} (Spring A) and {error['spring-b']} (Spring B) "
        f"with contact, {error['spring-a-no-contact']} and {error['spring-b-no-contact']} without; the FE "
        f"mesh itself errs by {span(meshes, 2)} %. Over all start phases, which the paper does not give, "
        f"Spring A's deviate by {phase_range(f, 'bare')} without contact, {phase_range(f, 'few')} with "
        f"{f['setting.pairs']} sphere pairs per turn and {phase_range(f, 'many')} with "
        f"{f['setting.many_pairs']}. [Report]({REPORT}#deviation-of-the-models)"
    )


@statement("findings.softer")
def softer(f: Facts) -> str:
    verdicts = {softer_bare.assess(f).verdict, softer_contact.assess(f).verdict}
    head = (
        "Which model is softer cannot be decided."
        if verdicts == {UNDECIDED}
        else f"The paper's beam is always softer than FE: {' and '.join(sorted(verdicts))}."
    )
    bare, many = ([100.0 * share for share in f[f"phases.{kind}.uy"]] for kind in ("bare", "many"))
    pairs = zip(f["phases.bare.degrees"], f["phases.bare.softer"], strict=True)
    always = " and ".join(str(angle) for angle, count in pairs if count == f["setting.steps"])
    whole = (
        f"without contact it is softer in all components at all loads, as the paper says, at {always} degrees"
        if always
        else "at no phase is it softer in all components at all loads"
    )
    return (
        f"**{head}** The paper calls its beam always softer than FE, and does not give the start phase of "
        f"the helix. Over the phases the beam's UY is off by {min(bare):+.1f} to {max(bare):+.1f} % without "
        f"contact, {min(many):+.1f} to {max(many):+.1f} % with {f['setting.many_pairs']} pairs per turn; "
        f"{whole}. {PHASES}"
    )


@statement("findings.time")
def faster(f: Facts) -> str:
    ratios = [f[f"{name}.time.ratio"] for name in CASE_NAMES]
    papers = [f[f"paper.{name}.wire"] / f[f"paper.{name}.beam"] for name in CASE_NAMES]
    wire = [1e3 * f[f"{name}.time.wire"] for name in CASE_NAMES]
    faster = (
        f"{span(ratios, 0)} times faster than" if min(ratios) > 1.0 else f"{span(ratios, 2)} times as fast as"
    )
    cheap = (
        'so "very expensive" is not the method\'s.'
        if cost.assess(f).verdict != AGREES
        else 'so FE is "very expensive", as the paper says.'
    )
    return (
        f"**The beam is {faster} the wire model.** The paper's table has "
        f"{span(papers, 1)} times, of other programs: the two cannot be compared. Our whole FE path takes "
        f"{span(wire, 0)} ms; {cheap} {SENTENCES}"
    )


@statement("findings.sliding")
def sliding(f: Facts) -> str:
    time, over = f["limit.time"], f["limit.beam"]
    beam = (
        f"The beam's ends too, at a {f['limit.beam_outcome']} at {over:.3f} of the load."
        if over is not None
        else f"The beam beyond its full load: {f['limit.beam_outcome']}."
    )
    if time is None:
        return (
            '**"No sliding" of Spring B is not explained:** without it the outcome of the wire model is: '
            f"{f['limit.outcome']}. {beam} [Report]({REPORT}#verdict)"
        )
    return (
        '**The FE of Spring B plausibly needed "no sliding" because the branch ends without it:** our wire '
        f"model, at a {f['limit.outcome']} at {time:.3f} of the load. {beam} [Report]({REPORT}#verdict)"
    )


@statement("findings.tangent")
def tangent(f: Facts) -> str:
    exact, paper, printed = (f[f"tangents: spring-a.{name}"] for name in ("exact", "paper", "paper-printed"))
    owner = (
        "belong to the paper's matrix, not to the spring" if paper > exact else "do not belong to the matrix"
    )
    return (
        f"**Growing iteration counts {owner}.** Spring A, {f['setting.steps']} steps: {paper:.0f} "
        f"iterations with that matrix, {exact:.0f} with the exact tangent; with the Phi as printed, "
        f"{printed:.0f}. [Tangents](tangents.md#fifty-steps)"
    )


# On what decides the answer


@statement("findings.height")
def height(f: Facts) -> str:
    def change(name: str, value: str) -> float:
        found = (f[INPUT.format("spring-a", model, name, value, "uy_change_percent")] for model in MODELS)
        return max(map(abs, found))

    moved = change("reference_height", "+d")
    material = max(change("E", "196 GPa"), change("nu", "0.26"))
    than = "more" if moved > material else "less"
    return (
        f"**The height of the loaded point moves Spring A's UY by up to {moved:.0f} %,** {than} than the "
        f"material ({material:.1f} %); the paper does not say it. [Sensitivity]({SENSITIVITY}#spring-a)"
    )


MODELS = ("equivbeam", "wirefe")


@statement("findings.spheres")
def spheres(f: Facts) -> str:
    def at(angle: int, column: str) -> Any:
        return f[INPUT.format("spring-a", "wirefe", "sphere_place", f"{angle}°", column)]

    near, far = 30, 45
    apart, outcome = at(near, "models_apart_percent"), at(far, "outcome")
    much = apart > 100.0 * f["threshold.match"]
    so = " The paper's two models agree, so its spheres cannot have stood far out." if much else ""
    ends = (
        f"{abs(at(far, 'uy_change_percent')):.0f} % of it"
        if outcome == "completed"
        else f"its path ends: {outcome.replace('_', ' ')}"
    )
    return (
        f"**Where the spheres stand {'matters' if much else 'hardly matters'}:** {at(near, 'value')} out of "
        f"the plane they move the wire model's UY by {abs(at(near, 'uy_change_percent')):.0f} %, and the "
        f"two models deviate by {apart:.0f} %; at {at(far, 'value')}, {ends}.{so} "
        f"[Sensitivity]({SENSITIVITY}#spring-a)"
    )


@statement("findings.penalty")
def penalty(f: Facts) -> str:
    most = [
        max(
            abs(f[INPUT.format(spring, model, "penalty", value, "curve_change_percent")])
            for model in MODELS
            for value in ("K/10", "10 K")
        )
        for spring in ("spring-a", "spring-b")
    ]
    how = "hardly matters" if max(most) < 100.0 * f["threshold.match"] else "matters"
    return (
        f"**The penalty {how}:** a decade up or down, at most {most[0]:.2f} % of the curve (Spring A) and "
        f"{most[1]:.2f} % (Spring B). [Sensitivity]({SENSITIVITY}#spring-b)"
    )


@statement("findings.phase")
def phase(f: Facts) -> str:
    values = [
        INPUT.format("spring-a", "wirefe", "start_phase", angle, "uy_change_percent")
        for angle in ("60°", "270°")
    ]
    moved = max(abs(f[value]) for value in values)
    angles = (90, 270)
    helix = max(f[FOUR.format("law", f"helix law, start phase {angle} degrees", BARE_A)] for angle in angles)
    apart = dict(zip(f["phases.bare.degrees"], f["phases.bare.difference"], strict=True))
    paper = max(apart[angle] for angle in apart if angle % 180 == 90)
    know = "can" if helix < 100.0 * paper else "does not"
    return (
        f"**The start phase moves the wire model's UY by up to {moved:.1f} % (Spring A), and an in-plane "
        f"model {know} know it:** where an end holds the wire, an axial force tilts the axis about the "
        "radius to that end, and sets it off by the growth of the coil. With both in the law, Spring A "
        f"without contact is within {helix:.3f} % of the wire model where the helix starts a quarter turn "
        f"out of the plane; the paper's law is off by {percent(paper, 1)} there. "
        f"[Sensitivity]({SENSITIVITY}#spring-a), {BUDGET}"
    )


# On contact


@statement("findings.limit")
def limit(f: Facts) -> str:
    along, pairs, outcome = (f[f"contact: search.{name}"] for name in ("along", "pairs", "outcome"))
    completes = outcome == "completed"
    owner = "belongs to the spheres" if completes else "does not go with more spheres"
    return (
        f"**The limit point of frictionless Spring B {owner}:** spheres pressed on each other slide off "
        f"along the wire ({along:.0f} % of the motion), smooth wires need not; with {pairs:.0f} pairs per "
        f"turn the outcome is: {outcome}. [Contact](contact.md#search)"
    )


@statement("findings.pairs")
def pairs(f: Facts) -> str:
    count = f["contact: pairs.count"]
    overlap = [f[f"contact: pairs.{name}.overlap"] for name in "AB"]
    lost = [f[f"contact: pairs.{name}.difference"] for name in "AB"]
    return (
        f"**With {count:.0f} pairs per turn {overlap[0]:.3f} mm (A) and {overlap[1]:.3f} mm (B) of overlap "
        f"are left** between the pairs; they cost {lost[0]:g} % and {lost[1]:g} % of the tips. "
        "[Contact](contact.md#sphere-pairs-per-turn)"
    )


@statement("findings.no-sliding")
def no_sliding(f: Facts) -> str:
    couples, free, held = (f[f"contact: friction.{name}"] for name in ("couples", "free", "held"))
    small = "no small matter" if abs(held / free - 1.0) > f["threshold.match"] else "a small matter"
    return (
        f'**"No sliding" is {small} on Spring A:** the couples that it leaves are '
        f"{couples:.0f} % of the load's moment, and UY goes from {free:.2f} to {held:.2f} mm. "
        "[Contact](contact.md#friction)"
    )


# On the half-coil law


@statement("findings.helix")
def helix(f: Facts) -> str:
    law, paper = (
        [f[FOUR.format(table, row, case)] for case in (BARE_B, BARE_A)]
        for table, row in (("law", "helix law"), ("refinements", "Haringx, the paper's law"))
    )
    less = [f[FOUR.format("law", f"without `{name}`", BARE_B)] for name in ("large", "held", "shear")]
    needs = "needs" if min(less) > 2.0 * law[0] else "does not need"
    mends = "mends" if max(a / b for a, b in zip(law, paper, strict=True)) < 0.5 else "does not mend"
    solid, rods, old = (
        [f[SOLID.format(spring, *which)] for spring in ("spring-b-no-contact", "spring-a-no-contact")]
        for which in (("helix law", "solid"), ("helix law", "beam"), ("paper's law", "beam"))
    )
    alone = all(mine < theirs for mine, theirs in zip(rods, old, strict=True))
    truth = "too, also with a wire of beams" if alone else "with the solid wire alone"
    if not all(mine < theirs for mine, theirs in zip(solid, old, strict=True)):
        truth = "on neither or one of them"
    return (
        f"**A helix in large deformation {mends} the paper's law without contact, against rods:** "
        f"{paper[0]:.2f} to {law[0]:.2f} % (Spring B) and {paper[1]:.2f} to {law[1]:.2f} % (Spring A). "
        f"Spring B {needs} large deformation, fixed winding and wire shear together: without one of them "
        f"{less[0]:.2f}, {less[1]:.2f}, {less[2]:.2f} %. Against the wire as a solid body it is nearer than "
        f"the paper's law {truth}: {solid[0]:.2f} and {solid[1]:.2f} % with the solid wire, {rods[0]:.2f} "
        f"and {rods[1]:.2f} % with beams; the paper's law {old[0]:.2f} and {old[1]:.2f} %. {BUDGET}, {BODY}"
    )


@statement("findings.outside")
def outside(f: Facts) -> str:
    share = f[FOUR.format("outside", "normal forces", TOUCHING_B)]
    touching, bare = (f[FOUR.format("law", "helix law", name)] for name in (TOUCHING_B, BARE_B))
    where = "beside" if share > 50.0 else "in"  # per cent
    root = ", where the first root of tan(phi) = phi lies" if share > 50.0 else ""
    return (
        f"**The coils of an axially loaded spring meet {where} the plane in which its wire starts:** "
        f"{share:.0f} % of Spring B's normal forces are beside it{root}. The beam's circles lie in that "
        f"plane: in contact the helix law is {touching:.2f} % from the wire model, without "
        f"{bare:.2f} %. {BUDGET}, [Theory](theory.md#2-equivalent-beam-equivbeam)"
    )


@statement("findings.random")
def random(f: Facts) -> str:
    def values(law: str, contact: str, *names: str) -> list[float]:
        return [f[f"errorbudget: {law}.{contact}.{name}"] for name in names]

    share = ("median", "percentile")
    bare, closed = (values("helix", contact, *share) for contact in ("open", "closed"))
    paper, paper_closed = (values("haringx", contact, *share) for contact in ("open", "closed"))
    springs, bound = values("helix", "open", "springs", "bound")
    touching, bound_closed = values("helix", "closed", "springs", "bound")
    nearer = "The helix law is nearer" if bare < paper and closed < paper_closed else "Neither law is nearer"
    return (
        f"**{nearer} on random springs of any start phase,** guided, pinned or free, loaded along or across "
        f"their axis. Without contact ({springs:.0f} springs) its tip is off by {bare[0]:.2g} % in the "
        f"median, and one spring in twenty by more than {bare[1]:.2g} % (bound {bound:.2g} %); by the "
        f"paper's law {paper[0]:.2g} and {paper[1]:.2g} %. Where more than three pairs close "
        f"({touching:.0f} springs): "
        f"{closed[0]:.2g} and {closed[1]:.2g} % (bound {bound_closed:.2g} %), and {paper_closed[0]:.2g} and "
        f"{paper_closed[1]:.2g} %. By kind of load: [Error budget](error-budget.md#random-springs)"
    )


# On the codes


@statement("findings.solid")
def solid_body(f: Facts) -> str:
    axial, others, beam, coarse = (f[f"solid: {name}"] for name in ("axial", "others", "beam.axial", "mesh"))
    rate, rod, coils, index = (
        f[f"solid: {name}"] for name in ("rate.solid", "rate.beam", "coils", "indices")
    )
    stiffer = "stiffer" if rate > rod else "not stiffer"
    nearer = "nearer to it" if abs(rate) < abs(rate - rod) else "farther from it"
    return (
        f"**A coiled wire is {stiffer} than a straight rod with shear,** which our models' wire is unless "
        f"asked otherwise: axially, Spring A's by {rate - rod:.1f} %. The textbook's rate is {nearer} "
        f"({-rate:+.2f} %). With the solid wire the wire model is within {axial:.2f} % (axial) and "
        f"{others:.2f} % (other directions) of solid elements on {coils:g} coils of index {span(index, 0)}, "
        f"whose coarse mesh is off by {coarse:.2f} %; with beams it is off by up to {beam:.1f} %. {BODY}"
    )


@statement("findings.exact")
def exact(f: Facts) -> str:
    count, failed, curved = (f[f"verification: {name}"] for name in ("checks", "failed", "curved"))
    head = "meets" if not failed else "does not meet all"
    return (
        f"**The wire model {head} exact and published solutions of rods:** {count - failed} of {count} "
        f"checks pass; the fewest curved elements per turn are within {curved:.1e} of the exact rod on both "
        "springs. [Validation](validation.md)"
    )


@statement("findings.opensees")
def opensees(f: Facts) -> str:
    names = ("spring-a", "spring-a-no-contact", "spring-b-no-contact")
    equal = [f[f"referee: opensees.{name}.equal"] for name in names]
    chosen = [f[f"referee: opensees.{name}.{how}"] for name in names for how in ("fewest", "fastest")]
    apart = max(f[f"referee: opensees.{name}.difference"] for name in names)
    same = "the same tips" if apart < ALIKE else "other tips"
    return (
        f"**OpenSees finds {same}** ({apart:.4f} % at most in {f['setting.steps']} steps) in "
        f"{span(equal, 0)} times the time for the same steps, {span(chosen, 0)} times where each takes the "
        "steps that suit it. [OpenSees](../reports/referee/opensees.md)"
    )


@statement("findings.curved")
def curved(f: Facts) -> str:
    def run(element: str, elements: int, *columns: str) -> list[float]:
        row = (
            f"scene=spring-b | series={element} | elements_per_turn={elements} | pairs_per_turn=4 | steps=50"
        )
        return [f[f"workprecision/workprecision > {row} | role=run > {each}"] for each in columns]

    columns = ("elements_per_turn", "curve_max", "ratio_to_paper_mesh")
    (count, error, part), (paper, mesh) = run("curved", 4, *columns), run("straight", 40, *columns[:2])
    beat = "beat" if error < mesh and part < 1.0 else "do not beat"
    return (
        f"**{count:.0f} curved elements per turn {beat} the paper's {paper:.0f} straight ones:** "
        f"{100.0 * error:.3f} % in place of {100.0 * mesh:.1f} % (Spring B), in "
        f"1/{1.0 / part:.1f} of the time. "
        "[Run time against error](../reports/workprecision/workprecision.md#what-the-papers-accuracy-costs)"
    )


@statement("findings.stability")
def stability(f: Facts) -> str:
    beam, wire = (
        {name: f[f"stability: {model}.{name}"] for name in names}
        for model, names in (("beam", OUTCOMES[:4]), ("wire", OUTCOMES))
    )
    left = beam["unexplained"] + wire["unexplained"]
    return (
        f"**Of the sampled equivalent beams {beam['completed']} reach full load and {beam['critical']} a "
        f"critical point** that code of its own confirms; of the wires {wire['completed']} and "
        f"{wire['critical']}. {beam['interpenetration']} and {wire['interpenetration']} end where coils pass "
        f"through each other, {left or 'none'} left unexplained. With friction {wire['ended']} end where "
        f"the iteration does, not the spring, or where a sticking pair opens; {wire['deviation']} "
        "depend on their substeps. [Stability "
        "campaign](../reports/stability/stability.md#outcome-statistics)"
    )


OUTCOMES = ("completed", "critical", "interpenetration", "unexplained", "ended", "deviation")

SECTIONS: dict[str, tuple[Statement, ...]] = {
    "On the paper's claims": (matching, softer, faster, sliding, tangent),
    "On what decides the answer": (height, spheres, penalty, phase),
    "On contact": (limit, pairs, no_sliding),
    "On the half-coil law": (helix, outside, random),
    "On the codes": (solid_body, exact, opensees, curved, stability),
}


def page(facts: Facts) -> str:
    """The findings as Markdown."""
    parts = [HEAD]
    for title, items in SECTIONS.items():
        lines = [_item(number, item.words(facts)) for number, item in enumerate(items, 1)]
        parts.append(f"## {title}\n\n" + "\n".join(lines) + "\n")
    return "\n".join(parts)


def _item(number: int, words: str) -> str:
    return textwrap.fill(
        f"{number}. {words}", WIDTH, subsequent_indent="   ", break_long_words=False, break_on_hyphens=False
    )


if __name__ == "__main__":
    write_text(PAGE, page(Records()))
