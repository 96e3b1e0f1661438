"""Where a path loses its stability: the softest mode, and when its stiffness will have vanished."""

import math

import numpy as np

from coilspring.compiling.compiled import part
from coilspring.contact.history import has_friction
from coilspring.solver.continuation.branch import interpolate
from coilspring.solver.equilibrium.linesearch import dot
from coilspring.solver.equilibrium.newton import LINEAR
from coilspring.solver.equilibrium.operations import factor_state, solution

# Shares of stiffness are of the least one at rest; times are of 0..1.
FEW_ITERATIONS = 8  # steps of inverse iteration, at most
OTHERS = 0.05  # share of all modes that is put into the softest one before it is looked for anew
SETTLED = 0.05  # relative change of the stiffness that ends inverse iteration along the path
EXACT = 1e-3  # the change that ends it where the stiffness tends to zero
LEAST_STEP = 1e-9  # least substep, time: below it, what cannot be passed is called a critical point
FINEST = 1e-12  # time before a predicted zero of the stiffness up to which it is approached
# Share of the time so far up to which a zero on a straight line is approached, if that is more. Contact may
# make a bifurcation imperfect: the path leans just before it and goes on. Nearer it counts as perfect.
IMPERFECT = 1e-10
APPROACH = 0.5  # substep towards a predicted zero of the stiffness, as a share of the time to it
# Difference of two predicted zeros on a straight line, as a share of the time left and of the share by which
# the stiffness fell; towards a limit point it is about 1. And how far such a zero may move, as a share of the
# time left when it was found: just before zero, rounding moves it.
STRAIGHT = 0.02
WITHIN = (0.25, 0.5, 0.75)  # shares of the last substep's end at which a straight line is looked for
MOST_HALVES = 5  # times that this end is halved
STRAIGHTER = 0.1  # `STRAIGHT` there: the tangent's error bends a line a little, a limit point by 0.5 or more
LOOK = 0.05  # longest time between evaluations of the softest mode
SOONER = 0.25  # the longest as a share of the time to the predicted zero, if that is less
WEAK = 0.1  # share of stiffness below which it is evaluated wherever the matrix is factored
PROBE = 1e-3  # substep after which it is evaluated where a pair has closed, time
RIGID = 1e-3  # share of stiffness above which it does not tend to a predicted zero at hand, but jumps to it
SUDDEN_FALL = 5e-3  # share of stiffness above which what falls in no time jumps
SUDDEN = 2e-7  # what counts as no time, as a share of the time so far
FEW_STEPS = 5.0  # what counts as no time, if that is more, in `LEAST_STEP`
NEUTRAL = 1e-6  # share of stiffness that counts as none: rounding is not far below


@part
def least_stiffness(system, task, work, last, settled):
    """Stiffness, N/mm, of the softest mode by inverse iteration with the last factor, from `work.mode`, which
    is improved. Rotations are measured at the arm of a wire diameter.

    From state to state the mode changes little, so that a few steps are enough: one, where the stiffness is
    still about the `last` one. A share of all other modes is
    put in before, or one that has become the softest would be missed where symmetry hides it.
    """
    mode, new, arms = work.mode, work.step, task.arms
    for i in range(mode.size):
        mode[i] += OTHERS * (1.0 + i / mode.size) / (math.sqrt(mode.size) * arms[i])
    value = 0.0
    for _ in range(FEW_ITERATIONS):
        for i in range(mode.size):
            mode[i] *= arms[i] ** 2
        solution(system, work.F, mode, 1.0, new)
        square = 0.0
        for i in range(mode.size):
            square += (arms[i] * new[i]) ** 2
        value = dot(new, mode) / square
        size = math.sqrt(square)
        for i in range(mode.size):
            mode[i] = new[i] / size
        if abs(value - last) <= settled * abs(value):
            break
        last = value
    return value


@part
def begin_watch(softest, value, time):
    """Begin to watch the least stiffness anew, from a value at a time."""
    softest.value, softest.time, softest.linear = value, time, False
    softest.zero, softest.root, softest.ahead = np.inf, np.inf, np.inf
    softest.past, softest.past_time = value, -np.inf
    softest.mark, softest.mark_time = value, -np.inf


@part
def predicted_zero(time, value, before, value_before):
    """Time at which a stiffness that falls is zero on the straight line through two values; else infinite."""
    if value >= value_before:
        return np.inf
    return time + value * (time - before) / (value_before - value)


@part
def no_time(time):
    """Time within which what changes jumps, of the time 0..1."""
    return max(SUDDEN * time, FEW_STEPS * LEAST_STEP)


@part
def vanishes(system, task, work, path):
    """Whether the least stiffness tends to zero along a straight line, just ahead: at a bifurcation. Towards
    a limit point it falls as the root of the time that is left.

    Where much is left, or it fell so fast that the predictions on the way may be too few to tell, the last
    substep is looked at.
    """
    softest = path.softest
    # from the state before, by neither of these
    goes_on = path.release.last == 0.0 and path.snap.until < path.time
    if goes_on and not softest.linear and jumps(path, softest.value):
        zero = line_within(system, task, work, path)
        if 0.0 < zero - path.time <= no_time(path.time):
            softest.zero, softest.linear = zero, True
            softest.line, softest.reach = zero, zero - path.time
    return softest.linear and softest.zero - path.time <= no_time(path.time)


