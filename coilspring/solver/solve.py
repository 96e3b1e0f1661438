"""From a model's arrays and kernels to an `EquilibriumPath`, or to `EquilibriumNotFound`."""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from coilspring.compiling.packing import pack
from coilspring.contact.history import has_friction
from coilspring.contact.kinematics import OVERLAP_ALLOWED
from coilspring.contact.law import PAIR_HISTORY
from coilspring.errors import EquilibriumNotFound
from coilspring.path import EquilibriumPath, Shape
from coilspring.scene import Scene
from coilspring.solver.coulomb import goes_on, time_left
from coilspring.solver.follower import MOST_TRIES
from coilspring.solver.interface import Kernels
from coilspring.solver.interrupt import interruptible
from coilspring.solver.newton import DECREMENTS
from coilspring.solver.stability import Body, softest
from coilspring.solver.stages import Top, stages
from coilspring.solver.startup import ready
from coilspring.solver.system import (
    COMPLETED,
    CRITICAL,
    EXHAUSTED,
    FREE,
    JUMP,
    NEW_PAIR,
    NEWTON,
    OVERLAP,
    PATH,
    STUCK,
    SUBSTEP,
    TURNED,
    WATCH,
    Task,
    Workspace,
)

MOST_ITERATIONS = (
    200  # of a substep with the exact tangent: 2 or 3 far from changes of contact, many with kinks
)
# Null modes of a bifurcation do no work with the load; rounding leaves far less than this share.
NO_WORK = 1e-6
SOFT = 0.01  # stiffness of the softest mode over that at rest, below which the tangent counts as singular
LEFT = 1e-5  # of the time 0..1: so near to where a path ends, a limit point of Coulomb's law is its end
SLIDING = -1  # outcome beside those of `coilspring.solver.follower`: see `coilspring.solver.coulomb`
HELD = "Coulomb's law has a solution beyond, but the iteration on friction bounds found no stable equilibrium"
JUMPS = (
    "a sticking pair opens, and the path jumps: no equilibrium is near as its tangential force is released,"
)
THROUGH = (
    f"coils pass through each other: the wire overlaps by {OVERLAP_ALLOWED:g} wire diameters more than any "
    "contact pair"
)
WHY = {
    SLIDING: HELD,
    STUCK: "no equilibrium that continues the branch was found",
    EXHAUSTED: f"the path was stopped after {MOST_TRIES} equilibria besides those at requested times,",
}
VOID_PENETRATION = 0.1  # wire diameters of overlap, beyond which a penalty no longer stands for contact


@dataclass(frozen=True)
class Problem:
    """A scene made ready by a model for the path follower.

    Attributes
    ----------
    data : the model's arrays (NamedTuple).
    load : (n,) load vector at time 1 in the model's free degrees of freedom.
    start : state at rest.
    history : (pairs,) contact history at rest.
    matrix_size : length of the model's matrix in its own storage.
    modified : the matrix is costly: see `coilspring.solver.system.Task`.
    top : where the top reference point is in the state; for loads of several stages.
    dead : (n,) load that acts from the beginning, or None.
    prescribed : see `coilspring.solver.system`.
    extended : gives the problem with the pairs that touch in a state besides its own, which come last.
    """

    data: Any
    load: np.ndarray
    start: np.ndarray
    history: np.ndarray
    matrix_size: int
    modified: bool = False
    top: Top | None = None
    dead: np.ndarray | None = None
    prescribed: np.ndarray = field(default_factory=lambda: FREE)
    extended: Callable[[np.ndarray], Problem] | None = None


