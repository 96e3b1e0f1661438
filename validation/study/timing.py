"""CPU time of solves: runs take turns in rounds, so that a disturbance of the machine falls on all."""

import time
from collections.abc import Callable, Iterable, Iterator, Mapping
from typing import Any

import numpy as np


def interleaved(runs: Mapping[Any, Callable[[], float]], rounds: Iterable[object]) -> dict[Any, np.ndarray]:
    """CPU seconds of every run in every round; ratios are to be formed within a round.

    Each of `runs` gives the CPU seconds of the solve alone, which count every thread. Taking an item of
    `rounds` may announce the round, or end the rounds when time is up.
    """
    found: dict[Any, list[float]] = {name: [] for name in runs}
    for _ in rounds:
        for name, run in runs.items():
            found[name].append(run())
    return {name: np.array(seconds) for name, seconds in found.items()}


def announced(rounds: int, announce: Callable[[str], None], what: str) -> Iterator[int]:
    """Rounds of which each is announced."""
    for number in range(rounds):
        announce(f"{what}, round {number + 1} of {rounds}")
        yield number


def within(budget: float, least: int, most: int, announce: Callable[[str], None]) -> Iterator[int]:
    """At least and at most so many rounds, and no more after `budget` seconds of wall time."""
    began = time.perf_counter()
    for number in range(most):
        if number >= least and time.perf_counter() - began >= budget:
            return
        announce(f"timing, round {number + 1}")
        yield number


def median_of(repeats: int, run: Callable[[], float]) -> float:
    """Median of a run that is short, made so many times within a round."""
    return float(np.median([run() for _ in range(repeats)]))


def quartiles(name: str, values: np.ndarray | list[float]) -> dict[str, float]:
    """Median, and quartiles as ``_q1`` and ``_q3``: columns of a study's result."""
    low, median, high = np.percentile(values, (25.0, 50.0, 75.0)).tolist()
    return {name: median, f"{name}_q1": low, f"{name}_q3": high}


def spread(row: Any, name: str, scale: float = 1.0) -> str:
    """Median and, in brackets, quartiles of a row that `quartiles` made, to three digits."""
    median, low, high = (_three(scale * getattr(row, name + end)) for end in ("", "_q1", "_q3"))
    return f"{median} [{low}, {high}]"


def _three(number: float) -> str:
    """Three significant digits without an exponent."""
    return f"{number:.0f}" if number >= 100.0 else f"{number:#.3g}".rstrip(".")
