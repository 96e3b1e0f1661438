"""Many springs at once by the equivalent beam."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from contextlib import suppress
from functools import partial
from typing import Any

from coilspring.errors import InputError
from coilspring.scene import Scene
from coilspring.solver.startup import store
from coilspring.sweep import Outcome, jobs, outcomes
from equivbeam.laws import law_of
from equivbeam.solve import KERNELS, solve

CHUNK = 64  # springs handed to a worker at a time


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
        Processes; by default one for each processor core. 0: none besides this one, which is the
        fastest for a few springs.
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
    with suppress(InputError):  # every scene is refused then
        options = {**options, "law": law_of(options.get("law", "haringx"))}  # one content for all workers
    springs = jobs(scenes, solve, options)
    return outcomes(springs, chunk=CHUNK, workers=workers, progress=progress, prepare=partial(store, KERNELS))
