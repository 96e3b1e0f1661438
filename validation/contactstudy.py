"""What the wire model's contact moves and costs, written as a page: ``python -m validation.contactstudy``."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterable
from dataclasses import replace
from functools import lru_cache
from pathlib import Path

import numpy as np
from scipy.spatial import cKDTree

import wirefe
from coilspring import Contact, EquilibriumNotFound, EquilibriumPath, Scene, spring_a, spring_b
from validation.output import write_text
from wirefe.model import ROW, ContactArrays
from wirefe.shape import turned

PAGE = Path("docs/contact.md")
NONE = np.inf  # no sliding
SPRINGS: dict[str, Callable[[], Scene]] = {"A": spring_a, "B": spring_b}
CATALOGUE = {"A": 0.0, "B": NONE}  # coefficients of the catalogue's springs
PAIRS = (4, 8, 20, 40)
EXPONENTS = (1.0, 1.5, 2.0)
TOLERANCE = 1e-8  # of the follower's equilibria
HELD = 1e-9  # tips below are held freedoms' rounding
LIKE = 0.01  # mm: penetration at which all exponents give one force
COEFFICIENTS = (0.0, 0.05, 0.1, 0.3, 1.0, NONE)
STEPS = (10, 50, 200)
REPEATS = 3  # timed runs, of which the least counts
# runs of the search: spring, coefficient, K, pairs a turn
SEARCHED = (
    ("A", 0.0, 1e2, 40), ("A", 0.0, 3e1, 40), ("B", NONE, 1e2, 20), ("B", NONE, 1e2, 40),
    ("B", 0.0, 1e4, 4), ("B", 0.0, 1e4, 40), ("B", 0.0, 1e4, 80),
)  # fmt: skip

HEAD = """\
# Contact in the wire model

Written by `python -m validation.contactstudy`; every number is computed there. Unless said otherwise:
straight elements, 40 a turn; 4 pairs a turn; K = 1e4 N/mm; 50 steps; the catalogue's sliding (A
frictionless, B none). Results at full load; mm, N, rad. Equations: [theory.md](theory.md), section 3. The
model is compared with itself, not with a measured spring; times depend on the machine.
"""

PAIRS_TEXT = """
## Sphere pairs a turn

The stiffness per length of wire is kept: each of p pairs a turn has 4 K/p. *Overlap*: wire diameter less
the least distance of the centrelines of neighbouring coils, sampled 160 times a turn, so between the pairs
too. *Difference*: the largest of UX, UY, ROTZ, relative.

"""

PAIRS_WORDS = """\
What 4 pairs a turn cost:
{costs}.
From 20 to 40 pairs the tips of A still move by {still}. More pairs do not take all overlap away: where two
spheres slide by s along the wire, the wires come nearer by s^2/(2 d), whatever the number of pairs; that is
{sink:.3f} mm for the largest slip of Spring A with mu = {mu:g}, {slip:.2f} mm, if all of it is along the
wire.
"""

EXPONENT_TEXT = """
## Exponent

F = K max(0, d - h)^k, with K such that all exponents give {force:g} N at a penetration of {like:g} mm.
Where pairs penetrate less than that, a larger exponent is softer.

"""

FRICTION_TEXT = """
## Friction

Results with {most} requested steps; *change*: largest relative difference of UX, UY, ROTZ, and of the work,
of {fewer} steps from them. *Couple left*: size of the sum of g x f_t over the pairs.

"""

FRICTION_WORDS = """\
The slip is found implicitly (backward Euler): the work is right to first order in the step. No sliding, and
friction where pairs stick, keep where a pair stood at the end of the substep in which it closed; that is
what the tips of A depend on.

The tangential force acts at the centres of the spheres and not where the wires touch: so the definition of
no sliding has it, which friction shares. The forces of a pair balance, its couple g x f_t remains, as if
the ground took it. The load of Spring A has a moment of {moment:.0f} N mm about the bottom; the couples are
{small} of it with mu = 0.1, {middle} with 0.3 and {none} with no sliding. What large coefficients do to A
is this definition's, and need not be what wires do that rub at their surfaces.
"""

SOLVER = """
## Solver and stability

