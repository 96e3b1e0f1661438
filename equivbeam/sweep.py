"""Many springs at once, on all processor cores."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable, Iterator
from contextlib import suppress
from dataclasses import dataclass
from functools import partial
from itertools import islice
from typing import Any

from coilspring.errors import EquilibriumNotFound, InputError, shown
from coilspring.scene import Scene
from coilspring.workers import processes
from equivbeam.laws import law_of
from equivbeam.solve import solve

CHUNK = 64  # springs handed to a worker at a time


@dataclass(frozen=True)
class Outcome:
    """Result of one spring of a sweep.

    Attributes
    ----------
    outcome : as in `coilspring.EquilibriumPath`, or "refused" for bad input.
    message : one sentence.
    last_time : time reached, 1 where completed.
    tip : UX, UY, ROTZ at the last time reached, mm, rad; None where there is none.
    active_contacts, max_penetration : at the last time reached; pairs, mm.
    critical_time : of a critical point, or None.
    total_iterations : factorisations.
    """

    outcome: str
    message: str
    last_time: float = 0.0
    tip: tuple[float, float, float] | None = None
    active_contacts: int = 0
    max_penetration: float = 0.0
    critical_time: float | None = None
    total_iterations: int = 0


def sweep(
    scenes: Iterable[Scene],
    *,
    workers: int | None = None,
    progress: Callable[[int], None] | None = None,
    **options: Any,
) -> Iterator[Outcome]:
    """Solve many scenes with the equivalent beam; yields an `Outcome` for each, in their order.

    Springs that fail do not stop the others. Scenes are drawn as they are needed, results are handed
    out as they come: a sweep needs little history however long it is.

    Parameters
    ----------
    scenes : iterable of Scene
    workers : int, optional
        Processes; by default one for each processor core.
    progress : callable, optional
        Called with the number of springs done so far.
    **options
        Those of `equivbeam.solve`. ``steps=1`` asks for the answer at full load alone, which is
        the fastest: substeps are taken as the path needs them.

    Yields
    ------
    Outcome

    Raises
    ------
    InputError : `scenes` are none, as a name or a single scene.
    """
    if isinstance(scenes, str | Scene) or not isinstance(scenes, Iterable):
        raise InputError(f"scenes must be an iterable of coilspring.Scene, got {shown(scenes)}")
    with suppress(InputError):  # every scene is refused then
        options = {**options, "law": law_of(options.get("law", "haringx"))}  # one content for all workers
    return _swept(iter(scenes), workers or os.cpu_count() or 1, progress, partial(_outcomes, options=options))


def _swept(
    springs: Iterator[Scene],
    count: int,
    progress: Callable[[int], None] | None,
    task: Callable[[list[Scene]], list[Outcome]],
) -> Iterator[Outcome]:
    """Outcomes of the springs in their order."""
    done = 0
    with processes(count) as pool:
        waiting = [pool.submit(task, chunk) for chunk in _chunks(springs, 4 * count)]
        while waiting:
            found = waiting.pop(0).result()
            waiting += [pool.submit(task, chunk) for chunk in _chunks(springs, 1)]
            for outcome in found:
                done += 1
                yield outcome
            if progress is not None:
                progress(done)


def _chunks(springs: Iterator[Scene], count: int) -> list[list[Scene]]:
    """At most `count` chunks of the springs that are left."""
    chunks = (list(islice(springs, CHUNK)) for _ in range(count))
    return [chunk for chunk in chunks if chunk]


def _outcomes(scenes: list[Scene], options: dict) -> list[Outcome]:
    return [_outcome(scene, options) for scene in scenes]


def _outcome(scene: Scene, options: dict) -> Outcome:
    try:
        path = solve(scene, **options)
    except EquilibriumNotFound as found:
        path = found.path
    except InputError as refused:
        return Outcome("refused", str(refused))
    if not len(path.times):
        return Outcome(path.outcome, path.message, critical_time=path.critical_time)
    return Outcome(
        outcome=path.outcome,
        message=path.message,
        last_time=float(path.times[-1]),
        tip=tuple(path.tips[-1].tolist()),
        active_contacts=int(path.active_contacts[-1]),
        max_penetration=float(path.max_penetration[-1]),
        critical_time=path.critical_time,
        total_iterations=path.total_iterations,
    )
