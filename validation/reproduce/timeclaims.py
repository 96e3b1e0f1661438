"""Every sentence of the paper that claims a result, assessed: time and iterations.

Seconds of other programs on another machine are not ours to repeat: what the paper says of its own seconds
is held against its own Table 3, and our ratio stands beside.
"""

from __future__ import annotations

from collections.abc import Callable

from validation.reproduce.claims import AGREES, CASE_NAMES, DIFFERS, NOT_COMPARED, Assessment, Claim, claim
from validation.study.cases import CASES, Case
from validation.study.statements import Facts

ON_TABLE = "section 4, text on Table 3"


def times(f: Facts, model: str) -> list[float]:
    """CPU times of the four cases, s."""
    return [f[f"{name}.time.{model}"] for name in CASE_NAMES]


@claim(
    "cost",
    "abstract, introduction",
    "The proposed model is very cheap; FE of the coiled wire with contact is very expensive.",
)
def cost(f: Facts) -> Assessment:
    beam = [1e3 * value for value in times(f, "beam")]
    wire = [1e3 * value for value in times(f, "wire")]
    limit = f["threshold.expensive"]
    expensive, cheap = max(wire) > 1e3 * limit, max(beam) < 1e3 * f["threshold.cheap"] * limit
    first = "The first half holds." if cheap else "The first half does not hold."
    second = (
        " So does the second."
        if expensive
        else f" The second does not for a code made for wires: no FE analysis takes {limit:.0f} s. What the "
        "paper timed was another program."
    )
    return Assessment(
        f"beam {min(beam):.1f} to {max(beam):.1f} ms, wire model {min(wire):.0f} to {max(wire):.0f} ms for "
        f"{f['setting.steps']} substeps",
        AGREES if expensive and cheap else DIFFERS,
        first + second,
    )


def _reduction(case: Case) -> Claim:
    words = f"{case.title}: the proposed model takes {case.paper_reduction:.0f} % less time than FE."

    @claim(f"reduction-{case.name}", "Table 3", words)
    def reduction(f: Facts) -> Assessment:
        ratio, low, high = (f[f"{case.name}.time.ratio{end}"] for end in ("", "_low", "_high"))
        paper = f[f"paper.{case.name}.wire"] / f[f"paper.{case.name}.beam"]
        return Assessment(
            f"{100.0 * (1.0 - 1.0 / ratio):.1f} % (wire model / beam = {ratio:.0f}, quartiles {low:.0f} to "
            f"{high:.0f})",
            NOT_COMPARED,
            f"The paper's factor of {paper:.1f} is one of two other programs on another machine. Our ratio "
            "compares two compiled codes made for springs.",
        )

    return reduction


def contact_factor(letter: str, quantity: Callable[[str], float]) -> float:
    """A quantity with contact over that without."""
    return quantity(f"spring-{letter}") / quantity(f"spring-{letter}-no-contact")


def _ours(f: Facts, model: str) -> Callable[[str], float]:
    return lambda name: f[f"{name}.time.{model}"]


def _paper(f: Facts, model: str) -> Callable[[str], float]:
    return lambda name: f[f"paper.{name}.{model}"]


@claim(
    "competitive",
    ON_TABLE,
    "Where contact matters the proposed model is much more competitive.",
)
def competitive(f: Facts) -> Assessment:
    gains = [contact_factor(letter, lambda name: f[f"{name}.time.ratio"]) for letter in "ab"]
    paper_wire, paper_beam = _paper(f, "wire"), _paper(f, "beam")
    papers = [contact_factor(letter, lambda name: paper_wire(name) / paper_beam(name)) for letter in "ab"]
    more = min(gains) > 1.0
    return Assessment(
        f"contact changes wire model / beam by a factor of {gains[0]:.2f} (A) and {gains[1]:.2f} (B)",
        AGREES if more else DIFFERS,
        f"The paper's own Table 3 gives {papers[0]:.2f} (A) and {papers[1]:.2f} (B)."
        + ("" if more else " Ours: contact adds more to the beam's time than to the wire model's."),
    )


@claim("contact-fe-a", ON_TABLE, "Contact has little effect on the time of FE for Spring A.")
def contact_fe_a(f: Facts) -> Assessment:
    ours, paper = (contact_factor("a", of(f, "wire")) for of in (_ours, _paper))
    little, much = f["threshold.little"], f["threshold.not_little"]
    wire, bare = (f[f"paper.{name}.wire"] for name in ("spring-a", "spring-a-no-contact"))
    verdict = AGREES if paper < little else DIFFERS if paper > much else NOT_COMPARED
    words = {AGREES: "bears it out", DIFFERS: "contradicts it", NOT_COMPARED: "leaves it open"}
    return Assessment(
        f"the paper's own Table 3: {wire:.0f} s / {bare:.0f} s = {paper:.2f}; our wire model with contact / "
        f"without = {ours:.2f}",
        verdict,
        f"The paper's own Table 3 {words[verdict]}. Little: a factor below {little}; not little: above "
        f"{much}.",
    )


@claim("contact-helps", ON_TABLE, "Contact even helps the proposed model converge on Spring A.")
def contact_helps(f: Facts) -> Assessment:
    one, other = (f[f"{name}.paper_iterations"] for name in ("spring-a", "spring-a-no-contact"))
    exact, bare = (f[f"{name}.iterations"] for name in ("spring-a", "spring-a-no-contact"))
    wire, without = (f[f"paper.{name}.beam"] for name in ("spring-a", "spring-a-no-contact"))
    helps, property_ = one < other, exact > bare
    return Assessment(
        f"iterations with / without contact: {one} / {other} = {one / other:.2f} with the paper's tangent, "
        f"{exact} / {bare} = {exact / bare:.2f} with the exact one",
        AGREES if helps else DIFFERS,
        ("So" if helps else "Not so")
        + f" with the paper's tangent (its time: {wire:.0f} s / {without:.0f} s = {wire / without:.2f})."
        + (" It is a property of that tangent, not of the spring." if helps and property_ else ""),
    )