Within a substep the bound of a pair's tangential force is a number (Tresca's law), so that every iteration
minimises a potential whose matrix is symmetric: LDL^T, as without friction. After convergence the bounds
are renewed from the normal forces and the equilibrium is found again, until they change by at most 1e-6 of
the largest (the fixed point of Panagiotopoulos 1975), at most 20 times; otherwise the substep is halved.
Accepted states then satisfy Coulomb's law implicitly, without the unsymmetric tangent of a linearised
bound; forces balance to that 1e-6 of the largest bound. Slip, work and the points of sticking change with
accepted substeps only.

- Without friction, no negative pivot means a stable equilibrium.
- With friction, and with no sliding, the pivots are those of the incremental energy at frozen bounds and
  memory: they tell stability against perturbations that leave the normal forces as they are. Flutter, and
  instabilities of Coulomb's law in some directions only, are not excluded.
- The answer depends on the sequence of loads, and on the substeps as far as the table says.
- `wirefe.trace` refuses friction: its arc is not a history of loads.
"""

SEARCH_TEXT = """
## Search

Pairs are spheres one turn apart. After every accepted substep the model looks for others that overlap: more
than half a turn apart along the wire and not on one rigid end; it does not look before a bound on all moves
since rest has used up the least gap that such spheres had there. If it finds any, the path is solved anew
with all those nearer than 1.5 wire diameters as pairs, until nothing is left to find. *Unlisted*: overlaps
at the stored states that an independent search finds beside the model's pairs. Curved elements, as many a
turn as pairs; 10 steps.

"""

SEARCH_WORDS = """\
The runs of the first table found {listed} pairs. Arc length finds {traced} in frictionless Spring B past
its limit point (160 points, 4 pairs a turn): its spheres slide off each other and on to the next.

A pair that was found is as stiff as any other: wires are stiffer where diagonal neighbours overlap too.

At the limit point of frictionless Spring B (t = {limit:.4f}, arc length, 4 pairs a turn) the closed pair
that moves most, spheres {first} and {second}, moves along the wire: {circ:.0f} % of its way. Spheres
pressed on each other are unstable in that direction, smooth wires are not. The limit point belongs to the
spheres: where they stand so close that diagonal neighbours touch first, the spring completes.
"""


def with_friction(name: str, coefficient: float) -> Scene:
    """A spring of the paper with a coefficient of friction; 0 for none, infinite for no sliding."""
    sliding = {0.0: "free", NONE: "none"}.get(coefficient, "coulomb")
    contact = Contact(sliding=sliding, friction=coefficient if sliding == "coulomb" else None)
    return replace(SPRINGS[name](), contact=contact)


def reached(scene: Scene, **options: object) -> EquilibriumPath:
    """The path of `scene`, or what was reached of it."""
    try:
        return wirefe.solve(scene, **options)  # type: ignore[arg-type]
    except EquilibriumNotFound as error:
        return error.path


@lru_cache
def solved(name: str, coefficient: float, steps: int = 50, pairs: int = 4) -> EquilibriumPath:
    """A spring's path, as far as it goes."""
    return reached(with_friction(name, coefficient), steps=steps, pairs_per_turn=pairs)


def seconds(name: str, pairs: int) -> float:
    """Least CPU time of a spring's path over the repeats."""
    scene = with_friction(name, CATALOGUE[name])
    return min(reached(scene, pairs_per_turn=pairs).solve_seconds for _ in range(REPEATS))


def overlap(path: EquilibriumPath, points_per_turn: int = 160) -> float:
    """Largest overlap of wires of neighbouring coils anywhere at the last step, mm.

    Distances of points of the centreline from the straight pieces half a turn to one and a half turns on;
    points of one rigid end turn do not count with each other.
    """
    line = path.centreline(-1, points_per_turn)
    ends = round(path.scene.spring.end_turns * points_per_turn)
    half = points_per_turn // 2
    least = np.inf
    for ahead in range(half, 3 * half):
        count = len(line) - ahead - 1
        first, second = line[ahead : ahead + count], line[ahead + 1 : ahead + 1 + count]
        distance = to_pieces(line[:count], first, second)
        inside = np.arange(count)
        active = (inside + ahead >= ends) & (inside < len(line) - ends)
        least = min(least, float(distance[active].min()))
    return max(path.scene.spring.wire_diameter - least, 0.0)


