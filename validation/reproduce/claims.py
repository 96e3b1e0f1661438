"""Every sentence of the paper that claims a result, assessed by our numbers.

Their words and verdicts are in ``mechanics.md`` and ``times.md``; here is what these compute with.
"""

import re
from collections import Counter
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, NamedTuple

from jinja2 import Template

from coilspring.curves import COMPONENTS
from validation.reproduce.facts import BY_WIRES
from validation.study.cases import CASES, case
from validation.study.tables import Table
from validation.study.template import Facts, percent, template, unwrapped

VERDICTS = ("agrees", "differs", "cannot be decided", "cannot be compared")
AGREES, DIFFERS, UNDECIDED, NOT_COMPARED = VERDICTS
HEADER = (
    *("where", "the paper says, in our words", "our numbers", "verdict", "why; measured against what"),
    "with contact of wires in place of spheres",
)
CASE_NAMES = tuple(item.name for item in CASES)


class Claim(NamedTuple):
    """One sentence of the paper, assessed: a row of the report's table."""

    where: str
    statement: str  # what the paper says, in our words
    ours: str  # our numbers
    verdict: str  # of `VERDICTS`
    why: str  # and what the numbers are measured against


def assessed(name: str, facts: Facts) -> Claim:
    """A claim by the facts."""
    source = next(source for source, names in SOURCES.values() if name in names)
    found = Claim(*unwrapped(getattr(source.module, name)(facts)).split("\n\n"))
    if found.verdict not in VERDICTS:
        raise ValueError(f"verdict must be one of {VERDICTS}, got {found.verdict!r}")
    return found


def verdict(name: str, facts: Facts) -> str:
    """The verdict on a claim."""
    return assessed(name, facts).verdict


def counted(f: Facts, kind: str) -> str:
    """How often each verdict is given on the claims of a kind."""
    counts = Counter(verdict(name, f) for name in SOURCES[kind][1])
    return ", ".join(f"{name} {counts[name]}" for name in VERDICTS if counts[name])


def claim_table(facts: Facts) -> Table:
    """One row for each claim."""
    return Table(HEADER, tuple((*assessed(name, facts), by_wires(name, facts)) for name in CLAIMS))


def by_wires(name: str, facts: Facts) -> str:
    """Verdict and numbers of a claim with contact of wires; "-" where they are the same."""
    others = {key.removeprefix(BY_WIRES): facts[key] for key in facts if key.startswith(BY_WIRES)}
    found = assessed(name, {**facts, **others})
    return "-" if found.ours == assessed(name, facts).ours else f"{found.verdict}: {found.ours}"


def cases(f: Facts, name: str) -> list[Any]:
    """A fact of each of the four cases."""
    return [f[f"{case_name}.{name}"] for case_name in CASE_NAMES]


def curves(f: Facts) -> dict[str, float]:
    """Largest difference of the tip curves in each of the four cases."""
    return dict(zip(CASE_NAMES, cases(f, "curve"), strict=True))


def phase_range(f: Facts, kind: str) -> str:
    """Least and largest difference of the tip curves over the start phases."""
    found = f[f"phases.{kind}.difference"]
    return f"{100.0 * min(found):.2f} to {percent(max(found))}"


def contact_change(f: Facts, model: str) -> dict[str, float]:
    """What contact changes of Spring A's tip, %."""
    pairs = zip(COMPONENTS, f[f"spring-a.{model}"], f[f"spring-a-no-contact.{model}"], strict=True)
    return {name: 100.0 * (new / old - 1.0) for name, new, old in pairs}


def most_changed(change: Mapping[str, float]) -> str:
    """The component that changes most."""
    return max(change, key=lambda name: abs(change[name]))


def everywhere(f: Facts, kind: str) -> list[bool]:
    """Whether the beam is softer in all components and substeps, by start phase."""
    return [count == f["setting.steps"] for count in f[f"phases.{kind}.softer"]]


def softer_phases(f: Facts) -> list[int]:
    """Start phases at which the beam is so without contact, degrees."""
    pairs = zip(f["phases.bare.degrees"], everywhere(f, "bare"), strict=True)
    return [angle for angle, softer in pairs if softer]


def softer_verdict(f: Facts, kinds: Sequence[str]) -> str:
    """Whether the beam is always softer than the wire model: it may depend on the start phase."""
    found = [softer for kind in kinds for softer in everywhere(f, kind)]
    return AGREES if all(found) else UNDECIDED if any(found) else DIFFERS


def said(verdict: str) -> str:
    """A verdict on what the paper says of all start phases, in a sentence."""
    return {AGREES: "holds at every start phase tried", DIFFERS: "holds at no start phase tried"}.get(
        verdict, "cannot be decided"
    )


def with_contact(f: Facts, spring: str, name: str) -> float:
    """A fact of a spring with contact over that without."""
    return f[f"{spring}.{name}"] / f[f"{spring}-no-contact.{name}"]


FUNCTIONS = (
    *(case, cases, contact_change, counted, curves, everywhere, most_changed, phase_range),
    *(said, softer_phases, softer_verdict, verdict, with_contact),
)


def _source(kind: str) -> tuple[Template, list[str]]:
    """A template of claims, and their names: its macros of the facts alone."""
    file = Path(__file__).with_name(f"{kind}.md")
    names = re.findall(r"{% macro (\w+)\(f\) %}", file.read_text(encoding="utf-8"))
    return template(file, FUNCTIONS), names


SOURCES = {kind: _source(kind) for kind in ("mechanics", "times")}
CLAIMS = [name for _, names in SOURCES.values() for name in names]
