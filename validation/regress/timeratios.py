"""Ratios of solution times between the models: kept beside the baselines, compared only on request."""

import json
from collections.abc import Callable, Mapping
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from coilspring import EquilibriumNotFound, EquilibriumPath, InputError, Scene
from validation.regress.baselines import made
from validation.study.cases import CASES
from validation.study.files import json_bytes, write_bytes
from validation.study.paths import solve_beam, solve_wire
from validation.study.timing import announced, interleaved, median_of

FILE = "times.json"
ROUNDS, REPEATS = 5, 5
ALLOWED = 1.5  # factor by which a ratio may change


def _seconds(solve: Callable[..., EquilibriumPath], scene: Scene, **options: Any) -> float:
    """CPU seconds of a model; of the beam, which takes about a millisecond, the median of several solves."""
    repeats = REPEATS if solve is solve_beam else 1
    return median_of(repeats, lambda: solve(scene, **options).solve_seconds)


RUNS: dict[str, Callable[[Scene], float]] = {
    "straight": partial(_seconds, solve_wire),
    "curved": partial(_seconds, solve_wire, element="curved", elements_per_turn=8),
    "haringx": partial(_seconds, solve_beam),
    "helix": partial(_seconds, solve_beam, law="helix", sliding="scene"),  # free, B ends early
}
RATIOS = {
    "wirefe straight 40 / equivbeam haringx": ("straight", "haringx"),
    "wirefe straight 40 / wirefe curved 8": ("straight", "curved"),
    "equivbeam helix / equivbeam haringx": ("helix", "haringx"),
}


def measure(
    progress: Callable[[str], None], scene: Scene | None = None
) -> tuple[dict[str, float], tuple[str, ...]]:
    """Medians of ratios that are formed within each round, by name, and a sentence on those left out; of a
    user's scene, by default of the paper's cases."""
    found: dict[str, float] = {}
    left_out: list[str] = []
    for each in [case.scene for case in CASES] if scene is None else [scene]:
        runs = {name: partial(run, each) for name, run in RUNS.items()}
        try:
            seconds = interleaved(runs, announced(ROUNDS, progress, f"timing: {each.name}"))
        except (InputError, EquilibriumNotFound) as error:
            left_out.append(f"{each.name} has no ratios of times: {error}")
            continue
        for name, (one, other) in RATIOS.items():
            found[f"{each.name}, {name}"] = float(np.median(seconds[one] / seconds[other]))
    return found, tuple(left_out)


def write(ratios: Mapping[str, float], folder: Path) -> None:
    """Write the ratios with where and when they were measured."""
    kept = {"made": made(), "ratios": {name: round(ratio, 3) for name, ratio in ratios.items()}}
    write_bytes(folder / FILE, json_bytes(kept))


def compare(folder: Path, ratios: Mapping[str, float]) -> list[tuple[str, str, str, str]]:
    """Ratios that changed by more than `ALLOWED`, as what moves; `InputError` where none are kept."""
    file = folder / FILE
    try:
        kept = json.loads(file.read_text(encoding="utf-8"))["ratios"]
        pairs = [(name, float(kept.get(name, np.nan)), ratio) for name, ratio in ratios.items()]
    except (OSError, ValueError, KeyError, TypeError, AttributeError) as error:
        raise InputError(f"{file} holds no ratios of times; write them by --accept") from error
    return [
        (name, f"{before:.3g}", f"{now:.3g}", f"factor {now / before:.3g}, {ALLOWED:g} allowed")
        for name, before, now in pairs
        if not 1.0 / ALLOWED <= now / before <= ALLOWED
    ]