def to_pieces(points: np.ndarray, first: np.ndarray, second: np.ndarray) -> np.ndarray:
    """Distance of each point from its piece between `first` and `second`."""
    way, out = second - first, points - first
    share = np.clip((out * way).sum(axis=1) / (way * way).sum(axis=1), 0.0, 1.0)
    return np.linalg.norm(out - share[:, None] * way, axis=1)


def centres(path: EquilibriumPath, step: int) -> tuple[ContactArrays, np.ndarray]:
    """Contact arrays and the spheres' centres at a stored step."""
    contact = path.shape.data.contact  # type: ignore[attr-defined]
    rows = path.states[step].reshape(-1, ROW)[contact.carrier]
    return contact, rows[:, :3] + turned(rows[:, 3:], contact.offset)


def couple(path: EquilibriumPath) -> float:
    """Size of the sum of the couples g x f_t that the tangential forces leave at the last step, N mm."""
    contact, places = centres(path, -1)
    way = places[contact.pairs[:, 1]] - places[contact.pairs[:, 0]]
    return float(np.linalg.norm(np.cross(way, path.friction.force[-1]).sum(axis=0)))


def dissipated(path: EquilibriumPath) -> float:
    """Work taken by friction along the path, of pairs that have opened since included, N mm."""
    work = path.friction.work
    before = np.vstack((np.zeros(work.shape[1]), work[:-1]))
    return float(np.where(work < before - 1e-12, work, work - before).sum())


def unlisted(path: EquilibriumPath) -> int:
    """Overlaps of spheres, over all stored states, that are no pair of the model."""
    count = 0
    for step in range(len(path.times)):
        contact, places = centres(path, step)
        listed = {tuple(pair) for pair in contact.pairs.tolist()}
        touching = cKDTree(places).query_pairs(contact.d, output_type="ndarray").tolist()
        count += sum(
            b - a > contact.near and contact.carrier[a] != contact.carrier[b] and (a, b) not in listed
            for a, b in touching
        )
    return count


def table(head: Iterable[str], rows: Iterable[Iterable[str]]) -> str:
    """Markdown table."""
    names = tuple(head)
    lines = [names, ("---",) * len(names), *(tuple(row) for row in rows)]
    return "".join(f"| {' | '.join(line)} |\n" for line in lines) + "\n"


def tips(path: EquilibriumPath) -> list[str]:
    """UX, UY, ROTZ at the last step."""
    return [f"{value:.4f}" if abs(value) > HELD else "0" for value in path.tips[-1]]


def difference(path: EquilibriumPath, reference: EquilibriumPath) -> float:
    """Largest difference of a tip's component over that component, of those that move."""
    peak = np.abs(reference.tips[-1])
    moved = peak > HELD
    return float((np.abs(path.tips[-1] - reference.tips[-1])[moved] / peak[moved]).max())


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
    return PAIRS_TEXT + table(head, rows) + pairs_words()


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
    return PAIRS_WORDS.format(costs=";\n".join(costs), still=still, slip=slip, sink=sink, mu=COEFFICIENTS[1])


def exponent_section() -> str:
    """What the exponent of the penalty moves."""
    rows = []
    for name in SPRINGS:
        base = solved(name, CATALOGUE[name])
        for k in EXPONENTS:
            scene = with_friction(name, CATALOGUE[name])
            stiffness = scene.contact.stiffness * LIKE ** (1.0 - k)
            path = reached(replace(scene, contact=replace(scene.contact, exponent=k, stiffness=stiffness)))
            rows.append((
                name, f"{k:g}", f"{stiffness:g}", *tips(path), percent(difference(path, base)),
                f"{path.max_penetration[-1]:.4f}", f"{path.contact_forces[-1].max():.2f}",
                str(path.total_iterations),
            ))  # fmt: skip
    head = (
        "spring", "k", "K, N/mm^k", "UX", "UY", "ROTZ", "difference to k = 1", "largest penetration",
        "largest force of a pair", "factorisations",
    )  # fmt: skip
    return EXPONENT_TEXT.format(force=1e4 * LIKE, like=LIKE) + table(head, rows)


