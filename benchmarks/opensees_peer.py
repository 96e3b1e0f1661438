"""Time `wirefe` against OpenSees on the same mesh, section, supports, contact and load.

Both run in one process, alternately, after a discarded run of each. Times are CPU seconds of the
solution alone; ratios are formed within each round. Exit code 0: the tips agree; 1: they do not, or
a code did not finish; 2: bad input, or openseespy is missing.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from opensees_page import AGREEMENT, LADDER, STEPS, Duel, distance, facts, page

import wirefe
from coilspring import Scene, load_scene
from validation.peers.comparison import MISSING, opensees
from validation.study.files import write_facts
from validation.study.partialsolve import partial_path

SCENES = ("spring-a", "spring-a-no-contact", "spring-b-no-contact")
REPORT = Path(__file__).parents[1] / "reports" / "referee" / "opensees.md"
EXAMPLE = """example:
  python benchmarks/opensees_peer.py --scenes spring-a spring-a-no-contact spring-b-no-contact
"""


@dataclass(frozen=True)
class Solution:
    """What either code returns; `tip` (UX, UY, ROTZ) is None where it did not reach full load."""

    tip: np.ndarray | None
    seconds: float
    iterations: int


Solver = Callable[[int], Solution]


class NoAnswer(Exception):
    """A code did not reach full load in 50 steps."""


def wire_solver(scene: Scene) -> Solver:
    """Solve the scene with `wirefe` in a given number of steps."""

    def solve(steps: int) -> Solution:
        path = partial_path(wirefe.solve, scene, steps=steps)
        tip = path.tips[-1] if path.outcome == "completed" else None
        return Solution(tip, path.solve_seconds, path.total_iterations)

    return solve


def peer_solver(scene: Scene, energy: float) -> Solver:
    """Solve the scene with OpenSees in a given number of steps."""
    from validation.peers.opensees import run

    def solve(steps: int) -> Solution:
        end = run(scene, steps, energy, halvings=0)
        tip = end.tips[-1] if len(end.tips) == steps else None
        return Solution(tip, end.seconds, end.iterations)

    return solve


def survived(solve: Solver, reference: np.ndarray) -> dict[int, float]:
    """CPU seconds for each number of steps of the ladder that gives the reference tip."""
    seconds = {}
    for steps in LADDER:
        end = solve(steps)
        if end.tip is not None and distance(end.tip, reference) <= AGREEMENT:
            seconds[steps] = end.seconds
    return seconds


def compare(name: str, repeats: int, tolerance: float) -> list[Duel]:
    """All duels of one scene; the first runs, which are not timed, choose the steps.

    Raises
    ------
    NoAnswer : a code did not reach full load in 50 steps.
    """
    scene = load_scene(name)
    wire = wire_solver(scene)
    tip = full_load("wirefe", wire, name)
    work = abs(float(np.array(scene.load.force) @ tip[:2]))
    peer = peer_solver(scene, tolerance * work)
    mine, theirs = survived(wire, tip), survived(peer, full_load("OpenSees", peer, name))
    choices = {
        "equal": (STEPS, STEPS),
        "fewest": (min(mine), min(theirs)),
        "fastest": (min(mine, key=mine.__getitem__), min(theirs, key=theirs.__getitem__)),
    }
    return [duel(name, kind, (wire, peer), steps, repeats) for kind, steps in choices.items()]


def full_load(code: str, solve: Solver, name: str) -> np.ndarray:
    """Tip in 50 steps."""
    tip = solve(STEPS).tip
    if tip is None:
        raise NoAnswer(f"{code} did not reach full load on {name} in {STEPS} steps")
    return tip


def duel(name: str, kind: str, solvers: tuple[Solver, Solver], steps: tuple[int, int], repeats: int) -> Duel:
    """Run both codes alternately."""
    rounds = [[solve(n) for solve, n in zip(solvers, steps, strict=True)] for _ in range(repeats)]
    wire, peer = rounds[-1]
    return Duel(
        scene=name,
        kind=kind,
        steps=steps,
        seconds=np.array([[end.seconds for end in ends] for ends in rounds]),
        iterations=(wire.iterations, peer.iterations),
        tips=(wire.tip, peer.tip),
    )


def parse(argv: Sequence[str] | None) -> argparse.Namespace:
    """Options."""
    parser = argparse.ArgumentParser(
        description="Time wirefe against OpenSees on the same model.",
        epilog=EXAMPLE,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("--scenes", nargs="+", choices=SCENES, default=["spring-a"], help="default: spring-a")
    parser.add_argument("--repeats", type=int, default=5, help="timed rounds; default: 5")
    parser.add_argument(
        "--tolerance",
        type=float,
        default=1e-10,
        help="of OpenSees' energy test, over the work; default: 1e-10",
    )
    parser.add_argument("--out", type=Path, default=REPORT, help="page; default: reports/referee/opensees.md")
    options = parser.parse_args(argv)
    if options.repeats < 1 or not options.tolerance > 0.0:
        parser.error("--repeats must be at least 1 and --tolerance above 0")
    return options


def main(argv: Sequence[str] | None = None) -> int:
    """Run the comparison; see the module's docstring for the exit codes."""
    options = parse(argv)
    if opensees() is None:
        print(MISSING, file=sys.stderr)
        return 2
    try:
        duels = [
            duel for name in options.scenes for duel in compare(name, options.repeats, options.tolerance)
        ]
    except NoAnswer as none:
        print(none, file=sys.stderr)
        return 1
    text = page(duels, options.repeats, options.tolerance)
    print(text, flush=True)
    options.out.parent.mkdir(parents=True, exist_ok=True)
    options.out.write_text(text, encoding="utf-8")
    write_facts(facts(duels), options.out.parent)
    return int(any(duel.difference > AGREEMENT for duel in duels))


if __name__ == "__main__":
    sys.exit(main())
