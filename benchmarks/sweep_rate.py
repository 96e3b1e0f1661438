"""CPU time of sweeps: of a spring like Spring B at full load, in its solve, beside it, and between processes.

CPU milliseconds of a spring by `getrusage`, which other users of the cores change less than the clock does.
Starting the workers is told apart: a sweep of twice as many springs costs as much more as these do.
"""

from __future__ import annotations

import argparse
import resource
from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from types import ModuleType
from typing import Any

import numpy as np

import equivbeam
import wirefe
from coilspring import Scene, spring_b
from coilspring.sweep import Outcome

MODELS: tuple[tuple[ModuleType, dict[str, Any], int], ...] = (  # and how many times the springs
    (equivbeam, {"steps": 1}, 10),
    (wirefe, {"steps": 1, "element": "curved", "elements_per_turn": 4}, 1),
)
WORKERS = 2


def springs(count: int) -> Iterator[Scene]:
    """Cones like Spring B, of other wires, diameters and loads, all of which reach full load."""
    draw, cone = np.random.default_rng(1), spring_b()
    for _ in range(count):
        spring = replace(
            cone.spring,
            wire_diameter=draw.uniform(1.5, 1.6),
            mean_diameter=(draw.uniform(11.5, 12.0), draw.uniform(6.0, 6.5)),
        )
        load = replace(cone.load, force=(0.0, -draw.uniform(150.0, 200.0)))
        yield replace(cone, spring=spring, load=load)


def seconds() -> float:
    """CPU seconds so far, of this process and of those that have ended."""
    used = (resource.getrusage(who) for who in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN))
    return sum(each.ru_utime + each.ru_stime for each in used)


def timed(run: Callable[[], Any]) -> tuple[Any, float]:
    """What a call returns, and its CPU seconds."""
    began = seconds()
    return run(), seconds() - began


def alone(model: ModuleType, options: dict[str, Any], count: int) -> tuple[float, float]:
    """CPU milliseconds of a spring in the solve and beside it, in this process."""
    scenes = list(springs(count))
    model.solve(scenes[0], **options)  # compiles
    paths, total = timed(lambda: [model.solve(scene, **options) for scene in scenes])
    inside = sum(path.solve_seconds for path in paths)
    return 1e3 * inside / count, 1e3 * (total - inside) / count


def swept(model: ModuleType, options: dict[str, Any], count: int) -> tuple[float, float]:
    """CPU milliseconds of a spring in a sweep, and CPU seconds of starting it."""

    def run(number: int) -> list[Outcome]:
        return list(model.sweep(springs(number), workers=WORKERS, **options))

    run(WORKERS)  # leaves compiled kernels on the disk
    (some, first), (all_, second) = (timed(lambda n=n: run(n)) for n in (count, 2 * count))
    ended = {each.outcome for each in some + all_}
    assert ended == {"completed"}, ended
    each = (second - first) / count
    return 1e3 * each, first - count * each


def main(arguments: Sequence[str] | None = None) -> int:
    """Print the times; returns the exit code."""
    parser = argparse.ArgumentParser(description="Time sweeps of both models.")
    parser.add_argument("--springs", type=int, default=400, help="of a sweep; default: 400")
    count = parser.parse_args(arguments).springs
    print("ms CPU a spring     solve  beside   sweep   springs a second on 2 cores   start (s CPU)")
    for model, options, times in MODELS:
        inside, beside = alone(model, options, times * count)
        each, start = swept(model, options, times * count)
        rate = WORKERS / (1e-3 * each)
        print(f"  {model.__name__:16s}{inside:7.2f} {beside:7.2f} {each:7.2f} {rate:22.0f} {start:22.1f}")
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
