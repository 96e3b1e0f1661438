"""Linear stretches: substeps that factor nothing, and are verified together where they end.

A stretch ends where a substep is not linear, fails, or is a release, and where the path ends. Its states are
on one line, on which its stability is sampled.
"""

import numpy as np

from coilspring.compiling.compiled import part
from coilspring.contact.history import begin_attempt, copy_history, sticks
from coilspring.solver.continuation.snap import end_or_snap, is_loaded, snap_or_end
from coilspring.solver.continuation.stability import (
    LEAST_STEP,
    RIGID,
    SETTLED,
    begin_watch,
    no_time,
    stiffness_at,
)
from coilspring.solver.equilibrium.operations import assembled, factored, moved, put_prescribed
from coilspring.solver.system import COMPLETED, CRITICAL

SAMPLES = 16  # of a linear stretch at which its stability is verified


@part
def unstable_time(system, work, history, begin, end, least_gap):
    """First time of a linear stretch at which the matrix has a negative pivot.

    Along the stretch the state is `work.origin` moved by ``(time - begin) * work.tangent``; it is sampled at
    `SAMPLES` times and bisected. `least_gap` is that of the origin: 0 where pairs touch, infinite where none
    does before the end. Returns the time before the sign change (infinite where every
    sample is stable) and the number of factorisations.
    """
    low, high, time = begin, np.inf, begin
    count = 0
    while high - low > LEAST_STEP:
        time = 0.5 * (low + high) if high < np.inf else min(low + (end - begin) / SAMPLES, end)
        moved(system, work.origin, work.tangent, time - begin, work.scratch)
        assembled(system, work.scratch, least_gap, history, work.scratch, work.g, work.H)
        count += 1
        if factored(system, work.H)[0] > 0:
            high = time
        elif time == end:
            return np.inf, count
        else:
            low = time
    return low, count


@part
def leaves_stretch(system, task, work, path, end):
    """End the linear stretch that led here, if one did: whether it is stable up to the time `end`. Else the
    path goes back to where it ceases to be, and ends there, or snaps."""
    if not path.stretch.active or end < path.stretch.begin:
        path.stretch.active = False
        return True
    path.stretch.active, history = False, work.low
    copy_history(work.history, history)
    begin_attempt(history, 0.0, 0.0, True)  # what a substep beyond made of it is taken back
    wide = path.least_gap > 0.0
    critical, count = unstable_time(system, work, history, path.stretch.begin, end, np.inf if wide else 0.0)
    path.checks += count
    if critical == np.inf:
        return True
    copy_history(history, work.history)
    go_back(system, task, work, path, critical)
    softest = path.softest
    if softest.linear and abs(softest.zero - critical) <= no_time(critical):
        end_or_snap(system, task, work, path, CRITICAL)
        return False
    stiffness = stiffness_at(system, task, work, path, work.state, SETTLED)
    begin_watch(softest, stiffness, critical)
    # all states of the stretch are on one line: that the stiffness falls along one tells nothing
    opens = stiffness > RIGID * path.scale.stiffness
    limit = opens or is_loaded(system, task, work, path, stiffness)
    path.snap.opened = opens and sticks(work.history)
    snap_or_end(task, path, limit, True)
    return False


@part
def go_back(system, task, work, path, time):
    """Put the path to a time on the stretch, and forget what lies beyond."""
    moved(system, work.origin, work.tangent, time - path.stretch.begin, work.state)
    put_prescribed(system, task.start, time, work.state)
    path.time, path.bracket, path.until, path.opens = time, LEAST_STEP, np.inf, np.inf
    # pairs may be nearer than where it was found, and wires than where they were looked at last
    path.least_gap, path.room.moved = min(path.least_gap, 0.0), np.inf
    path.outcome, path.snap.ends = COMPLETED, CRITICAL
    path.release.active, path.due, path.reuse = False, False, False
    while path.row > 0 and task.times[path.row - 1] > time:
        path.row -= 1
        path.spent += work.iterations[path.row]
