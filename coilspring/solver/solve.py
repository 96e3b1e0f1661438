"""From a model's arrays and kernels to an `EquilibriumPath`, or to `EquilibriumNotFound`."""

import time
from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from coilspring.compiling.packing import pack
from coilspring.contact.law import PAIR_HISTORY
from coilspring.contact.transitions import located_to, predicted_to
from coilspring.errors import EquilibriumNotFound
from coilspring.path import EquilibriumPath, Shape
from coilspring.scene import Scene
from coilspring.solver.cautions import warning
from coilspring.solver.equilibrium.newton import DECREMENTS
from coilspring.solver.interface import Kernels
from coilspring.solver.interrupt import interruptible
from coilspring.solver.outcome import judged, snaps, undecided, verdict
from coilspring.solver.problem import Problem, Track
from coilspring.solver.stages import stages
from coilspring.solver.startup import ready
from coilspring.solver.system import (
    COMPLETED,
    NEW_PAIR,
    NEWTON,
    PATH,
    STUCK,
    SUBSTEP,
    Data,
    Records,
    Task,
    Workspace,
)

# Of a substep with the exact tangent: 2 or 3 far from changes of contact, many with kinks.
MOST_ITERATIONS = 200


@dataclass(frozen=True)
class Run:
    """A followed problem: the track, and the seconds of solving (CPU) and of making kernels ready."""

    problem: Problem  # with the pairs that were found on the way
    track: Track
    mode: np.ndarray  # softest mode where the path ended at a critical point; else zeros
    work: float  # share of the load that does work with it
    outcome: str
    message: str
    critical_time: float | None
    solve_seconds: float
    compile_seconds: float

    @property
    def spent(self) -> int:
        """Factorisations in all."""
        return int(self.track.iterations.sum() + self.track.rest)


class Walk:
    """The arrays and records in which the compiled follower works; it goes on with them when called again."""

    def __init__(self, problem: Problem, times: np.ndarray) -> None:
        n, rows = problem.load.size, len(times)
        state, vector, matrix = problem.start.size, n, problem.matrix_size
        sizes = dict.fromkeys(("g", "step", "load", "mode", "tangent", "old", "ahead"), vector)
        sizes |= dict.fromkeys(("H", "F", "rest"), matrix) | {"decrements": DECREMENTS}
        arrays = {name: np.zeros(sizes.get(name, state)) for name in Workspace._fields}
        arrays |= {name: problem.history.copy() for name in ("history", "trial_history", "low", "high")}
        arrays |= {
            "states": np.empty((rows, state)),
            "histories": np.zeros((rows, len(problem.history)), PAIR_HISTORY),
            "iterations": np.zeros(rows, np.int64),
            "least_gaps": np.empty(rows),
        }
        self.work = Workspace(**arrays)
        self.records = Records(*(np.zeros(1, dtype) for dtype in (PATH, SUBSTEP, NEWTON)))

    def extend(self, problem: Problem) -> None:
        """Make room for the pairs that a problem has beyond those so far, and for its matrix."""
        more = len(problem.history) - len(self.work.history)
        tables = ("history", "trial_history", "low", "high")
        padded = {name: _with_pairs(getattr(self.work, name), more) for name in (*tables, "histories")}
        padded |= {name: np.zeros(problem.matrix_size) for name in ("H", "F", "rest")}
        self.work = self.work._replace(**padded)

    def track(self) -> Track:
        """What has been followed so far."""
        path, work = self.records.path[0], self.work
        row = int(path["row"])
        return Track(
            states=work.states[:row],
            histories=work.histories[:row],
            iterations=work.iterations[:row],
            least_gaps=work.least_gaps[:row],
            rest=int(path["spent"]),
            outcome=int(path["outcome"]),
            time=float(path["time"]),
            bracket=float(path["bracket"]),
            checks=int(path["checks"]),
            pairs=int(path["pairs"]),
            last=work.state,
            history=work.history,
            decrements=work.decrements,
            far=bool(path["snap"]["far"]),
            bifurcates=bool(path["snap"]["bifurcates"]),
            snaps=int(path["snap"]["count"]),
            largest_snap=float(path["snap"]["largest"]),
            undecided=float(path["undecided"]),
        )


def follow_problem(
    problem: Problem,
    kernels: Kernels,
    times: np.ndarray,
    length: float,
    *,
    limit: int = MOST_ITERATIONS,
    predictor: bool = True,
) -> Run:
    """Follow a problem through the increasing `times`; `length` is the one with which moves are compared."""
    began = time.perf_counter()
    follow, bundle = ready(kernels)
    compiled = time.perf_counter() - began
    began = time.process_time()
    dead = np.zeros_like(problem.load) if problem.dead is None else problem.dead
    law, (moves, turns) = problem.law, problem.dofs_per_node
    arms = np.resize([1.0] * moves + [length] * turns, problem.load.size)
    task = Task(
        times, problem.load, dead, problem.start, arms, problem.span, length, located_to(law.mu) * law.d,
        predicted_to(law.mu) * law.d, law.kc, law.k, limit, predictor, problem.modified,
    )  # fmt: skip
    walk = Walk(problem, times)
    while True:
        data = Data(*pack(problem.data), problem.prescribed)
        interruptible(follow, data, bundle, task, walk.work, walk.records)
        if walk.records.path[0]["outcome"] != NEW_PAIR or problem.extended is None:
            break
        more = problem.extended(walk.work.trial)
        new = len(more.history) - len(problem.history)
        if new == 0:
            walk.records.path[0]["outcome"] = STUCK
            break
        history = _with_pairs(problem.history, new)
        problem = replace(
            problem, data=more.data, history=history, matrix_size=more.matrix_size, extended=more.extended
        )
        walk.extend(problem)
    track, mode, work = judged(walk.track(), problem, kernels, length)
    seconds = time.process_time() - began
    return Run(problem, track, mode, work, *verdict(track, work), seconds, compiled)


