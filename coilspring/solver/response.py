"""How a trial state, and what its pairs do, answer to a small change of what they hold."""

import numpy as np

from coilspring.compiling.compiled import part
from coilspring.contact.history import copy_history
from coilspring.solver.linesearch import subtract
from coilspring.solver.operations import assembled, moved, solution

NEARBY = 1e-5  # wire diameters of motion over which gaps are differentiated


@part
def answer(system, task, work):
    """Motion `work.ahead` by which the trial state answers to the bounds in `work.high`, after those in
    `work.low`; returns the share of it over which what pairs do is nearly linear.

    `work.F` is the factor at the trial state with `work.low`, and `work.g` its gradient.
    """
    step = work.step
    assembled(system, work.trial, 0.0, work.high, work.trial, step, work.F[:0])
    subtract(work.g, step)
    solution(system, work.F, step, -1.0, work.ahead)
    return nearby(system, task, work)


@part
def nearby(system, task, work):
    """Share of the motion `work.ahead` from the trial state over which what pairs do is nearly linear."""
    there = work.scratch
    moved(system, work.trial, work.ahead, 1.0, there)
    distance, _, _ = system.displacement_bound(system.reals, system.ints, work.trial, there, np.inf)
    return NEARBY * task.diameter / distance if distance > 0.0 else 1.0


@part
def answered(system, work, share):
    """What pairs do, in `work.high`, after a share of the motion `work.ahead`."""
    there = work.scratch
    moved(system, work.trial, work.ahead, share, there)
    copy_history(work.low, work.high)
    system.update_pairs(system.reals, system.ints, there, there, there, work.high)
