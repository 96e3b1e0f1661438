"""Solution time of both models on the same scenes (the paper's Table 3).

Both models run in one process, alternately, round after round; the first run of each is discarded.
The time is the CPU time of the solve alone. CPU time counts every thread, so that none is hidden.
"""

from __future__ import annotations

import os
import platform
import time
from dataclasses import dataclass
from importlib import metadata
from pathlib import Path

import numpy as np

from validation.cases import CASES, Case, PathStore, solve_beam, solve_wire

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


def measure(store: PathStore) -> tuple[Timing, ...]:
    """Time the four cases for about `BUDGET`; the paths of the discarded first runs stay in `store`."""
    iterations = {case.name: _first_runs(store, case) for case in CASES}
    seconds: dict[str, list[tuple[float, ...]]] = {case.name: [] for case in CASES}
    began = time.perf_counter()
    rounds = 0
    while rounds < LEAST_ROUNDS or (rounds < MOST_ROUNDS and time.perf_counter() - began < BUDGET):
        rounds += 1
        store.announce(f"timing, round {rounds}")
        for case in CASES:
            seconds[case.name].append(_round(case))
    return tuple(_timing(case, iterations[case.name], np.array(seconds[case.name])) for case in CASES)


def _first_runs(store: PathStore, case: Case) -> tuple[int, int, int]:
    paths = (store.wire(case.scene), store.beam(case.scene), store.beam(case.scene, tangent="paper"))
    return tuple(path.total_iterations for path in paths)


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


def machine() -> dict[str, str]:
    """Processor, cores, system, date and versions, as the report states them."""
    packages = ("numpy", "scipy", "numba")
    versions = ", ".join(f"{name} {metadata.version(name)}" for name in packages)
    return {
        "processor": _processor(),
        "cores": str(len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count()),
        "system": platform.system(),
        "versions": f"Python {platform.python_version()}, {versions}",
        "date": time.strftime("%Y-%m-%d"),
    }


def _processor() -> str:
    """Name of the processor; only Linux tells it in a file."""
    listing = Path("/proc/cpuinfo")
    if listing.is_file():
        for line in listing.read_text(encoding="utf-8", errors="replace").splitlines():
            if line.startswith("model name"):
                return line.split(":", 1)[1].strip()
    return platform.processor() or platform.machine()
