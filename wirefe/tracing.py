"""The path past its limit points, by arc-length continuation, for a scene and for any wire."""

import math
import time
from dataclasses import replace
from operator import add
from typing import NamedTuple

import numpy as np

from coilspring.compiling.packing import pack
from coilspring.contact.kinematics import OVERLAP_ALLOWED
from coilspring.errors import EquilibriumNotFound, InputError, require_integer
from coilspring.path import EquilibriumPath
from coilspring.scene import Scene, require_scene
from coilspring.solver.cautions import warning
from coilspring.solver.continuation.arclength import Trace, compiled_trace
from coilspring.solver.interface import Kernels
from coilspring.solver.interrupt import interruptible
from coilspring.solver.outcome import THROUGH
from coilspring.solver.problem import Problem
from coilspring.solver.startup import kernel_bundle
from coilspring.solver.system import Data
from wirefe.mesh import chord_warning
from wirefe.results.shape import WireShape
from wirefe.rod import Rod, RodPath
from wirefe.solve import KERNELS, rod_problem, scene_kernels, scene_problem


class Cost(NamedTuple):
    """What tracing took, by the names that an `EquilibriumPath` has for it."""

    total_iterations: int = 0
    pair_evaluations: int = 0
    solve_seconds: float = 0.0
    compile_seconds: float = 0.0


def trace(
    scene: Scene,
    *,
    points: int = 200,
    penalty: float | None = None,
    geometry: str | None = None,
    element: str = "straight",
    elements_per_turn: int = 40,
    pairs_per_turn: int | None = None,
) -> EquilibriumPath:
    """Trace the equilibrium path of `scene` through its limit points.

    Parameters are those of `wirefe.solve`, but for `points`: the largest number of points, spaced by
    arc length. The path ends there, or at the first point at time 1 or beyond it.

    Returns
    -------
    EquilibriumPath
        `times` rise and fall; `negative_pivots` is 0 where a point is stable. Equilibria of the model are
        traced even where wires pass through each other: `max_overlap` and the message say so.

    Raises
    ------
    InputError : bad input, in one sentence.
    EquilibriumNotFound : the arc shrank to nothing before; carries what was reached.
    """
    require_integer("points", points, 1, 100_000)
    scene = require_scene(scene).overridden(penalty=penalty, geometry=geometry)
    if scene.contact.enabled and scene.contact.sliding != "free":
        raise InputError(
            "contact.sliding must be free for trace: what coils hold tangentially depends on the path, "
            f"got {scene.contact.sliding!r}"
        )
    if scene.load.stages or scene.load.displacement:
        raise InputError("load must be one force for trace, got stages or a displacement")
    problem, mesh, options = scene_problem(scene, element, elements_per_turn, pairs_per_turn)
    known, cost = len(problem.history), Cost()
    while True:
        found, more = _run(problem, scene_kernels(scene), points)
        cost = Cost(*map(add, cost, more))
        if not found.new_pair or problem.extended is None:
            break
        problem = problem.extended(found.states[-1])
    options["pairs_found"] = len(problem.history) - known
    outcome, message = _verdict(found)
    message += chord_warning(element, elements_per_turn, scene.material.nu)
    shape = WireShape(scene, problem.data, mesh)
    path = EquilibriumPath(
        scene=scene,
        model="wirefe",
        options=options | {"continuation": "arc-length", "points": points},
        times=found.times,
        states=found.states,
        iterations=found.iterations,
        least_gaps=shape.pair_gaps(found.states).min(axis=1, initial=np.inf),
        shape=shape,
        negative_pivots=found.negative,
        outcome=outcome,
        message=message,
        **cost._asdict(),
    )
    path = replace(path, message=message + _through(path) + warning(path))
    if not found.finished:
        raise EquilibriumNotFound(path)
    return path


def _through(path: EquilibriumPath) -> str:
    """From where on coils have passed through each other, or nothing."""
    if not path.scene.contact.enabled:
        return ""
    most = OVERLAP_ALLOWED * path.scene.spring.wire_diameter
    through = np.flatnonzero(path.max_overlap - path.max_penetration > most)
    if not through.size:
        return ""
    return f"; but from point {through[0] + 1} on, at time {path.times[through[0]]:.6f}, {THROUGH}"


def trace_rod(rod: Rod, *, points: int = 200) -> RodPath:
    """Trace the path of any wire through its limit points; see `trace`."""
    require_integer("points", points, 1, 100_000)
    found, cost = _run(rod_problem(rod), KERNELS, points)
    outcome, message = _verdict(found)
    path = RodPath.of(
        rod,
        found.states,
        times=found.times,
        iterations=found.iterations,
        negative_pivots=found.negative,
        critical_time=None,
        residual_history=(),
        solve_seconds=cost.solve_seconds,
        outcome=outcome,
        message=message,
    ).doubted()
    if not found.finished:
        raise EquilibriumNotFound(path)
    return path


def _run(problem: Problem, kernels: Kernels, points: int) -> tuple[Trace, Cost]:
    began = time.perf_counter()
    follow, bundle = compiled_trace(), kernel_bundle(kernels)
    compiling = time.perf_counter() - began
    began = time.process_time()
    data, history = Data(*pack(problem.data), problem.prescribed), problem.history.copy()
    asked = (problem.load, points, problem.start, history, problem.matrix_size)
    found = Trace(*interruptible(follow, data, bundle, *asked))
    solving = time.process_time() - began
    return found, Cost(int(found.iterations.sum()), found.pairs, solving, compiling)


def _verdict(found: Trace) -> tuple[str, str]:
    """Outcome and message."""
    count = len(found.times)
    last = f"{found.times[-1]:.6f}" if count else "0"
    passed = ""
    if found.bifurcation < math.inf:
        before = f"; before time {found.bifurcation:.6f}"
        passed = f"{before} another path branches off (bifurcation), which is not taken"
    if not found.finished:
        said = f"the path could not be traced beyond point {count}, at time {last}"
        return "not_converged", said + passed
    short = "" if count and found.times[-1] >= 1.0 else ": all that were asked for, before time 1"
    return "completed", f"{count} points were traced, to time {last}{short}{passed}"
