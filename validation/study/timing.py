"""Solution time of both models on the same scenes (the paper's Table 3).

Both models run in one process, alternately, round after round; the first round is discarded.
The time is the CPU time of the solve alone. CPU time counts every thread, so that none is hidden.
"""

from __future__ import annotations

import json
import time
from collections.abc import Mapping
from dataclasses import asdict, dataclass

import numpy as np

from validation.study.cases import CASES, Case, PathStore, case, solve_beam, solve_wire
from validation.study.machine import machine

BUDGET = 3.5  # s of wall time for all rounds together
LEAST_ROUNDS, MOST_ROUNDS = 5, 25
REPEATS = 10  # solves of the equivalent beam a round: it takes only about a millisecond


@dataclass(frozen=True)
class Spread:
    """Median of the rounds with its quartiles."""

    median: float
    low: float
    high: float

    @classmethod
    def of(cls, values: list[float] | np.ndarray) -> Spread:
        """Median and quartiles of the values."""
        low, median, high = np.percentile(values, (25.0, 50.0, 75.0))
        return cls(float(median), float(low), float(high))


@dataclass(frozen=True)
class Timing:
    """Solution times of one case.

    Attributes
    ----------
    case : the case.
    ratio : time of the wire model over that of the equivalent beam, formed within each round.
    wire, beam, beam_paper : CPU seconds of the wire model, of the equivalent beam with its exact
        tangent and with the paper's.
    iterations : factorisations of the three.
    rounds : number of rounds.
    """

    case: Case
    ratio: Spread
    wire: Spread
    beam: Spread
    beam_paper: Spread
    iterations: tuple[int, int, int]
    rounds: int

    @property
    def reduction(self) -> float:
        """Time saved by the equivalent beam against the wire model, %."""
        return 100.0 * (1.0 - 1.0 / self.ratio.median)


@dataclass(frozen=True)
class Measurement:
    """Solution times of the four cases, with where and when they were measured (`machine`)."""

    timings: tuple[Timing, ...]
    machine: Mapping[str, str]

    def to_json(self) -> str:
        """All of it; a case by its name."""
        rows = [asdict(timing) | {"case": timing.case.name} for timing in self.timings]
        return json.dumps({"machine": dict(self.machine), "timings": rows})

    @classmethod
    def from_json(cls, text: str) -> Measurement:
        """What `to_json` wrote."""
        found = json.loads(text)
        return cls(tuple(_timing_of(row) for row in found["timings"]), found["machine"])


def _timing_of(row: dict) -> Timing:
    spreads = {name: Spread(**row[name]) for name in ("ratio", "wire", "beam", "beam_paper")}
    return Timing(
        case=case(row["case"]), iterations=tuple(row["iterations"]), rounds=row["rounds"], **spreads
    )


def measure(store: PathStore) -> Measurement:
    """Time the four cases for about `BUDGET`; iterations are those of the paths in `store`."""
    store.make_ready()
    iterations = [_iterations(store, item) for item in CASES]
    for item in CASES:
        _round(item)
    seconds: list[list[tuple[float, ...]]] = [[] for _ in CASES]
    began = time.perf_counter()
    rounds = 0
    while rounds < LEAST_ROUNDS or (rounds < MOST_ROUNDS and time.perf_counter() - began < BUDGET):
        rounds += 1
        store.announce(f"timing, round {rounds}")
        for found, item in zip(seconds, CASES, strict=True):
            found.append(_round(item))
    rows = zip(CASES, iterations, map(np.array, seconds), strict=True)
    return Measurement(tuple(_timing(*row) for row in rows), machine())


def _iterations(store: PathStore, case: Case) -> tuple[int, int, int]:
    wire, beam, paper = (
        store.wire(case.scene),
        store.beam(case.scene),
        store.beam(case.scene, tangent="paper"),
    )
    return wire.total_iterations, beam.total_iterations, paper.total_iterations


def _round(case: Case) -> tuple[float, float, float]:
    scene = case.scene
    half = REPEATS // 2
    # the short solves stand on both sides of the long one, so that a drift of the clock cancels
    beam = [solve_beam(scene).solve_seconds for _ in range(half)]
    paper = [solve_beam(scene, tangent="paper").solve_seconds for _ in range(2)]
    wire = solve_wire(scene).solve_seconds
    beam += [solve_beam(scene).solve_seconds for _ in range(half)]
    return wire, float(np.median(beam)), float(np.median(paper))


def _timing(case: Case, iterations: tuple[int, int, int], seconds: np.ndarray) -> Timing:
    wire, beam, paper = seconds.T
    return Timing(
        case=case,
        ratio=Spread.of(wire / beam),
        wire=Spread.of(wire),
        beam=Spread.of(beam),
        beam_paper=Spread.of(paper),
        iterations=iterations,
        rounds=len(seconds),
    )


def spread(value: Spread, scale: float) -> str:
    """Median and, in brackets, the quartiles, to three digits."""
    median, low, high = (_three(scale * number) for number in (value.median, value.low, value.high))
    return f"{median} [{low}, {high}]"


def _three(number: float) -> str:
    """Three significant digits without an exponent."""
    return f"{number:.0f}" if number >= 100.0 else f"{number:#.3g}".rstrip(".")
