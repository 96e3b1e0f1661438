"""Solution time of both models on the same scenes (the paper's Table 3), as one DataFrame.

Both models run in one process, alternately, round after round; the first round is discarded.
The time is the CPU time of the solve alone. CPU time counts every thread, so that none is hidden.
"""

from collections.abc import Callable

import pandas as pd

from coilspring import Scene
from validation.study.cases import CASES
from validation.study.machine import machine
from validation.study.paths import PathStore, solve_beam, solve_wire
from validation.study.timing import interleaved, median_of, quartiles, within

BUDGET = 3.5  # s of wall time for all rounds together
LEAST_ROUNDS, MOST_ROUNDS = 5, 25
REPEATS = 5  # solves of the beam, which takes about a millisecond, on each side of the wire model's
ITERATIONS = ("wire_iterations", "beam_iterations", "beam_paper_tangent_iterations")


def measure(store: PathStore) -> pd.DataFrame:
    """Time the four cases for about `BUDGET`, a row for each; iterations are those of the paths in `store`.

    ``ratio``: time of the wire model over that of the equivalent beam, formed within each round.
    ``reduction_percent``: time that the beam saves. ``_q1`` and ``_q3``: quartiles.
    """
    store.make_ready()
    runs = {(item, place): run for item in CASES for place, run in enumerate(_turns(item.scene))}
    for run in runs.values():
        run()
    seconds = interleaved(runs, within(BUDGET, LEAST_ROUNDS, MOST_ROUNDS, store.announce))
    here = machine()
    rows = []
    for item in CASES:
        before, paper, wire, after = (seconds[item, place] for place in range(4))
        beam = 0.5 * (before + after)
        ratio = quartiles("ratio", wire / beam)
        paths = (store.wire(item.scene), store.beam(item.scene), store.beam(item.scene, tangent="paper"))
        rows.append(
            {
                "case": item.name,
                "reduction_percent": 100.0 * (1.0 - 1.0 / ratio["ratio"]),
                "paper_reduction_percent": item.paper_reduction,
                **ratio,
                **quartiles("wire_seconds", wire),
                **quartiles("beam_seconds", beam),
                **quartiles("beam_paper_tangent_seconds", paper),
                **{name: path.total_iterations for name, path in zip(ITERATIONS, paths, strict=True)},
                "rounds": len(wire),
                "paper_wire_seconds": item.paper_wire,
                "paper_beam_seconds": item.paper_beam,
                "measured": here["date"],
                **{name: here[name] for name in ("processor", "cores", "system", "versions")},
            }
        )
    return pd.DataFrame(rows)


def _turns(scene: Scene) -> tuple[Callable[[], float], ...]:
    """Runs of a round: short ones on both sides of the long one, so that a change of the clock cancels."""

    def beam(repeats: int = REPEATS, tangent: str = "exact") -> float:
        return median_of(repeats, lambda: solve_beam(scene, tangent=tangent).solve_seconds)

    return beam, lambda: beam(2, "paper"), lambda: solve_wire(scene).solve_seconds, beam
