"""Many springs at once, on all processor cores: what the sweeps of both models share."""

import inspect
import os
from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import as_completed
from dataclasses import dataclass
from functools import partial
from itertools import chain, islice, repeat
from typing import Any

import numpy as np

from coilspring.errors import EquilibriumNotFound, InputError
from coilspring.path import EquilibriumPath
from coilspring.scene import Load, Scene
from coilspring.scene.spring import Spring
from coilspring.solver.interface import Kernels
from coilspring.solver.startup import store
from coilspring.words import shown
from coilspring.workers import processes, require_workers

REFUSED, CRASHED = "refused", "crashed"  # outcomes besides those of a path
AHEAD = 4  # chunks of springs handed out for each worker

Solver = Callable[[Scene], EquilibriumPath]  # a function that can be sent to another process
Job = tuple[Scene, Solver]
KernelsOf = Callable[[Scene, Any], Kernels]  # kernels with which a scene's solver solves it
# What takes the place of a scene's own is bad for all scenes where it is for one.
ANY = Scene("any", Spring(1.0, (10.0, 10.0), 4.0, 20.0), Load((0.0, -1.0)))
OVERRIDES = tuple(inspect.signature(ANY.overridden).parameters)


@dataclass(frozen=True)
class Outcome:
    """Result of one spring of a sweep.

    Attributes
    ----------
    outcome : as in `coilspring.EquilibriumPath`, "refused" for bad input, or "crashed" where the program
        failed.
    message : one sentence.
    last_time : time reached, 1 where completed.
    tip : UX, UY, ROTZ at the last time reached, mm, rad; None where there is none.
    load : Fx, Fy at the top there, N; of a prescribed displacement the reaction; None where there is none.
    active_contacts, max_penetration, max_contact_force : there; pairs, mm, N.
    rate : dF/du along the load there, N/mm, or None; see `EquilibriumPath.rates`.
    max_stress : of the wire, the largest on the path, MPa; None of the equivalent beam; see
        `EquilibriumPath.max_stress`.
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
    load: tuple[float, float] | None = None
    max_contact_force: float = 0.0
    rate: float | None = None
    max_stress: float | None = None


@dataclass(frozen=True)
class Sweeper:
    """What `sweep` of a model is made of."""

    solve: Callable[..., EquilibriumPath]
    kernels: Callable[..., Kernels]  # of a scene and options
    chunk: int  # springs handed to a worker at a time
    # all options, as workers get them; `InputError` for those that are bad for any scene
    checked: Callable[[dict[str, Any]], dict[str, Any]]

    def sweep(
        self,
        scenes: Iterable[Scene],
        *,
        workers: int | None = None,
        progress: Callable[[int], None] | None = None,
        **options: Any,
    ) -> Iterator[Outcome]:
        """Solve many scenes; yields an `Outcome` for each, in their order, as they come.

        Springs that fail do not stop the others. Scenes are drawn as they are needed.

        Parameters
        ----------
        scenes : iterable of Scene
        workers : int, optional
            Processes, no more than are needed; by default one for each processor core. 0: none besides this
            one, which is the fastest for a few springs.
        progress : callable, optional
            Called with the number of springs done so far.
        **options
            Those of the model's `solve`. The fastest: ``steps=1``, the answer at full load alone; of `wirefe`
            with ``element="curved", elements_per_turn=4``.

        Raises
        ------
        InputError : `scenes` are none, as a name or a single scene; or an option is bad for any scene. Of one
            that is bad for some, as a mesh that does not fit a spring, the outcome of these is "refused".
        TypeError : an option that `solve` does not have.
        """
        if isinstance(scenes, str | Scene) or not isinstance(scenes, Iterable):
            raise InputError(f"scenes must be an iterable of coilspring.Scene, got {shown(scenes)}")
        require_workers(workers)
        bound = inspect.signature(self.solve).bind(None, **options)
        bound.apply_defaults()
        _, *chosen = bound.arguments.items()
        ANY.overridden(**{name: value for name, value in chosen if name in OVERRIDES})
        options = self.checked(dict(chosen))
        return outcomes(
            zip(scenes, repeat(partial(self.solve, **options))),
            chunk=self.chunk,
            workers=workers,
            progress=progress,
            kernels=lambda scene, _: self.kernels(scene, **options),
        )


def outcomes(
    jobs: Iterator[Job],
    *,
    chunk: int,
    workers: int | None = None,
    progress: Callable[[int], None] | None = None,
    kernels: KernelsOf | None = None,
) -> Iterator[Outcome]:
    """Outcomes of scenes, each by its own solver, in their order; `jobs` are drawn as they are needed.

    `chunk` springs are handed at a time to each of `workers` processes: one for each processor core where
    None, none besides this one for 0. `progress` is called with the number of springs done. The `kernels` of
    a scene are left on the disk before a worker needs them.
    """
    done = 0
    for _, found in _found(jobs, chunk, workers, kernels, ordered=True):
        yield from found
        done += len(found)
        if progress is not None:
            progress(done)


def outcomes_as_they_come(
    jobs: Iterator[Job], *, chunk: int, workers: int | None, kernels: KernelsOf
) -> Iterator[tuple[int, Outcome]]:
    """As `outcomes`, each with the number of its job, and none waits for one that was handed out before."""
    for first, found in _found(jobs, chunk, workers, kernels, ordered=False):
        yield from enumerate(found, first)


def _found(
    jobs: Iterator[Job], chunk: int, workers: int | None, kernels: KernelsOf | None, ordered: bool
) -> Iterator[tuple[int, list[Outcome]]]:
    """Number of the first job and outcomes, one by one by this process or in chunks by others."""
    workers = require_workers(workers)
    if workers == 0:
        yield from ((i, [outcome_of(*job)]) for i, job in enumerate(jobs))
        return
    count = (os.cpu_count() or 1) if workers is None else workers

    def prepared(job: Job) -> Job:
        if kernels is not None and isinstance(job[0], Scene):  # else it is refused
            store(kernels(*job))
        return job

    chunks = iter(lambda: list(map(prepared, islice(jobs, chunk))), [])
    head = list(islice(chunks, count))
    if not head:
        return
    with processes(len(head)) as pool:  # no more than have something to do
        parts = enumerate(chain(head, chunks))
        handed = ((pool.submit(_outcomes, part), i * chunk) for i, part in parts)
        waiting = dict(islice(handed, AHEAD * count))
        while waiting:
            ready = next(iter(waiting) if ordered else as_completed(waiting))
            first, found = waiting.pop(ready), ready.result()
            waiting.update(islice(handed, 1))
            yield first, found


def _outcomes(jobs: list[Job]) -> list[Outcome]:
    return [outcome_of(scene, solve) for scene, solve in jobs]


def outcome_of(scene: Scene, solve: Solver) -> Outcome:
    """Outcome of one scene, whatever happens."""
    try:
        return _outcome(solve(scene))
    except EquilibriumNotFound as found:
        return _outcome(found.path)
    except InputError as refused:
        return Outcome(REFUSED, str(refused))
    except Exception as error:  # of one spring, which must not cost the others
        return Outcome(CRASHED, " ".join(f"{type(error).__name__}: {error}".split()))


def _outcome(path: EquilibriumPath) -> Outcome:
    spent: dict[str, Any] = {"critical_time": path.critical_time, "total_iterations": path.total_iterations}
    if not len(path.times):
        return Outcome(path.outcome, path.message, **spent)
    gaps, forces = path.shape.pair_gaps(path.states[-1:]), path.shape.pair_forces(path.states[-1:])
    return Outcome(
        path.outcome,
        path.message,
        last_time=float(path.times[-1]),
        tip=tuple(path.tips[-1].tolist()),
        load=tuple(path.loads[-1].tolist()),
        active_contacts=int(np.count_nonzero(gaps < 0.0)),
        max_penetration=float(np.maximum(-gaps, 0.0).max(initial=0.0)),
        max_contact_force=float(forces.max(initial=0.0)),
        rate=float(path.rates_at(slice(-1, None))[0]),
        max_stress=None if path.max_stress is None else float(path.max_stress.max()),
        **spent,
    )
