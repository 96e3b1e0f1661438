"""What the wire model's contact moves and costs: ``python -m validation.verification.contact``."""

from __future__ import annotations

import sys
from dataclasses import replace
from functools import cache
from pathlib import Path
from typing import NamedTuple

import numpy as np

import wirefe
from coilspring import EquilibriumPath, spring_a
from validation.study.document import Table, to_markdown
from validation.study.output import write_facts, write_text
from validation.study.partialsolve import as_far
from validation.verification import contacttext as words
from validation.verification.contactmeasures import (
    CATALOGUE,
    HELD,
    NONE,
    SPRINGS,
    centres,
    couple,
    difference,
    dissipated,
    overlap,
    seconds,
    solved,
    unlisted,
    with_friction,
)

PAGE, RECORD = Path("docs/contact.md"), Path("reports/contact")
PAIRS = (4, 8, 20, 40)
EXPONENTS = (1.0, 1.5, 2.0)
TOLERANCE = 1e-8  # of the follower's equilibria
LIKE = 0.01  # mm: penetration at which all exponents give one force
COEFFICIENTS = (0.0, 0.05, 0.1, 0.3, 1.0, NONE)
STEPS = (10, 50, 200)
# runs of the search: spring, coefficient, K, pairs a turn
SEARCHED = (
    ("A", 0.0, 1e2, 40), ("A", 0.0, 3e1, 40), ("B", NONE, 1e2, 20), ("B", NONE, 1e2, 40),
    ("B", 0.0, 1e4, 4), ("B", 0.0, 1e4, 40), ("B", 0.0, 1e4, 80),
)  # fmt: skip


def table(head: tuple[str, ...], rows: list[tuple[str, ...]]) -> str:
    """A table and an empty line, Markdown."""
    return to_markdown((Table(head, tuple(rows)),)) + "\n"


def tips(path: EquilibriumPath) -> list[str]:
    """UX, UY, ROTZ at the last step."""
    return [f"{value:.4f}" if abs(value) > HELD else "0" for value in path.tips[-1]]


def percent(share: float) -> str:
    """A share in percent, to two figures; 0 below a solver's tolerance."""
    return f"{100.0 * share:.2g} %" if share > TOLERANCE else "0"


def coefficient_name(coefficient: float) -> str:
    """How the tables name a coefficient."""
    return "no sliding" if coefficient == NONE else f"{coefficient:g}"


def pairs_section() -> str:
    """What the number of pairs a turn moves and costs."""
    rows, first = [], {}
    for name in SPRINGS:
        first[name] = seconds(name, PAIRS[0])
        for pairs in PAIRS:
            path = solved(name, CATALOGUE[name], pairs=pairs)
            finest = solved(name, CATALOGUE[name], pairs=PAIRS[-1])
            spent = first[name] if pairs == PAIRS[0] else seconds(name, pairs)
            rows.append((
                name, str(pairs), *tips(path), percent(difference(path, finest)), f"{overlap(path):.4f}",
                f"{path.max_penetration[-1]:.4f}", f"{path.contact_forces[-1].max():.2f}",
                f"{spent / first[name]:.1f}",
            ))  # fmt: skip
    head = (
        "spring", "pairs a turn", "UX", "UY", "ROTZ", "difference to 40", "overlap of the wires",
        "largest penetration of a pair", "largest force of a pair", "time over that of 4",
    )  # fmt: skip
    return words.PAIRS_TEXT + table(head, rows) + pairs_words()


def pairs_words() -> str:
    """What the table of pairs says."""
    costs = []
    for name in SPRINGS:
        few, many = (solved(name, CATALOGUE[name], pairs=pairs) for pairs in (PAIRS[0], PAIRS[-1]))
        tip = percent(difference(few, many))
        costs.append(
            f"{name} {overlap(few):.3f} mm of overlap ({overlap(many):.3f} with 40), {tip} of the tips"
        )
    slip = float(solved("A", COEFFICIENTS[1]).friction.slip[-1].max())
    sink = slip**2 / (2.0 * spring_a().spring.wire_diameter)
    still = percent(difference(*(solved("A", CATALOGUE["A"], pairs=pairs) for pairs in PAIRS[-2:])))
    return words.PAIRS_WORDS.format(
        costs=";\n".join(costs), still=still, slip=slip, sink=sink, mu=COEFFICIENTS[1]
    )


