"""Many springs at once by the wire model."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from functools import partial
from typing import Any

from coilspring.scene import Scene
from coilspring.solver.startup import store
from coilspring.sweep import Outcome, jobs, outcomes
from wirefe.solve import KERNELS, solve

CHUNK = 16  # springs handed to a worker at a time


def sweep(
    scenes: Iterable[Scene],
    *,
    workers: int | None = None,
    progress: Callable[[int], None] | None = None,
    **options: Any,
) -> Iterator[Outcome]:
    """Solve many scenes with the wire model; yields an `Outcome` for each, in their order.

    Springs that fail do not stop the others. Scenes are drawn as they are needed, results are handed
    out as they come.

    Parameters
    ----------
    scenes : iterable of Scene
    workers : int, optional
        Processes; by default one for each processor core. 0: none besides this one, which is the
        fastest for a few springs.
    progress : callable, optional
        Called with the number of springs done so far.
    **options
        Those of `wirefe.solve`. ``element="curved", elements_per_turn=4, steps=1`` is the fastest.

    Yields
    ------
    Outcome

    Raises
    ------
    InputError : `scenes` are none, as a name or a single scene.
    """
    springs = jobs(scenes, solve, options)
    return outcomes(springs, chunk=CHUNK, workers=workers, progress=progress, prepare=partial(store, KERNELS))
