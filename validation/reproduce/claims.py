"""Every sentence of the paper that claims a result, assessed by our numbers: the mechanics.

Sentences on time and iterations are in `validation.reproduce.timeclaims`.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

from validation.reproduce.phases import KINDS
from validation.study.statements import Facts, percent

AGREES, DIFFERS = "agrees", "differs"
UNDECIDED, NOT_COMPARED = "cannot be decided", "cannot be compared"
VERDICTS = (AGREES, DIFFERS, UNDECIDED, NOT_COMPARED)


@dataclass(frozen=True)
class Assessment:
    """What we find on one sentence.

    Attributes
    ----------
    ours : our numbers.
    verdict : one of `VERDICTS`.
    why : reason, and what the numbers are measured against.
    """

    ours: str
    verdict: str
    why: str

    def __post_init__(self) -> None:
        if self.verdict not in VERDICTS:
            raise ValueError(f"verdict must be one of {VERDICTS}, got {self.verdict!r}")


@dataclass(frozen=True)
class Claim:
    """One sentence of the paper, and how the facts assess it.

    Attributes
    ----------
    id : its name.
    source : where the paper says it.
    statement : what it says, in our words.
    assess : our assessment by the facts.
    """

    id: str
    source: str
    statement: str
    assess: Callable[[Facts], Assessment]


def claim(id: str, source: str, statement: str) -> Callable[[Callable[[Facts], Assessment]], Claim]:
    """Make a function of the facts the assessment of a sentence of the paper."""
    return lambda assess: Claim(id, source, statement, assess)


@claim(
    "match",
    "abstract, section 4, conclusions",
    "The proposed model matches static FE, although its half-coil law is simple.",
)
def match(f: Facts) -> Assessment:
    worst, limit = curves(f), f["threshold.match"]
    listed = ", ".join(f"{f[f'{name}.title']} {percent(value)}" for name, value in worst.items())
    over = {kind: phase_range(f, kind) for kind in ("few", "many", "bare")}
    return Assessment(
        f"largest difference of the tip curves: {listed} of the peak",
        AGREES if max(worst.values()) < limit else DIFFERS,
        f"Against our wire model on the paper's mesh. Counted as a match below {percent(limit, 0)}, which is "
        f"what {percent(limit, 0)} in the unstated modulus would move. Spring A's numbers hold where the "
        f"helix starts in the working plane; over all start phases they are {over['bare']} without contact, "
        f"{over['few']} with {f['setting.pairs']} sphere pairs per turn, which turn out of the plane with "
        f"the helix, and {over['many']} with {f['setting.many_pairs']}.",
    )


def curves(f: Facts) -> dict[str, float]:
    """Largest difference of the tip curves in each of the four cases."""
    return {name: f[f"{name}.curve"] for name in CASE_NAMES}


CASE_NAMES = ("spring-a", "spring-a-no-contact", "spring-b", "spring-b-no-contact")


def phase_range(f: Facts, kind: str) -> str:
    """Least and largest difference of the tip curves over the start phases."""
    apart = f[f"phases.{kind}.difference"]
    return f"{100.0 * min(apart):.2f} to {percent(max(apart))}"


def superimposed(f: Facts, name: str, more: str = "") -> Assessment:
    """Whether shapes can be told apart."""
    apart, diameter, limit = f[f"{name}.shape"], f["wire.diameter"], f["threshold.superimposed"]
    return Assessment(
        f"contact circles deviate by at most {apart:.3f} mm ({percent(apart / diameter, 1)} of the wire "
        f"diameter), tip curves {percent(f[f'{name}.curve'])}",
        AGREES if apart < limit * diameter else DIFFERS,
        "At full load, against the wire model on the paper's mesh; superimposed means below "
        f"{percent(limit, 0)} of the wire diameter.{more}",
    )


SHAPES = "{}: the deformed shapes of both models can hardly be told apart."


@claim("shape-a-bare", "section 4, Figure 4 left", SHAPES.format("Spring A without contact"))
def shape_a_bare(f: Facts) -> Assessment:
    return superimposed(f, "spring-a-no-contact")


@claim("shape-a", "section 4, Figure 4 right", SHAPES.format("Spring A with contact"))
def shape_a(f: Facts) -> Assessment:
    return superimposed(f, "spring-a")


@claim("shape-b", "section 4, Figure 6", SHAPES.format("Spring B with contact"))
def shape_b(f: Facts) -> Assessment:
    alike, apart = f["sticking.shape"], f["spring-b.shape"]
    part = "Part of this is" if alike < apart else "None of this is"
    more = (
        f" {part} the paper's own comparison: its FE does not slide, its beam is frictionless; a beam "
        f"with sticking contact deviates by at most {alike:.3f} mm."
    )
    return superimposed(f, "spring-b", more)


@claim(
    "vertical",
    "section 4, Figure 5",
    "Contact changes Spring A's tip displacements, the vertical one above all.",
)
def vertical(f: Facts) -> Assessment:
    parts, most = [], True
    for label, model in (("wire model", "wire"), ("beam", "beam")):
        pairs = zip(f[f"spring-a.{model}"], f[f"spring-a-no-contact.{model}"], strict=True)
        ux, uy, rotz = change = [new / old - 1.0 for new, old in pairs]
        most = most and abs(uy) == max(map(abs, change))
        parts.append(f"{label}: UX {100 * ux:+.1f} %, UY {100 * uy:+.1f} %, ROTZ {100 * rotz:+.1f} %")
    return Assessment(
        "at full load, " + "; ".join(parts),
        AGREES if most else DIFFERS,
        "Change by contact, each model against itself without contact.",
    )


def softer(f: Facts, kinds: Sequence[str]) -> Assessment:
    """Whether the beam is always softer than the wire model, whose start phase is not given."""
    steps, parts, always, ever = f["setting.steps"], [], True, False
    for kind in kinds:
        farther = [f[f"phases.{kind}.{name}"] for name in ("ux", "uy", "rotz")]
        listed = ", ".join(
            f"{name} {100.0 * min(shares):+.2f} to {100.0 * max(shares):+.2f} %"
            for name, shares in zip(("UX", "UY", "ROTZ"), farther, strict=True)
        )
        counts = f[f"phases.{kind}.softer"]
        everywhere = sum(count == steps for count in counts)
        parts.append(
            f"{kind_title(f, kind)}: beam moves farther by {listed}; in every component and all {steps} "
            f"substeps at {everywhere} of {len(counts)} phases"
        )
        always = always and everywhere == len(counts)
        ever = ever or any(min(row) > 0.0 for row in zip(*farther, strict=True))
    signs = {
        AGREES: "It is softer at every start phase of the helix, which the paper does not give.",
        DIFFERS: "It is softer in all components at no start phase of the helix.",
        UNDECIDED: "The paper does not give the start phase of the helix, and the sign changes with it.",
    }
    verdict = AGREES if always else UNDECIDED if ever else DIFFERS
    return Assessment(
        "at full load over the start phases, " + "; ".join(parts),
        verdict,
        f"{signs[verdict]} Against the wire model on the paper's mesh; the table over the phases is below.",
    )


def kind_title(f: Facts, kind: str) -> str:
    """A contact of the table over the phases, in words."""
    pairs = {"few": "setting.pairs", "many": "setting.many_pairs"}
    return f"{f[pairs[kind]]} sphere pairs per turn" if kind in pairs else "no contact"


ALWAYS = "Spring A {}: the proposed model is always softer than FE."


@claim("softer-bare", "section 4, Figure 5", ALWAYS.format("without contact"))
def softer_bare(f: Facts) -> Assessment:
    return softer(f, ("bare",))


@claim("softer-contact", "section 4, Figure 5", ALWAYS.format("with contact"))
def softer_contact(f: Facts) -> Assessment:
    return softer(f, [name for name in KINDS if name != "bare"])


@claim(
    "compenetration",
    "section 4, explanation of Table 3",
    "Without contact the bottom coils of Spring A run into each other; contact prevents it.",
)
def compenetration(f: Facts) -> Assessment:
    diameter, bare, kept = f["wire.diameter"], f["overlap.without"], f["overlap.with"]
    lower = f["overlap.pair"] < f["threshold.low"] * f["overlap.pairs"]
    limit = f["threshold.overlap"] * diameter
    return Assessment(
        f"largest overlap {bare:.2f} mm ({percent(bare / diameter, 0)} of the wire diameter) without "
        f"contact, {1e3 * kept:.1f} µm with it",
        AGREES if lower and bare > limit and kept < f["threshold.overlap"] * limit else DIFFERS,
        f"Wire model, in the working plane; the largest overlap is at pair {f['overlap.pair']} of "
        f"{f['overlap.pairs']} one turn apart, counted from the bottom end.",
    )


@claim("sliding", "section 4", "FE of Spring B needs the no-sliding option to converge.")
def sliding(f: Facts) -> Assessment:
    ended = f["limit.outcome"] != "completed"
    why = (
        "An inference, not a fact: our branch ends because spheres slide off each other, and no nearby "
        "equilibrium exists for a larger load. That is a plausible reason why the paper's FE did not "
        "converge there; it does not say what its program reported. The end belongs to spheres: smooth "
        "wires need not slide off."
        if ended
        else "Our frictionless wire model does not need it: the paper's reason is not found."
    )
    return Assessment(
        f"frictionless wire model: {f['limit.outcome']}{_where(f)}; without sliding: completed",
        AGREES if ended else DIFFERS,
        why,
    )


def _where(f: Facts) -> str:
    time = f["limit.time"]
    return "" if time is None else f" at t = {time:.3f} ({time * f['limit.load']:.0f} N)"


@claim(
    "linear",
    "section 4, text on Figure 8",
    "Spring B without contact is linear: only compression, no geometric effects.",
)
def linear(f: Facts) -> Assessment:
    beam, wire = f["linear.beam"], f["linear.wire"]
    straight = beam < ROUNDING
    return Assessment(
        f"largest deviation of UY from proportionality: beam {100.0 * beam:.1g} %, wire model "
        f"{percent(wire)}",
        AGREES if straight else DIFFERS,
        ("True of the proposed model by its force law." if straight else "Not true of the proposed model.")
        + (" The wire model is not quite linear: radius and helix angle change." if wire > ROUNDING else ""),
    )


ROUNDING = 1e-6  # what is less is no deviation


@claim(
    "telescopes",
    "section 4, explanation of Table 3",
    "Spring B without contact is unrealistic: it telescopes.",
)
def telescopes(f: Facts) -> Assessment:
    lowest, bottom = f["telescope.lowest"], f["telescope.bottom"]
    through = min(f["telescope.wire"], f["telescope.beam"]) > 0 and lowest < bottom
    return Assessment(
        f"{f['telescope.wire']} (wire model) and {f['telescope.beam']} (beam) of "
        f"{f['telescope.crossings']} crossings of the plane lie lower than the one before on that side; "
        f"lowest wire centre at Y = {lowest:.1f} mm, the bottom coil at {bottom:.1f} mm",
        AGREES if through else DIFFERS,
        "At full load: active coils hang below the bottom coil, which leaves them no room to pass."
        if through
        else "At full load: not all of it is seen.",
    )


@claim(
    "under",
    "section 4, explanation of Table 3",
    "Spring B without contact: the top coil ends under the bottom one.",
)
def under(f: Facts) -> Assessment:
    heights, E = (f["under.wire"], f["under.beam"]), f["material.E"]
    needed = E * min((f["under.height"] - height) / f["under.height"] for height in heights)
    below = max(heights) < 0.0
    stays = "passes below" if below else "stays above"
    return Assessment(
        f"top reference point ends at Y = {heights[0]:.1f} mm (wire model) and {heights[1]:.1f} mm (beam); "
        "the bottom one is the origin",
        AGREES if below else UNDECIDED,
        f"The paper gives no material. With E = {1e-3 * E:.0f} GPa the top coil {stays}; scaling the "
        f"deflection with the modulus, it passes below for E under about {1e-3 * needed:.0f} GPa.",
    )


MECHANICS = (
    *(match, shape_a_bare, shape_a, shape_b, vertical, softer_bare, softer_contact),
    *(compenetration, sliding, linear, telescopes, under),
)