def exponent_section() -> str:
    """What the exponent of the penalty moves."""
    rows = []
    for name in SPRINGS:
        base = solved(name, CATALOGUE[name])
        for k in EXPONENTS:
            scene = with_friction(name, CATALOGUE[name])
            stiffness = scene.contact.stiffness * LIKE ** (1.0 - k)
            path = as_far(
                wirefe.solve, replace(scene, contact=replace(scene.contact, exponent=k, stiffness=stiffness))
            )
            rows.append((
                name, f"{k:g}", f"{stiffness:g}", *tips(path), percent(difference(path, base)),
                f"{path.max_penetration[-1]:.4f}", f"{path.contact_forces[-1].max():.2f}",
                str(path.total_iterations),
            ))  # fmt: skip
    head = (
        "spring", "k", "K, N/mm^k", "UX", "UY", "ROTZ", "difference to k = 1", "largest penetration",
        "largest force of a pair", "factorisations",
    )  # fmt: skip
    return words.EXPONENT_TEXT.format(force=1e4 * LIKE, like=LIKE) + table(head, rows)


def friction_section() -> str:
    """What friction moves, and what of it depends on the substeps."""
    rows = [friction_row(name, mu) for name in SPRINGS for mu in COEFFICIENTS]
    head = (
        "spring", "mu", "UX", "UY", "ROTZ", "work of friction, N mm", "largest slip", "couple left, N mm",
        "change of the tips", "change of the work",
    )  # fmt: skip
    text = words.FRICTION_TEXT.format(most=STEPS[-1], fewer=" and ".join(map(str, STEPS[:-1])))
    return text + table(head, rows) + friction_words()


def friction_words() -> str:
    """What the table of friction says of the couples."""
    paths = {mu: solved("A", mu, STEPS[-1]) for mu in (0.1, 0.3, NONE)}
    small, middle, none = (percent(couple(path) / moment(paths[NONE])) for path in paths.values())
    return words.FRICTION_WORDS.format(moment=moment(paths[NONE]), small=small, middle=middle, none=none)


def moment(path: EquilibriumPath) -> float:
    """Of the last load about the clamp, N mm."""
    (x, y), (fx, fy) = path.top[-1, :2], path.loads[-1]
    return abs(float(x * fy - y * fx))


def couple_share(path: EquilibriumPath) -> float:
    """The couples that contact leaves at the last step over the load's moment."""
    return couple(path) / moment(path)


def friction_row(name: str, coefficient: float) -> tuple[str, ...]:
    """A row of the table of friction."""
    paths = [solved(name, coefficient, steps) for steps in STEPS]
    last = paths[-1]
    label = (name, coefficient_name(coefficient))
    if last.outcome != "completed":
        end = f"{last.outcome.replace('_', ' ')} at t = {last.critical_time:.4f}"
        return (*label, end, *[""] * 7)
    works = [dissipated(path) for path in paths]
    change = max(difference(path, last) for path in paths)
    slides = works[-1] > 1e-9
    work_change = max(abs(work / works[-1] - 1.0) for work in works) if slides else 0.0
    return (
        *label, *tips(last), f"{works[-1]:.3g}" if slides else "0", f"{last.friction.slip.max():.4f}",
        f"{couple(last):.2f}", percent(change), percent(work_change) if slides else "",
    )  # fmt: skip


