"""Sentences of the report and of the findings: each number and verdict moves with its evidence."""

from __future__ import annotations

import re
from collections.abc import Mapping
from functools import partial
from types import MappingProxyType

import pytest
from jinja2 import UndefinedError

from validation.reproduce import claims
from validation.reproduce.claims import AGREES, CASE_NAMES, CLAIMS, DIFFERS, NOT_COMPARED, UNDECIDED
from validation.reproduce.findings import FINDINGS, ROOT, Records, findings
from validation.reproduce.report import REPORT
from validation.study.template import statement, template

NUMBER = re.compile(r"(?<![\w.])[+-]?\d+(?:\.\d+)*(?:e[+-]?\d+)?(?!\w)")
# numbers that name a place, not a result, and the 1 over another number
NAMES = re.compile(r"Figures? \d|Tables? \d|section \d|\(\d+\)-\(\d+\)|\b1(?=/)|\]\([^)]*\)")
SCALES = (1.03, 0.97, 1.3, 0.7, 2.0, 0.5, 10.0, 0.1, 1e9, 1e-9, -1.0, 0.0)


class Changed(Mapping):
    """Facts of which some are replaced; remembers what was read."""

    def __init__(self, facts, replaced=MappingProxyType({})):
        self.facts, self.replaced, self.read = facts, replaced, []

    def __getitem__(self, key):
        self.read.append(key)
        return self.replaced[key] if key in self.replaced else self.facts[key]

    def __iter__(self):
        return iter(self.facts)

    def __len__(self):
        return len(self.facts)


def changes(value, steps):
    """Other values that a fact could have; `steps` are all the substeps."""
    match value:
        case None:
            yield 0.5
        case str():
            yield from (
                re.sub(r"\d", lambda digit: str((int(digit[0]) + 3) % 10), value),
                "completed",
                "other",
            )
        case (str(), *others):
            yield from (("other", *others), others)
        case tuple():
            for scale in SCALES:
                yield tuple(scale * item for item in value)
            yield tuple(item + i for i, item in enumerate(value))
            yield tuple(item - 1.0 for item in value)
            yield from ((steps,) * len(value), value[:-1])
        case _:
            yield from (type(value)(scale * value) for scale in SCALES)
            yield from (value + 1, None)


def texts(words, facts, key):
    """What a sentence says where one fact is another."""
    for value in changes(facts[key], facts.get("setting.steps")):
        try:
            yield words(Changed(facts, {key: value}))
        except (TypeError, ValueError, ZeroDivisionError, IndexError, OverflowError, UndefinedError):
            continue  # no such evidence


def split(text):
    """Numbers of a sentence, and the rest."""
    text = NAMES.sub("", text)
    return NUMBER.findall(text), NUMBER.sub("#", text)


def fixed_numbers(words, facts):
    """Numbers that no fact moves while the rest of the sentence stays, and facts that change nothing."""
    read = Changed(facts)
    text = words(read)
    numbers, rest = split(text)
    moved, idle = set(), set()
    for key in dict.fromkeys(read.read):
        others = [other for other in texts(words, facts, key) if other != text]
        idle |= set() if others else {key}
        for found, skeleton in map(split, others):
            if skeleton == rest:
                moved |= {i for i, pair in enumerate(zip(numbers, found, strict=True)) if pair[0] != pair[1]}
    return [number for i, number in enumerate(numbers) if i not in moved], idle, set(read.read) - idle


def judged(name):
    """Our numbers on a claim, our verdict and why, as one text."""
    return lambda facts: " | ".join(claims.assessed(name, facts)[2:])


FACTS = Records()
SENTENCES = {
    f"{page.name.removesuffix('.md')}.{name}": partial(statement, page, name)
    for page in (REPORT, FINDINGS)
    for name in page.blocks
}
EVERYTHING = SENTENCES | {name: judged(name) for name in CLAIMS}


def test_each_claim_is_named_once():
    assert len(CLAIMS) == len(set(CLAIMS)) == 27


@pytest.mark.parametrize("name", EVERYTHING)
def test_every_number_moves_with_the_evidence(name):
    fixed, _, used = fixed_numbers(EVERYTHING[name], FACTS)
    assert used, "no evidence"
    assert not fixed


def test_what_a_sentence_reads_it_says():
    """Each fact that is read changes a sentence or a judgement."""
    found = [fixed_numbers(words, FACTS) for words in EVERYTHING.values()]
    assert not set().union(*(idle for _, idle, _ in found)) - set().union(*(used for *_, used in found))


def test_a_constant_sentence_is_found():
    """The test would see one."""
    assert fixed_numbers(lambda f: "at most 0.12 %", {})[0] == ["0.12"]
    assert fixed_numbers(lambda f: f"{f['a']} of 12", {"a": 3})[0] == ["12"]
    assert fixed_numbers(lambda f: f"{f['a']} in Table 3", {"a": 3, "b": 2})[0] == []


