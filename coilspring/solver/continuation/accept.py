"""A substep that is accepted: where the path stands then, its tangent, and the length of the next substep."""

import math

import numpy as np

from coilspring.compiling.compiled import copy, part
from coilspring.contact.history import (
    copy_history,
    grazing,
    has_friction,
    largest_slip,
    opening,
    release_further,
    set_rise,
    touched_first,
)
from coilspring.contact.rates import GAP_RATE
from coilspring.contact.transitions import OPEN
from coilspring.solver.continuation.branch import most_turn
from coilspring.solver.continuation.snap import count_snap, passes_snap, snapped
from coilspring.solver.continuation.stability import predicted_zero
from coilspring.solver.equilibrium.newton import CONVERGED
from coilspring.solver.tangential.grazing import grazing_tangent
from coilspring.solver.tangential.response import find_rates

SAFE = 0.8  # share of the turn allowed that the next substep aims at
# Iterations in the first round, and in each that follows: with fewer, the next substep may be longer.
EASY_COUNT, EASY_ROUND = 4, 8
GROWTH, SLOW_GROWTH = 2.0, 1.2  # of the substep; the slow one with friction, whose rounds may be many in any
LEAST_LEFT = 1e-6  # of the time 0..1 that is taken at least, however soon a pair closes or opens
NEAR_END = 1e-5  # of the time 0..1: what is unstable so near to where a path stands decides how it goes on
MOST_SLIP = 0.01  # wire diameters that a grazing pair is to slip in a substep


@part
def accept(system, task, work, path, substep):
    """Make the trial state the last accepted one."""
    room = path.room
    path.travel += substep.distance
    if substep.several or passes_turn(path, substep):
        path.undecided = min(path.undecided, path.time)
    if path.release.active:
        accept_release(task, work, path, substep)
    else:
        accept_step(system, task, work, path, substep)
    if substep.moved == 0.0:
        room.zero = predicted_zero(path.time, substep.room, room.time, room.value)
        room.time = path.time
    room.value, room.moved = substep.room, substep.moved
    copy(work.state, work.before)
    copy(work.trial, work.state)
    path.least_gap = substep.least_gap
    if path.friction.slid:
        set_rise(work.history, path.friction.rise)
    if not path.release.active and opening(work.history):
        path.release.active, path.release.power = True, np.inf
    if path.due and not path.release.active:
        copy(work.state, work.states[path.row])
        copy_history(work.trial_history, work.histories[path.row])
        work.iterations[path.row], work.least_gaps[path.row] = path.spent, path.least_gap
        path.spent, path.due = 0, False
        path.row += 1


@part
def passes_turn(path, substep):
    """Whether a path with friction goes on past states just ahead that Coulomb's law made unstable: which of
    its pairs slide there, the length of a substep decides."""
    return path.time <= path.friction.turned < substep.target and path.friction.turned - path.time <= NEAR_END


@part
def accept_step(system, task, work, path, substep):
    """Go on in time, with a step as long as the path's curvature lets the next one be."""
    copy(work.tangent, work.old)
    if substep.status == CONVERGED:
        copy(work.ahead, work.tangent)
        if grazing(work.history):
            path.spent += grazing_tangent(system, task, work)
    if path.snap.active:
        snapped(task, work, path, substep)
    elif passes_snap(system, task, work, path, substep):
        count_snap(task, work, path, substep)
    path.reuse, path.last_step, path.time = True, substep.duration, substep.target
    path.error, path.release.last = substep.error, 0.0
    path.due = substep.landing
    fresh = touched_first(work.trial_history)
    if path.until < np.inf and fresh.size == 0 and not opening(work.history):
        path.next_step = substep.duration  # what is looked for is still ahead
    left = path.opens - substep.duration  # another substep ended first
    path.until, path.opens = np.inf, left if left > LEAST_LEFT else np.inf
    if fresh.size > 0 and not has_friction(work.history):
        path.opens = min(path.opens, opens_again(system, task, work, fresh))
    easy = substep.iterations < EASY_COUNT + EASY_ROUND * (substep.rounds - 1) or grazing(work.history)
    growth = GROWTH if easy else SLOW_GROWTH if substep.rounds > 1 else 1.0
    # the turn grows with the square of the step
    if substep.share > 0.0:
        growth = min(growth, math.sqrt(SAFE * most_turn(work.history) / substep.share))
    path.next_step = max(path.next_step, substep.duration * growth)
    slip = largest_slip(work.history)
    if slip > 0.0:
        path.next_step = min(path.next_step, substep.duration * MOST_SLIP * task.diameter / slip)


@part
def opens_again(system, task, work, fresh):
    """Time, along the tangent, after which one of the sticking pairs opens that touched first in the substep
    at hand; infinite where none does. It may be pressed again at the end of a longer substep."""
    history, until = work.history, np.inf
    rates = np.empty((history.shape[0], 2))
    copy_history(history, work.low)
    copy(work.tangent, work.ahead)
    find_rates(system, work, rates)
    for p in range(fresh.size):
        row, rate = history[fresh[p]], rates[fresh[p], GAP_RATE]
        if row.closed and rate > 0.0:
            until = min(until, max(OPEN * task.diameter - row.gap, 0.0) / rate)
    return max(until, LEAST_LEFT)


@part
def accept_release(task, work, path, substep):
    """What opening pairs held is released, or some of it: the tangent is another one now."""
    if path.snap.active:
        snapped(task, work, path, substep)
    copy(work.ahead, work.tangent)
    if path.time <= path.release.gradual:
        # that they graze leads nowhere from here: how much of it a release leaves, rounding may decide
        release_further(work.history, path.scale.pressed * task.diameter)
    path.release.active, path.release.last = opening(work.history), path.release.power
    path.release.power *= 2.0
    path.error /= path.last_step**2  # as of a step of length 1, along a straight line
    path.reuse, path.last_step, work.old[0] = True, 1.0, np.inf  # no turn known
    path.opens = np.inf  # what was to open has opened