@part
def line_within(system, task, work, path):
    """Time at which the least stiffness is zero on the straight line through that of three states at the end
    of the last substep; infinite where it is on none. Where a pair opens on the way, the states are taken
    before.

    The states lie on a parabola: on the chord the stiffness is straight before a limit point, too.
    `work.predicted` is overwritten.
    """
    span, values, times = min(path.last_step, 0.5 * no_time(path.time)), np.empty(3), np.empty(3)
    begin = path.time - span
    for _ in range(MOST_HALVES):
        for i in range(3):
            times[i] = begin + WITHIN[i] * span
            interpolate(system, task, work, path, times[i])
            values[i] = stiffness_at(system, task, work, path, work.predicted, EXACT)
        if values[2] > 0.0:
            before = predicted_zero(times[1], values[1], times[0], values[0])
            zero = predicted_zero(times[2], values[2], times[1], values[1])
            fallen = 0.5 * (values[0] - values[2]) / values[2]
            if abs(zero - before) < STRAIGHTER * fallen * (zero - times[2]):
                return zero
        span *= 0.5
    return np.inf


@part
def stiffness_at(system, task, work, path, state, settled):
    """Least stiffness at a state, of which the matrix is factored anew."""
    factor_state(system, work, state, work.history)
    path.spent += 1
    return least_stiffness(system, task, work, np.inf, settled)


@part
def jumps(path, stiffness):
    """Whether the least stiffness, now of a value, does not tend to zero but jumps, as where a pair opens."""
    softest, least = path.softest, no_time(path.time)
    fallen = (softest.past - stiffness) / max((path.time - softest.past_time) / least, 1.0)
    if abs(path.time - softest.time) <= least:
        fallen = max(fallen, softest.value - stiffness)
    # a pair about to open may count as open, by rounding
    return stiffness > RIGID * path.scale.stiffness or fallen > SUDDEN_FALL * path.scale.stiffness


@part
def watch_stiffness(system, task, work, path, substep):
    """Evaluate the softest mode where little is left of its stiffness, and now and then; predict its zero.

    A pair that closes turns the slope of the stiffness, and steeply where a displacement is prescribed: it is
    evaluated there, and after a short step; and where substeps fail, perhaps since a critical point is near.
    """
    if path.release.active:
        path.fresh = 1
        return
    softest = path.softest
    first = substep.least_gap <= 0.0 < path.least_gap
    closing = (substep.shortened or first) and (substep.left < 1.0 or system.prescribed.size > 0)
    path.fresh = 1 if closing else max(path.fresh - 1, 0)
    due = softest.time + min(LOOK, SOONER * (softest.zero - softest.time))
    wanted = first or closing or substep.near_critical or path.failed
    if not wanted and (substep.status == LINEAR or not (substep.left < 1.0 or substep.target >= due)):
        return
    # the last factor may be of the predicted state; towards a zero it is to be that of the state itself
    near = substep.left < 1.0 and substep.near_critical
    if substep.iterations == 0 or near:
        factor_state(system, work, work.trial, work.trial_history)
        path.spent += 1
    value = least_stiffness(system, task, work, softest.value, EXACT if near else SETTLED)
    if value > NEUTRAL * path.scale.stiffness or value < softest.value:
        zero = predicted_zero(substep.target, value, softest.time, softest.value)
        other = path.snap.active or path.release.last > 0.0  # the state before is of another branch
        follow_root(softest, value, zero, substep.target)
        follow_line(softest, value, zero, substep.target)
        if other or has_friction(work.history):
            softest.ahead = zero  # with friction another determinant vanishes first, see `solver.coulomb`
        softest.linear = softest.linear and not other
    if value > RIGID * path.scale.stiffness and not softest.linear:
        doubt_zero(softest, substep.target)
    softest.value, softest.time, path.failed = value, substep.target, False
    if substep.target >= softest.mark_time + no_time(substep.target):
        softest.past, softest.past_time = softest.mark, softest.mark_time
        softest.mark, softest.mark_time = value, substep.target


@part
def doubt_zero(softest, time):
    """Where much is left of the stiffness just before its zero, on no straight line: it may fall so fast that
    one prediction is too few, and the farther one is approached; or it jumps, as where a pair opens."""
    if APPROACH * (softest.ahead - time) < FINEST:
        softest.ahead = softest.zero
    if APPROACH * (softest.zero - time) < FINEST:
        softest.zero, softest.ahead = np.inf, np.inf


@part
def follow_root(softest, value, zero, time):
    """Predict the zero of what falls as the root of the time that is left, as towards a limit point: on the
    straight line through the squares. It is approached, unless the `zero` of the straight line through the
    values changes less."""
    if zero == np.inf:
        softest.root, softest.ahead = zero, zero
        return
    root = time + (zero - time) * value / (value + max(softest.value, 0.0))
    softest.ahead = zero if abs(zero - softest.zero) < abs(root - softest.root) else root
    softest.root = root


@part
def follow_line(softest, value, zero, time):
    """Take a new prediction of the zero, from a value at a time, and note whether it is on a straight line
    with the one before, or still where such a line was found to end."""
    left, off = zero - time, abs(zero - softest.line)
    straight = abs(zero - softest.zero) < STRAIGHT * (1.0 - value / softest.value) * left
    kept = softest.linear and off < min(STRAIGHT * softest.reach, no_time(time))
    if straight and not kept:
        softest.line, softest.reach = zero, left
    softest.zero, softest.linear = zero, straight or kept