def search_section() -> str:
    """What the search for further pairs finds."""
    listed = sum(
        int(str(solved(name, CATALOGUE[name], pairs=pairs).options["pairs_found"]))
        for name in SPRINGS
        for pairs in PAIRS
    )
    rows = [searched(*case) for case in SEARCHED]
    head = (
        "spring", "mu", "K", "pairs a turn", "pairs found", "outcome", "UX", "UY", "largest penetration",
        "unlisted",
    )  # fmt: skip
    return words.SEARCH_TEXT + table(head, rows) + search_words(listed)


class Slide(NamedTuple):
    """Where frictionless Spring B goes at its limit point: the pair that moves most, its share along it."""

    pairs_found: object
    time: float
    first: int
    second: int
    share: float


@cache
def slide() -> Slide:
    """Trace frictionless Spring B through its limit point."""
    path = wirefe.trace(with_friction("B", 0.0), points=160, element="curved", elements_per_turn=8)
    limit = int(np.argmax(np.diff(path.times) < 0.0))
    contact, before = centres(path, limit - 3)
    _, after = centres(path, limit + 1)
    lower, upper = contact.pairs.T
    moved = (after[upper] - after[lower]) - (before[upper] - before[lower])
    most = int(np.argmax(np.linalg.norm(moved, axis=1) * (path.gaps[limit + 1] < 0.0)))
    along = np.cross([0.0, 1.0, 0.0], after[lower[most]])
    share = abs(moved[most] @ along) / np.linalg.norm(along) / np.linalg.norm(moved[most])
    return Slide(path.options["pairs_found"], path.times[limit], lower[most], upper[most], share)


def search_words(listed: int) -> str:
    """What the table of the search says, and where frictionless Spring B goes at its limit point."""
    found = slide()
    return words.SEARCH_WORDS.format(
        listed=listed, traced=found.pairs_found, limit=found.time, first=found.first, second=found.second,
        circ=100.0 * found.share,
    )  # fmt: skip


@cache
def searched(name: str, coefficient: float, stiffness: float, pairs: int) -> tuple[str, ...]:
    """A row of the table of the search."""
    path = as_far(
        wirefe.solve, with_friction(name, coefficient), steps=10, penalty=stiffness, element="curved",
        elements_per_turn=pairs, pairs_per_turn=pairs,
    )  # fmt: skip
    outcome = path.outcome.replace("_", " ")
    if path.critical_time is not None:
        outcome += f" at t = {path.critical_time:.4f}"
    return (
        name, coefficient_name(coefficient), f"{stiffness:g}", str(pairs), str(path.options["pairs_found"]),
        outcome, *tips(path)[:2], f"{path.max_penetration[-1]:.3f}", str(unlisted(path)),
    )  # fmt: skip


def facts() -> dict[str, object]:
    """What findings are computed from: mm, and shares in per cent."""
    found: dict[str, object] = {"pairs.count": PAIRS[0]}
    for name in SPRINGS:
        few, many = (solved(name, CATALOGUE[name], pairs=pairs) for pairs in (PAIRS[0], PAIRS[-1]))
        found |= {
            f"pairs.{name}.overlap": overlap(few),
            f"pairs.{name}.difference": 100.0 * difference(few, many),
        }
    free, held = (solved("A", mu, STEPS[-1]) for mu in (0.0, NONE))
    found |= {"friction.couples": 100.0 * couple_share(held)}
    found |= {"friction.free": free.tips[-1, 1], "friction.held": held.tips[-1, 1]}
    pairs, outcome = (searched(*SEARCHED[-1])[i] for i in (3, 5))
    return found | {
        "search.along": 100.0 * slide().share,
        "search.pairs": int(pairs),
        "search.outcome": outcome,
    }


def write_page(path: str | Path) -> None:
    """Solve all and write the page."""
    sections = (pairs_section(), exponent_section(), friction_section(), words.SOLVER, search_section())
    write_text(Path(path), (words.HEAD + "".join(sections)).replace("\n\n\n", "\n\n"))
    write_facts(facts(), RECORD)


if __name__ == "__main__":
    write_page(PAGE)
    sys.exit(0)