def test_findings_are_those_of_the_records():
    """Word for word; `python -m validation.reproduce.findings` writes the page anew."""
    assert (ROOT / "docs/findings.md").read_text(encoding="utf-8") == findings(Records())


# id: our verdict; evidence that would turn it, and what it would be then
FAR = (0.01,) * 12
SIGNS = {f"phases.{kind}.{name}": FAR for kind in ("bare", "few", "many") for name in ("ux", "uy", "rotz")}
SIGNS |= {f"phases.{kind}.softer": (50,) * 12 for kind in ("bare", "few", "many")}
STIFFER = {key: tuple(-abs(item) for item in value) for key, value in SIGNS.items()}
VERDICTS = {
    "match": (AGREES, {"spring-b.curve": 0.5}, DIFFERS),
    "shape_a_bare": (AGREES, {"spring-a-no-contact.shape": 0.2}, DIFFERS),
    "shape_a": (AGREES, {"spring-a.shape": 0.2}, DIFFERS),
    "shape_b": (DIFFERS, {"spring-b.shape": 0.1}, AGREES),
    "vertical": (AGREES, {"spring-a.wire": (-9.0, -10.0, 1.1)}, DIFFERS),
    "softer_bare": (UNDECIDED, SIGNS, AGREES),
    "softer_contact": (DIFFERS, SIGNS, AGREES),
    "compenetration": (AGREES, {"overlap.without": 0.1}, DIFFERS),
    "sliding": (AGREES, {"limit.outcome": "completed", "limit.time": None}, DIFFERS),
    "linear": (AGREES, {"linear.beam": 1e-3}, DIFFERS),
    "telescopes": (AGREES, {"telescope.beam": 0}, DIFFERS),
    "under": (UNDECIDED, {"under.wire": -1.0, "under.beam": -2.0}, AGREES),
    "cost": (DIFFERS, {"spring-a.time.wire": 154.0}, AGREES),
    "competitive": (DIFFERS, {"spring-a.time.ratio": 1e3, "spring-b.time.ratio": 1e3}, AGREES),
    "contact_fe_a": (DIFFERS, {"paper.spring-a.wire": 82.0}, AGREES),
    "contact_helps": (AGREES, {"spring-a.paper_iterations": 800}, DIFFERS),
    "doubles_fe": (DIFFERS, {"spring-b.time.wire": 2.0 * FACTS["spring-b-no-contact.time.wire"]}, AGREES),
    "doubles_beam": (DIFFERS, {"spring-b.time.beam": 2.0 * FACTS["spring-b-no-contact.time.beam"]}, AGREES),
    "a_against_b": (DIFFERS, {"spring-b.time.beam": 1e-4, "spring-b.time.beam_paper": 1e-4}, AGREES),
    "one_iteration": (AGREES, {"first.most": 2}, DIFFERS),
    "growing": (AGREES, {"growth.paper.end": 6.0}, DIFFERS),
    "sixth": (AGREES, {"paper.spring-a.beam": 30.0}, DIFFERS),
    "twentieth": (DIFFERS, {"paper.spring-b.beam": 6.0}, AGREES),
}
SECONDS = {name for name in CLAIMS if name.startswith("reduction_")}


def test_every_claim_is_judged_here():
    assert {*VERDICTS, *SECONDS} == set(CLAIMS)
    assert len(SECONDS) == 4


@pytest.mark.parametrize("name", VERDICTS)
def test_verdicts_follow_from_the_evidence(name):
    verdict, turned, other = VERDICTS[name]
    assert claims.verdict(name, FACTS) == verdict
    assert claims.verdict(name, Changed(FACTS, turned)) == other


@pytest.mark.parametrize("name", sorted(SECONDS))
def test_seconds_of_other_programs_are_not_compared(name):
    assert claims.verdict(name, FACTS) == NOT_COMPARED


def test_one_phase_decides():
    """Nothing is decided where the beam is softer at some phases, and at others not."""
    one = SIGNS | {"phases.bare.uy": (*FAR[1:], -0.01), "phases.bare.softer": (*(50,) * 11, 49)}
    assert claims.verdict("softer_bare", Changed(FACTS, one)) == UNDECIDED
    assert claims.verdict("softer_contact", Changed(FACTS, SIGNS)) == AGREES
    assert claims.verdict("softer_bare", Changed(FACTS, STIFFER)) == DIFFERS
    # at full load alone is not at all loads
    late = SIGNS | {"phases.few.softer": (49,) * 12, "phases.many.softer": (49,) * 12}
    assert claims.verdict("softer_contact", Changed(FACTS, late)) == DIFFERS
    one = Changed(FACTS, {"phases.many.softer": (50, *FACTS["phases.many.softer"][1:])})
    assert claims.verdict("softer_contact", one) == UNDECIDED