def friction_section() -> str:
    """What friction moves, and what of it depends on the substeps."""
    rows = [friction_row(name, mu) for name in SPRINGS for mu in COEFFICIENTS]
    head = (
        "spring", "mu", "UX", "UY", "ROTZ", "work of friction, N mm", "largest slip", "couple left, N mm",
        "change of the tips", "change of the work",
    )  # fmt: skip
    text = FRICTION_TEXT.format(most=STEPS[-1], fewer=" and ".join(map(str, STEPS[:-1])))
    return text + table(head, rows) + friction_words()


def friction_words() -> str:
    """What the table of friction says of the couples."""
    paths = {mu: solved("A", mu, STEPS[-1]) for mu in (0.1, 0.3, NONE)}
    last = paths[NONE]
    (x, y), (fx, fy) = last.top[-1, :2], last.loads[-1]
    moment = abs(float(x * fy - y * fx))
    small, middle, none = (percent(couple(path) / moment) for path in paths.values())
    return FRICTION_WORDS.format(moment=moment, small=small, middle=middle, none=none)


def friction_row(name: str, coefficient: float) -> tuple[str, ...]:
    """A row of the table of friction."""
    paths = [solved(name, coefficient, steps) for steps in STEPS]
    last = paths[-1]
    label = (name, coefficient_name(coefficient))
    if last.outcome != "completed":
        words = f"{last.outcome.replace('_', ' ')} at t = {last.critical_time:.4f}"
        return (*label, words, *[""] * 7)
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
    return SEARCH_TEXT + table(head, rows) + search_words(listed)


def search_words(listed: int) -> str:
    """What the table of the search says, and where frictionless Spring B goes at its limit point."""
    path = wirefe.trace(with_friction("B", 0.0), points=160, element="curved", elements_per_turn=8)
    limit = int(np.argmax(np.diff(path.times) < 0.0))
    contact, before = centres(path, limit - 3)
    _, after = centres(path, limit + 1)
    lower, upper = contact.pairs.T
    moved = (after[upper] - after[lower]) - (before[upper] - before[lower])
    most = int(np.argmax(np.linalg.norm(moved, axis=1) * (path.gaps[limit + 1] < 0.0)))
    along = np.cross([0.0, 1.0, 0.0], after[lower[most]])
    share = abs(moved[most] @ along) / np.linalg.norm(along) / np.linalg.norm(moved[most])
    return SEARCH_WORDS.format(
        listed=listed, traced=path.options["pairs_found"], limit=path.times[limit],
        first=lower[most], second=upper[most], circ=100.0 * share,
    )  # fmt: skip


def searched(name: str, coefficient: float, stiffness: float, pairs: int) -> tuple[str, ...]:
    """A row of the table of the search."""
    path = reached(
        with_friction(name, coefficient), steps=10, penalty=stiffness, element="curved",
        elements_per_turn=pairs, pairs_per_turn=pairs,
    )  # fmt: skip
    outcome = path.outcome.replace("_", " ")
    if path.critical_time is not None:
        outcome += f" at t = {path.critical_time:.4f}"
    return (
        name, coefficient_name(coefficient), f"{stiffness:g}", str(pairs), str(path.options["pairs_found"]),
        outcome, *tips(path)[:2], f"{path.max_penetration[-1]:.3f}", str(unlisted(path)),
    )  # fmt: skip


def write_page(path: str | Path) -> None:
    """Solve all and write the page."""
    sections = (pairs_section(), exponent_section(), friction_section(), SOLVER, search_section())
    write_text(Path(path), (HEAD + "".join(sections)).replace("\n\n\n", "\n\n"))


if __name__ == "__main__":
    write_page(PAGE)
    sys.exit(0)