def output_times(scene: Scene) -> np.ndarray:
    """Times at which the scene wants results."""
    return np.arange(1, scene.load.rows + 1) / scene.load.rows


def follow_load(
    scene: Scene, problem: Problem, kernels: Kernels, *, limit: int = MOST_ITERATIONS, predictor: bool = True
) -> Run:
    """Follow the scene's load with a model's kernels, stage by stage."""
    length = scene.spring.wire_diameter
    controls: dict[str, Any] = {"limit": limit, "predictor": predictor}
    if not (scene.load.stages or scene.load.displacement):
        return follow_problem(problem, kernels, output_times(scene), length, **controls)
    assert problem.top is not None
    runs: list[Run] = []
    times = np.arange(1, scene.load.steps + 1) / scene.load.steps
    for stage in stages(scene, problem.top):
        problem = replace(
            problem,
            load=_on_top(problem, stage.growing),
            dead=_on_top(problem, stage.dead),
            prescribed=stage.prescribed,
        )
        runs.append(follow_problem(problem, kernels, times, length, **controls))
        track, problem = runs[-1].track, runs[-1].problem
        if track.outcome != COMPLETED:
            break
        problem = replace(problem, start=track.states[-1], history=track.histories[-1].copy())
    return _joined(runs, scene.load.rows // scene.load.steps)


def _on_top(problem: Problem, force: np.ndarray) -> np.ndarray:
    """Load vector of a force on the top."""
    assert problem.top is not None
    load = np.zeros_like(problem.load)
    load[list(problem.top.dof)] = force
    return load


def _with_pairs(histories: np.ndarray, more: int) -> np.ndarray:
    """Contact histories with further pairs, which have never closed."""
    return np.concatenate((histories, np.zeros((*histories.shape[:-1], more), PAIR_HISTORY)), axis=-1)


def _joined(runs: list[Run], count: int) -> Run:
    """Run through the first of `count` stages, each of which took the times 0..1."""
    tracks = [run.track for run in runs]
    last, pairs = tracks[-1], tracks[-1].history.shape[0]
    padded = [_with_pairs(track.histories, pairs - track.histories.shape[1]) for track in tracks]
    track = replace(
        last,
        states=np.concatenate([track.states for track in tracks]),
        histories=np.concatenate(padded),
        iterations=np.concatenate([track.iterations for track in tracks]),
        least_gaps=np.concatenate([track.least_gaps for track in tracks]),
        time=(len(runs) - 1 + last.time) / count,
        bracket=last.bracket / count,
        checks=sum(track.checks for track in tracks),
        pairs=sum(track.pairs for track in tracks),
        snaps=sum(track.snaps for track in tracks),
        largest_snap=max(track.largest_snap for track in tracks),
        undecided=min((stage + track.undecided) / count for stage, track in enumerate(tracks)),
    )
    outcome, message, critical = verdict(track, runs[-1].work)
    return replace(
        runs[-1],
        track=track,
        outcome=outcome,
        message=message,
        critical_time=critical,
        solve_seconds=sum(run.solve_seconds for run in runs),
        compile_seconds=sum(run.compile_seconds for run in runs),
    )


def scene_path(
    scene: Scene, model: str, options: Mapping[str, object], run: Run, shape: Shape
) -> EquilibriumPath:
    """Path of a run.

    Raises
    ------
    EquilibriumNotFound : where the path ends before time 1.
    """
    track = run.track
    path = EquilibriumPath(
        scene=scene,
        model=model,
        options=dict(options),
        times=output_times(scene)[: len(track.states)],
        states=track.states,
        histories=track.histories,
        iterations=track.iterations,
        least_gaps=track.least_gaps,
        outcome=run.outcome,
        message=run.message + snaps(track) + undecided(track),
        shape=shape,
        critical_time=run.critical_time,
        critical_bracket=None if run.critical_time is None else track.bracket,
        undecided_time=track.undecided if track.undecided < np.inf else None,
        end_bracket=None if track.outcome == COMPLETED else (track.time, track.time + track.bracket),
        last_state=None if track.outcome == COMPLETED else track.last,
        total_iterations=run.spent,
        stability_checks=track.checks,
        pair_evaluations=track.pairs,
        residual_history=tuple(track.decrements[track.decrements > 0.0]),
        solve_seconds=run.solve_seconds,
        compile_seconds=run.compile_seconds,
    )
    if said := warning(path):
        path = replace(path, message=path.message + said)
    if path.outcome != "completed":
        raise EquilibriumNotFound(path)
    return path
