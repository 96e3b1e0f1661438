"""How a trial state, and what its pairs do, answer to a small change of what they hold."""

import numpy as np

from coilspring.compiling.compiled import part
from coilspring.contact.history import copy_history
from coilspring.solver.equilibrium.linesearch import subtract
from coilspring.solver.equilibrium.operations import assembled, moved, solution

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


@part
def derivatives(system, work, share, pairs, change):
    """Fill the derivatives, along the motion `work.ahead`, of the gaps of some pairs and of the forces with
    which they would stick: (2, pairs).

    The gaps' by central differences: they change with the square of a motion along the wire, too, and hard
    pairs that are pressed have gaps no larger than that. What would stick is stretched by far less than the
    motion where it is hard: its derivative is that of the side on which the stretch grows.
    """
    answered(system, work, share)
    for q in range(pairs.size):
        there = work.high[pairs[q]]
        change[0, q], change[1, q] = there.gap, there.sticking
    answered(system, work, -share)
    for q in range(pairs.size):
        there, sticking = work.high[pairs[q]], work.history[pairs[q]].sticking
        change[0, q] = (change[0, q] - there.gap) / (2.0 * share)
        grows = change[1, q] >= there.sticking
        change[1, q] = (change[1, q] - sticking if grows else sticking - there.sticking) / share