def doubles(f: Facts, model: str, more: str, why: str) -> Assessment:
    """Whether contact doubles the time of Spring B."""
    ours, paper = (contact_factor("b", of(f, model)) for of in (_ours, _paper))
    low, high = f["threshold.doubled"]
    return Assessment(
        f"with contact / without = {ours:.1f}{more}",
        AGREES if low <= ours <= high else DIFFERS,
        f"Doubling means {low} to {high} times; the paper's Table 3 gives {paper:.1f}. {why}",
    )


@claim("doubles-fe", ON_TABLE, "Contact almost doubles the time of Spring B for FE.")
def doubles_fe(f: Facts) -> Assessment:
    return doubles(f, "wire", "", "Contact adds iterations, and the handling of pairs.")


@claim("doubles-beam", ON_TABLE, "Contact almost doubles the time of Spring B for the proposed model.")
def doubles_beam(f: Facts) -> Assessment:
    inexact = contact_factor("b", _ours(f, "beam_paper"))
    exact, paper = f["spring-b-no-contact.iterations"], f["spring-b-no-contact.paper_iterations"]
    return doubles(
        f,
        "beam",
        f" with the exact tangent, {inexact:.1f} with the paper's",
        f"Without contact the beam takes {exact} factorisation in all, or {paper} with the paper's tangent.",
    )


@claim(
    "a-against-b",
    "section 4, text on Figure 8",
    "The proposed model takes far longer for Spring A than for Spring B.",
)
def a_against_b(f: Facts) -> Assessment:
    exact, inexact, paper = (
        f[f"{begin}spring-a{end}"] / f[f"{begin}spring-b{end}"]
        for begin, end in (("", ".time.beam"), ("", ".time.beam_paper"), ("paper.", ".beam"))
    )
    counts = [f[f"spring-{letter}.paper_iterations"] for letter in "ab"]
    return Assessment(
        f"A / B = {inexact:.1f} with the paper's tangent ({counts[0]} and {counts[1]} iterations), "
        f"{exact:.1f} with the exact one",
        AGREES if min(exact, inexact) >= f["threshold.great"] else DIFFERS,
        f"Far longer: at least {f['threshold.great']} times; the paper's factor is {paper:.1f}. A has about "
        "twice as many half coils as B, and B has the contact.",
    )


@claim(
    "one-iteration",
    "section 4, Figure 8",
    "Spring B converges in one iteration before the first contact.",
)
def one_iteration(f: Facts) -> Assessment:
    most, start, exact = f["first.most"], f["first.start"], f["first.exact"]
    once = most <= 1
    return Assessment(
        f"iterations a substep up to first contact at t = {f['first.time']:.2f}: at most {most} with the "
        f"paper's tangent, {start} in the first, which counts the one at rest; {exact} in all with the exact "
        "tangent",
        AGREES if once else DIFFERS,
        "Iterations are factorisations." + (" The response is linear there." if once else ""),
    )


@claim(
    "growing",
    "section 4, Figure 8",
    "Spring A needs a growing number of iterations as the load grows, because of large displacements.",
)
def growing(f: Facts) -> Assessment:
    begin, end, first, last = (
        f[f"growth.{tangent}.{part}"] for tangent in ("paper", "exact") for part in ("begin", "end")
    )
    grows = end > f["threshold.great"] * begin
    other = last > f["threshold.great"] * first
    return Assessment(
        f"mean of the first and the last {f['setting.ends']} substeps: {begin:.1f} and {end:.1f} with the "
        f"paper's tangent, {first:.1f} and {last:.1f} with the exact one",
        AGREES if grows else DIFFERS,
        f"Growing: by more than a factor of {f['threshold.great']}. "
        + ("So" if grows else "Not so")
        + " with the paper's tangent"
        + (
            ", and with the exact one."
            if other
            else "; with the exact one the number does not grow like that."
        )
        + (" The cause is the matrix, which leaves the rotations out." if grows and not other else ""),
    )


@claim("sixth", "conclusions", "The proposed model takes less than 1/6 of FE's time for Spring A.")
def sixth(f: Facts) -> Assessment:
    wire, beam = f["paper.spring-a.wire"], f["paper.spring-a.beam"]
    return Assessment(
        f"the paper's own Table 3: {beam:.0f}/{wire:.0f} = 1/{wire / beam:.1f}; ours "
        f"1/{f['spring-a.time.ratio']:.0f}",
        AGREES if wire / beam > f["threshold.sixth"] else DIFFERS,
        "By the paper's own Table 3; our ratio is one of other programs.",
    )


@claim("twentieth", "conclusions", "The proposed model takes about 1/20 of FE's time for Spring B.")
def twentieth(f: Facts) -> Assessment:
    one, other = (
        f[f"paper.{name}.wire"] / f[f"paper.{name}.beam"] for name in ("spring-b", "spring-b-no-contact")
    )
    low, high = f["threshold.twentieth"]
    return Assessment(
        f"the paper's own Table 3: 1/{one:.1f} with contact and 1/{other:.1f} without; ours "
        f"1/{f['spring-b.time.ratio']:.0f}",
        AGREES if low <= one <= high else DIFFERS,
        f"By the paper's own Table 3; about that means 1/{low} to 1/{high}. Our ratio is one of other "
        "programs.",
    )


TIMES = (
    *(cost, *map(_reduction, CASES), competitive, contact_fe_a, contact_helps, doubles_fe, doubles_beam),
    *(a_against_b, one_iteration, growing, sixth, twentieth),
)