@dataclass(frozen=True)
class Track:
    """What was followed, as the solver left it."""

    states: np.ndarray  # (reached, state size), at the requested times
    histories: np.ndarray  # (reached, pairs) contact history with which they were found
    iterations: np.ndarray  # (reached,), factorisations since the previous row
    rest: int  # factorisations spent after the last row
    outcome: int
    time: float  # last accepted time
    bracket: float  # time beyond it, in which the path ends
    checks: int  # factorisations that only verified the stability of a linear stretch
    pairs: int  # contact pairs evaluated
    last: np.ndarray  # last accepted state
    history: np.ndarray  # contact history with which a step from there was tried
    decrements: np.ndarray  # last Newton decrements over the reference work
    snaps: int  # limit points passed, see `coilspring.solver.snap`,
    largest_snap: float  # and bound on the largest motion at one of them, wire diameters


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
        arrays |= {"change": np.zeros(len(problem.history)), "states": np.empty((rows, state))}
        arrays |= {
            "histories": np.zeros((rows, len(problem.history)), PAIR_HISTORY),
            "iterations": np.zeros(rows, np.int64),
        }
        self.work = Workspace(**arrays)
        self.path, self.substep, self.newton = (np.zeros(1, dtype) for dtype in (PATH, SUBSTEP, NEWTON))
        self.watch = np.zeros(2, WATCH)

    def extend(self, problem: Problem) -> None:
        """Make room for the pairs that a problem has beyond those so far, and for its matrix."""
        more = len(problem.history) - len(self.work.history)
        tables = ("history", "trial_history", "low", "high")
        padded = {name: _with_pairs(getattr(self.work, name), more) for name in (*tables, "histories")}
        padded["change"] = np.zeros(len(problem.history))
        padded |= {name: np.zeros(problem.matrix_size) for name in ("H", "F", "rest")}
        self.work = self.work._replace(**padded)

    def track(self) -> Track:
        """What has been followed so far."""
        path, work = self.path[0], self.work
        row = int(path["row"])
        return Track(
            states=work.states[:row],
            histories=work.histories[:row],
            iterations=work.iterations[:row],
            rest=int(path["spent"]),
            outcome=int(path["outcome"]),
            time=float(path["time"]),
            bracket=float(path["bracket"]),
            checks=int(path["checks"]),
            pairs=int(path["pairs"]),
            last=work.state,
            history=work.history,
            decrements=work.decrements,
            snaps=int(path["snaps"]),
            largest_snap=float(path["largest_snap"]),
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
    task = Task(times, problem.load, dead, problem.start, length, limit, predictor, problem.modified)
    walk = Walk(problem, times)
    while True:
        interruptible(
            follow, *pack(problem.data), problem.prescribed, bundle, task, walk.work, walk.path,
            walk.substep, walk.newton, walk.watch,
        )  # fmt: skip
        if walk.path[0]["outcome"] != NEW_PAIR or problem.extended is None:
            break
        more = problem.extended(walk.work.trial)
        new = len(more.history) - len(problem.history)
        if new == 0:
            walk.path[0]["outcome"] = STUCK
            break
        history = _with_pairs(problem.history, new)
        problem = replace(
            problem, data=more.data, history=history, matrix_size=more.matrix_size, extended=more.extended
        )
        walk.extend(problem)
    track, mode, work = _judged(walk.track(), problem, kernels, length)
    seconds = time.process_time() - began
    return Run(problem, track, mode, work, *_verdict(track, work), seconds, compiled)


def _judged(
    track: Track, problem: Problem, kernels: Kernels, length: float
) -> tuple[Track, np.ndarray, float]:
    """The track, with a critical point distinguished from a path that got stuck, the softest mode at its end,
    and the share of the load that does work with it."""
    load, prescribed = problem.load, problem.prescribed
    if track.outcome not in (CRITICAL, STUCK, TURNED):
        return track, np.zeros_like(load), 0.0
    body = Body(kernels, pack(problem.data), load.size, problem.matrix_size, prescribed)
    share, mode = softest(body, track.last, track.history, problem.start)
    end = (body, track.last, track.history, load, length)
    friction = has_friction(track.history.view(np.recarray))
    left = time_left(*end) if friction else np.inf
    if track.outcome == TURNED:
        track = replace(track, outcome=CRITICAL)
    elif left <= LEFT:
        track = replace(track, outcome=CRITICAL, bracket=max(track.bracket, 2.0 * left))
    elif friction and goes_on(*end):
        track = replace(track, outcome=SLIDING)
    elif track.outcome == STUCK and abs(share) < SOFT:
        track = replace(track, outcome=CRITICAL)
    pull = body.pull(track.last, track.history) if prescribed.size else load
    norm = float(np.linalg.norm(pull) * np.linalg.norm(mode))
    return track, mode, abs(float(pull @ mode)) / norm if norm > 0.0 else 0.0


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
        time=(len(runs) - 1 + last.time) / count,
        bracket=last.bracket / count,
        checks=sum(track.checks for track in tracks),
        pairs=sum(track.pairs for track in tracks),
        snaps=sum(track.snaps for track in tracks),
        largest_snap=max(track.largest_snap for track in tracks),
    )
    outcome, message, critical = _verdict(track, runs[-1].work)
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
    scene: Scene,
    model: str,
    options: Mapping[str, object],
    run: Run,
    shape: Shape,
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
        outcome=run.outcome,
        message=run.message + _snaps(track) + _caution(scene, shape, track.states),
        shape=shape,
        critical_time=run.critical_time,
        critical_bracket=None if run.critical_time is None else track.bracket,
        end_bracket=None if track.outcome == COMPLETED else (track.time, track.time + track.bracket),
        last_state=None if track.outcome == COMPLETED else track.last,
        total_iterations=run.spent,
        stability_checks=track.checks,
        pair_evaluations=track.pairs,
        residual_history=tuple(track.decrements[track.decrements > 0.0]),
        solve_seconds=run.solve_seconds,
        compile_seconds=run.compile_seconds,
    )
    if path.outcome != "completed":
        raise EquilibriumNotFound(path)
    return path


def _snaps(track: Track) -> str:
    """The limit points that the path passed, or nothing."""
    if track.snaps == 0:
        return ""
    points = "a limit point" if track.snaps == 1 else f"{track.snaps} limit points"
    return f"; on the way it snaps past {points}, by at most {track.largest_snap:.2g} wire diameters"


def _caution(scene: Scene, shape: Shape, states: np.ndarray) -> str:
    """What makes the last state an equilibrium of the model rather than of a spring, or nothing."""
    if not len(states):
        return ""
    last = states[-1:]
    depth = -shape.pair_gaps(last).min(initial=0.0) / scene.spring.wire_diameter
    if depth > VOID_PENETRATION:
        return f"; but coils penetrate by {depth:.2f} wire diameters: the contact stiffness is too low"
    if shape.tips(last)[0, 1] < -scene.spring.active_height:
        return "; but the top has passed the bottom, which no contact law here prevents"
    return ""


def _verdict(track: Track, work: float) -> tuple[str, str, float | None]:
    """Outcome, message and critical time."""
    if track.outcome == COMPLETED:
        return "completed", "the load path was followed to time 1", None
    begin, end = f"{track.time:.6f}", f"{track.time + track.bracket:.6f}"
    where = f"between time {begin} and {end}" if begin != end else f"at time {begin}"
    if track.outcome == OVERLAP:
        return "interpenetration", f"{THROUGH} {where}", None
    if track.outcome == JUMP:
        return "jump", f"{JUMPS} {where}", track.time
    if track.outcome == CRITICAL:
        critical = track.time + 0.5 * track.bracket
        if work > NO_WORK:
            return "limit_point", f"limit point {where}: beyond it this branch has no equilibrium", critical
        return "bifurcation", f"bifurcation {where}: the branch loses its stability", critical
    return "not_converged", f"{WHY.get(track.outcome, WHY[STUCK])} {where}", None
