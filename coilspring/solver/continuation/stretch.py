"""Linear stretches: substeps that factor nothing, and are verified together where they end."""

import numpy as np

from coilspring.compiling.compiled import part
from coilspring.solver.continuation.stability import LEAST_STEP
from coilspring.solver.equilibrium.operations import assembled, factored, moved

SAMPLES = 16  # of a linear stretch at which its stability is verified


@part
def unstable_time(system, work, begin, end, least_gap):
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
        assembled(system, work.scratch, least_gap, work.history, work.scratch, work.g, work.H)
        count += 1
        if factored(system, work.H)[0] > 0:
            high = time
        elif time == end:
            return np.inf, count
        else:
            low = time
    return low, count


@part
def stable_until(system, task, work, path, end, least_gap):
    """Whether the linear stretch is stable up to the time `end`; else the path goes back to where it is."""
    critical, count = unstable_time(system, work, path.linear_from, end, least_gap)
    path.checks += count
    if critical == np.inf:
        return True
    moved(system, work.origin, work.tangent, critical - path.linear_from, work.state)
    path.time, path.bracket = critical, LEAST_STEP
    while path.row > 0 and task.times[path.row - 1] > critical:
        path.row -= 1
    return False