def test_the_headline_is_a_verdict():
    headline = SENTENCES["report.verdict"]
    assert headline(FACTS).startswith(
        "**The proposed model matches the wire model where the helix starts in the working plane, at a small "
        "part of its cost.**"
    )
    apart = {f"{name}.curve": 0.5 for name in CASE_NAMES}
    assert headline(Changed(FACTS, apart)).startswith("**The proposed model does not match the wire model")
    slow = {f"{name}.time.ratio": 0.5 for name in CASE_NAMES}
    assert "and is not cheaper.**" in headline(Changed(FACTS, slow))


# id: evidence that would turn its words, and what it would say then
APART = ("sensitivity/sensitivity", "models_apart_percent", "spring-a", "wirefe", "sphere_place", "30°")
FOUR = ("errorbudget/fourcases", "value")
OUTSIDE = (*FOUR, "outside", "normal forces", "Spring B")
SOLID = "solid: standing.spring-{}-no-contact.{}.{}"
A_SOLID, B_BEAMS = SOLID.format("a", "helix law", "solid"), SOLID.format("b", "helix law", "beam")
HELD = (*FOUR, "law", "without `held`", "Spring B w/o contacts")
BETWEEN = (*FOUR, "law", "helix law, start phase 45 degrees", "Spring A w/o contacts")
SLOW = {f"{name}.time.ratio": 0.5 for name in CASE_NAMES}
WORDS = [
    ("report.verdict", SLOW, "it takes 2 to 2 of the time"),
    ("report.limit_beam", {"limit.beam": 0.9}, "A modulus about 11 % higher than assumed"),
    ("report.phases", {"phases.many.difference": (0.5,) * 12}, "with 20 their places matter too"),
    ("report.free_sliding", {"limit.outcome": "not converged", "limit.time": None}, "no critical point"),
    ("report.margin", {"limit.beam": 3.0}, "does not rest on the material"),
    ("findings.time", SLOW, "0.50 to 0.50 times as fast as the wire model"),
    ("findings.sliding", {"limit.beam": None, "limit.beam_outcome": "completed"}, "in our wire model, too"),
    ("findings.sliding", {"limit.outcome": "completed", "limit.time": None}, 'does not need "no sliding"'),
    ("findings.sliding", {"limit.beam": 0.9}, "The beam's ends too"),
    ("findings.softer", SIGNS, "holds at every start phase tried without contact"),
    ("findings.softer", STIFFER, "holds at no start phase tried without contact"),
    (
        "findings.exact",
        {"verification: failed": 1},
        "misses some of its targets on rods and springs:** 39",
    ),
    ("findings.exact", {"verification: own": 25}, "of this project's own shooting solver 25"),
    ("findings.phase", {BETWEEN: 0.1}, "but 0.100 % off at an eighth of a turn"),
    ("findings.spheres", {APART: 0.1}, "hardly matters"),
    ("findings.outside", {OUTSIDE: 10.0}, "meet in the plane in which its wire starts"),
    ("findings.helix", {HELD: 0.15}, "does not need fixed winding and wire shear"),
    ("findings.helix", {A_SOLID: 0.0}, "nearer on both springs where both laws have the solid wire"),
    ("findings.helix", {B_BEAMS: 0.0}, "on Spring B alone where both have beams"),
    ("findings.limit", {"contact: search.outcome": "jump"}, "with 80 pairs per turn the path ends (jump)"),
    ("findings.wires", {"contact: spheres.B.0.4.outcome": "completed"}, "spheres it reaches full load"),
]


@pytest.mark.parametrize(("name", "turned", "said"), WORDS)
def test_words_follow_from_the_evidence(name, turned, said):
    words = SENTENCES[name]
    assert (said in words(FACTS)) == (said == "in our wire model, too")
    assert said in words(Changed(FACTS, turned))


def test_a_verdict_is_one_of_four(tmp_path, monkeypatch):
    (tmp_path / "claims.md").write_text("{% macro one(f) %}where\n\nwhat\n\n1\n\nmaybe\n\nwhy{% endmacro %}")
    monkeypatch.setitem(claims.SOURCES, "mechanics", (template(tmp_path / "claims.md"), ["one"]))
    with pytest.raises(ValueError, match="maybe"):
        claims.assessed("one", FACTS)


@pytest.mark.parametrize(
    "key",
    [
        ("workprecision/workprecision", "seconds", "spring-a", "penalty", "straight", 40, 4, 50),  # several
        (*FOUR, "law", "nothing", "Spring B"),
        "tangents: spring-c.exact",
        "nothing: at all",
        "spring-a.colour",
    ],
)
def test_a_record_that_is_not_one_is_refused(key):
    with pytest.raises(KeyError):
        FACTS[key]
