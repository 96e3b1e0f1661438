"""Small snaps: past a limit point, to a stable equilibrium nearby.

Coils touch at points, be they of spheres or stations of the wire. As one opens and the next closes, a path
may fold by hundredths of a wire diameter. Which of these folds a substep sees is a matter of its length; what
lies beyond is not. So a path that comes to one goes on from the equilibrium beyond, where no point of the
wire moves far; it counts those snaps, and tells the largest. So it does with those within a substep, which
moves farther then than the tangents at both of its ends tell.
"""

import math

import numpy as np

from coilspring.compiling.compiled import copy, part
from coilspring.contact.history import has_history, sticks
from coilspring.solver.continuation.branch import displacement_bound
from coilspring.solver.continuation.stability import (
    FINEST,
    LEAST_STEP,
    PROBE,
    RIGID,
    SETTLED,
    jumps,
    least_stiffness,
    stiffness_at,
    vanishes,
)
from coilspring.solver.equilibrium.linesearch import dot
from coilspring.solver.equilibrium.operations import moved, solution
from coilspring.solver.system import CRITICAL, JUMP

AHEAD = 1e-6  # of the time 0..1: so far beyond a limit point an equilibrium is looked for
NO_TIME = 2.0 * AHEAD
LARGEST = 0.25  # wire diameters: so far it may be
ROUNDS = 100  # of renewed bounds: as it slides, friction gives way step by step
LONGER = 5  # times as many iterations as of a substep: hard pairs close and open all the way
SHIFT = 1e-6  # least shift of an indefinite matrix: at a limit point next to nothing is negative
SADDLES, LEAVE = 3, 1e-3  # times that an unstable equilibrium is left, and wire diameters by which at first
ALONG_MODE = 1e-3  # move along a mode, wire diameters
FASTER = 2.0  # times what the tangents tell, at least, a substep moves in which it snapped
# Wire diameters, and share of the path so far: by less off the prediction is no snap; after one that is
# larger, friction may hold otherwise.
LEAST_TOLD, SHARE_TOLD = 2e-3, 5e-3
NO_WORK = 1e-4  # of the load times a mode's largest motion: less work is a bifurcation that is not quite one


@part
def end_or_snap(system, task, work, path, outcome):
    """The path ends with an outcome, unless at a limit point: there a snap is tried first."""
    path.snap.ends, straight = outcome, vanishes(system, task, work, path)
    if straight:
        path.snap.ends, path.bracket = CRITICAL, 2.0 * max(path.softest.zero - path.time, FINEST)
    stiffness = stiffness_at(system, task, work, path, work.state, SETTLED)
    path.reuse, opens = False, not straight and jumps(path, stiffness)
    limit = opens or is_limit_point(system, task, work, path, stiffness, straight)
    path.snap.opened = opens and stiffness > RIGID * path.scale.stiffness and sticks(work.history)
    snap_or_end(task, path, limit, straight)


@part
def snap_or_end(task, path, limit, straight):
    """A snap at a limit point, else the end; at a bifurcation the stiffness falls along a `straight` line."""
    path.snap.bifurcates = straight and not limit
    path.snap.active = task.predictor and limit
    if not path.snap.active:
        path.outcome = path.snap.ends


@part
def leave_saddle(system, task, work):
    """Move the trial state off an unstable equilibrium, with `work.F` the factor of its matrix made positive:
    along its softest mode, the way the path came."""
    least_stiffness(system, task, work, np.inf, SETTLED)
    size = LEAVE * task.diameter
    size = size if along(task, work.mode, work.tangent) >= 0.0 else -size
    moved(system, work.trial, work.mode, size, work.scratch)
    copy(work.scratch, work.trial)


@part
def release_or_jump(task, path):
    """All that opening pairs hold is released at once, to an equilibrium nearby, or the path jumps; it does
    where that was done just before."""
    path.snap.active, path.snap.ends = task.predictor and path.time > path.release.sudden, JUMP
    path.release.power = np.inf
    path.release.sudden = path.time + LEAST_STEP
    if not path.snap.active:
        path.outcome = JUMP


@part
def is_limit_point(system, task, work, path, stiffness, straight):
    """Whether the load works on the softest mode, of a stiffness; a prescribed motion counts only off a
    `straight` line."""
    # a prescribed motion works on a state that leans by rounding as well, but along a straight line
    return not (straight and system.prescribed.size > 0) and is_loaded(system, task, work, path, stiffness)


@part
def is_loaded(system, task, work, path, stiffness):
    """Whether the load, or a prescribed motion, works on the softest mode, of a stiffness."""
    if system.prescribed.size > 0:
        return driven(system, task, work, stiffness, path.scale.stiffness)
    moved(system, work.state, work.mode, ALONG_MODE * task.diameter, work.scratch)
    work_done = system.work(system.reals, system.ints, task.load, work.state, work.scratch)
    distance, _, _ = displacement_bound(system, work.state, work.scratch, np.inf)
    return abs(work_done) > NO_WORK * math.sqrt(dot(task.load, task.load)) * distance


@part
def driven(system, task, work, stiffness, rest):
    """Whether a prescribed motion works on the softest mode: by that mode's part of the path's tangent, times
    its stiffness."""
    solution(system, work.F, task.load, 1.0, work.step)
    part, square = along(task, work.mode, work.step), along(task, work.step, work.step)
    return abs(stiffness * part) > NO_WORK * rest * math.sqrt(max(square - part**2, 0.0))


@part
def along(task, a, b):
    """Scalar product of two motions, rotations measured at the arm of a wire diameter."""
    total = 0.0
    for i in range(a.size):
        total += task.arms[i] ** 2 * a[i] * b[i]
    return total


@part
def snapped(task, work, path, substep):
    """Go on from where a snap led as from a start."""
    count_snap(task, work, path, substep)
    path.snap.active, path.next_step, work.old[0] = False, PROBE, np.inf  # no turn known


@part
def count_snap(task, work, path, substep):
    """Count a snap in the substep from the path's time on, or the last one's going on; what remembers where
    it slid may be held otherwise beyond."""
    size = substep.distance / task.diameter
    if path.time > path.snap.until:
        path.snap.count, path.snap.size = path.snap.count + 1, 0.0
    path.snap.size, path.snap.until = path.snap.size + size, substep.target
    path.snap.largest = max(path.snap.largest, path.snap.size)
    if substep.distance > least_told(task, path) and has_history(work.history):
        path.undecided = min(path.undecided, path.time)


@part
def least_told(task, path):
    """Motion, mm, from which on a snap changes the answer: of a stack of coils that touch all of it may be as
    small."""
    return min(LEAST_TOLD * task.diameter, SHARE_TOLD * path.travel)


@part
def passes_snap(system, task, work, path, substep):
    """Whether a substep moved much farther than the tangents tell, `work.old` at its begin and `work.tangent`
    at its end: past a limit point, or as pairs began to slide."""
    if substep.turn <= least_told(task, path):
        return False
    most = 0.0
    for tangent in (work.old, work.tangent):
        moved(system, work.state, tangent, substep.duration, work.scratch)
        distance, _, _ = displacement_bound(system, work.state, work.scratch, np.inf)
        most = max(most, distance)
    return substep.distance > FASTER * most
