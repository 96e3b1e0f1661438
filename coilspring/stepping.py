"""Load path of a model: adaptive substeps that land on the requested times and keep the branch."""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import lru_cache
from typing import NamedTuple

import numpy as np
from numba import types

from coilspring.boundrise import rise_of_bounds
from coilspring.branch import TURN, continues, curvature, predict, snapped
from coilspring.compiled import copied, copied_table, copy, copy_table, part, signed, zeros
from coilspring.contactmemory import let_rise, relax, released, remembers, rubs, slides
from coilspring.kernelset import SIGNATURES
from coilspring.linesearch import solution, stale_solution
from coilspring.newton import CONVERGED, FAILED, HISTORY, INDEFINITE, LINEAR, NONE, equilibrium
from coilspring.pairvectors import OVERLAP_ALLOWED, TOUCH
from coilspring.stability import LEAST_STEP, least_stiffness, predicted_zero, unstable_time

COMPLETED, CRITICAL, STUCK, STRAY, OPENED, OVERLAP, EXHAUSTED = 0, 1, 2, 3, 4, 5, 6

FIRST_STEP = 0.1  # largest first substep: the tangent at rest knows nothing of the contact to come
SETTLING = 1e-6  # of the time 0..1, in which what was held by a pair that opened finds its place
LEAST_FREE = 0.05  # share of a substep that is taken at least, however soon a pair closes
SAFE = 0.8  # share of the turn allowed that the next substep aims at
EASY_COUNT = 3
EPSILON = 2.0**-52
NEARER = 3.0  # times the bound on all motion: so much nearer may two wires come, also between nodes
OVERLAP_TIME = 1e-5  # of the time 0..1: so closely is it told where they do
# Share of the time to the predicted zero of the least stiffness: at a limit point, where it falls with
# the root of the time that is left, the straight line meets zero twice as far as the path goes.
APPROACH = 0.5
LOOK = 0.05  # of the time 0..1: so often at least the softest mode is looked at,
SOONER = 0.25  # and after this share of the time to its predicted zero
WEAK = 0.1  # of the least stiffness at rest: below, it is looked at wherever the matrix is factored,
PROBE = 1e-3  # and after so short a step where a pair has closed, since that turns its slope
NEUTRAL = 1e-6  # of the least stiffness at rest: what is left of it counts as none, rounding is not far below
BOUND_CHANGE = 1e-6  # of the bounds of tangential forces, over the largest, where they count as found
MOST_ROUNDS = 30
MOST_TRIES = 20_000  # equilibria besides those at requested times; far more than a path needs


class Track(NamedTuple):
    """What `follow` returns, in this order."""

    states: np.ndarray  # (reached, state size), at the requested times
    memories: np.ndarray  # (reached, pairs, m) contact memory with which they were found
    iterations: np.ndarray  # (reached,), factorisations since the previous row
    rest: int  # factorisations spent after the last row
    outcome: int
    time: float  # last accepted time
    bracket: float  # length of the time bracket of the critical point
    checks: int  # factorisations that only verified the stability of a linear stretch
    pairs: int  # contact pairs evaluated
    last: np.ndarray  # last accepted state
    memory: np.ndarray  # contact memory with which a step from there was tried
    history: np.ndarray  # last Newton decrements over the reference work


@part
def scales(load, tangent, start, prescribed):
    """Work of the whole load along the tangent at rest, and the rounding of its potential, the product
    of a force and of positions; of a prescribed displacement those of its reaction."""
    span, work, force = 0.0, 0.0, 0.0
    for i in range(start.size):
        span = max(span, abs(start[i]))
    for i in range(load.size):
        force += abs(load[i])
        if prescribed.size == 0:
            work += load[i] * tangent[i]
        elif load[i] != 0.0:
            # the load that fixes the top less the tangent's last digits, in which the reaction is
            work += load[i] * (prescribed[1] - tangent[i])
    if prescribed.size > 0:
        force = abs(work / prescribed[1])
    return work, 2.0 * EPSILON * span * force


@part
def put_prescribed(prescribed, start, time, state):
    """Put what moves as prescribed to where it is at a time."""
    if prescribed.size > 0:
        place = int(prescribed[0])
        state[place] = start[place] + time * prescribed[1]


def follow(
    reals,
    ints,
    load,
    times,
    start,
    memory,
    size,
    diameter,
    limit,
    predictor,
    lean,
    prescribed,
    assemble,
    factor,
    solve,
    retract,
    work,
    carry,
    motion,
    commit,
    renew,
    overlap,
    stop,
):
    """Follow the equilibrium from rest through the increasing `times`.

    Parameters
    ----------
    reals, ints : data of the model, see `coilspring.packing`.
    load : (n,) dead load at time 1, conjugate to the steps that `retract` takes.
    times : (steps,) requested times.
    start : state at rest.
    memory : (pairs, m) contact memory at rest; its copy is changed with accepted states only, but for the
        bounds of tangential forces, which are renewed until they are those of the normal forces.
    size : length of the model's matrix in its own storage.
    diameter : wire diameter, mm: the length with which moves are compared.
    limit : largest number of iterations of a substep.
    predictor : the model's matrix is its tangent: start from its prediction and judge the branch by it;
        else from the last state, as the paper did.
    lean : the matrix is costly: it is left out where it is not factored, and its factor is kept longer.
    prescribed : place in the state of what moves as prescribed, and its change by time 1; or empty. With it
        `load` is the one that gives the tangent, see `coilspring.driving`.
    assemble, factor, solve, retract, work, carry, motion,
        commit, renew, overlap : kernels, see `coilspring.kernelset`.
    stop : one integer; another thread sets it to end the path at the next substep.
    """
    states = np.empty((times.size, start.size))
    memories = np.empty((times.size, memory.shape[0], memory.shape[1]))
    iterations, history, spent = np.empty(times.size, np.int64), zeros(HISTORY), 1
    g, push = zeros(load.size), zeros(load.size)
    H = zeros(size)
    F, home = zeros(size), copied(start)  # the last factor, and its state
    state, trial, predicted = copied(start), copied(start), copied(start)
    tangent, ahead = zeros(load.size), zeros(load.size)
    # the state accepted before, the tangent there and the time since: none as yet
    before, old, last = copied(start), zeros(load.size), 1.0
    old[0] = np.inf
    memory, held, far = copied_table(memory), copied_table(memory), copied_table(memory)
    left = zeros(memory.shape[0])
    clearance = commit(reals, ints, state, memory)
    _, pairs = assemble(reals, ints, state, clearance, memory, state, g, H)
    rest = copied(H)
    copy(H, F)
    negative, least = factor(reals, ints, F)
    outcome = COMPLETED if negative == 0 else CRITICAL
    solution(reals, ints, F, load, 1.0, tangent, solve)
    reference, noise = scales(load, tangent, start, prescribed)
    origin, begin = copied(state), 0.0  # of the linear stretch whose stability is not yet verified
    mode = zeros(load.size)
    softness = least_stiffness(reals, ints, F, mode, ahead, solve)
    at_rest = softness
    looked_at, zero = 0.0, np.inf  # when the softest mode was last looked at, and its predicted zero
    closed = False  # whether the last step led to where a pair closes
    linear, kept, ease, lost, slid = False, True, np.inf, False, False
    checks, critical = 0, np.inf
    time, dt = 0.0, min(times[0], FIRST_STEP)
    if clearance <= TOUCH * diameter:
        # what touches at rest is no part of the tangent, nor of the stiffness
        dt, closed = min(dt, PROBE), True
    row, tries, stride, rise = 0, 0, dt, 0.0
    most = OVERLAP_ALLOWED * diameter
    # how much nearer wires may come, and the bound on all motion since that was measured
    room, moved = np.inf, 0.0
    measured, through = 0.0, np.inf  # when, and when it is predicted to be used up
    if memory.shape[0] > 0:
        room = most - overlap(reals, ints, state)[1]
    while row < times.size and outcome == COMPLETED and stop[0] == 0:
        if clearance == -np.inf:
            outcome = STRAY
            break
        if tries > MOST_TRIES + row:
            outcome = EXHAUSTED
            break
        weak = softness < WEAK * at_rest
        probed = weak and closed
        approached = probed or APPROACH * (zero - time) < min(dt, ease)
        closing = max(APPROACH * (through - time), OVERLAP_TIME)
        stride = min(dt, ease, APPROACH * (zero - time), closing, PROBE if probed else np.inf)
        shortened = False
        if softness <= NEUTRAL * at_rest or APPROACH * (zero - time) < LEAST_STEP:
            outcome, stride = CRITICAL, max(zero - time, LEAST_STEP)
            break
        landing = times[row] - time <= stride * (1.0 + 1e-9)
        target = times[row] if landing else time + stride
        step = target - time
        copy(state, predicted)
        if predictor:
            bend = curvature(tangent, old, last, step)
            predict(reals, ints, before, state, tangent, last, step, bend, predicted, retract)
            put_prescribed(prescribed, start, target, predicted)
            # to where a pair is about to close: its stiffness is not in the tangent
            _, _, free = motion(reals, ints, state, predicted, 0.5 * clearance)
            if free < 1.0:
                shortened = True
                step *= max(free, LEAST_FREE)
                landing = False
                target = time + step
                predict(reals, ints, before, state, tangent, last, step, bend, predicted, retract)
                put_prescribed(prescribed, start, target, predicted)
        # where friction has just begun it holds next to nothing: the prediction slides where the state sticks
        copy(state if lost and rubs(memory) else predicted, trial)
        for i in range(load.size):
            push[i] = target * load[i] if prescribed.size == 0 else 0.0
        put_prescribed(prescribed, start, target, trial)
        renew(reals, ints, state, memory)
        rounds, needed, trouble, share_made = 0, 0, NONE, 0.0
        while True:
            status, count, more, looked = equilibrium(
                reals, ints, state, clearance, memory, push, reference * target**2, reference * step**2,
                noise * target, limit, trial, g, H, lean, rest, least, F, home, kept, history, assemble,
                factor, solve, retract, work, carry,
            )  # fmt: skip
            spent += count
            needed += count
            pairs += looked
            trouble = max(trouble, more)
            if status == LINEAR and rounds > 0:
                status = CONVERGED
            rounds += 1
            tries += 1
            copy_table(memory, held)  # with the bounds that this state was found with
            if status > LINEAR or renew(reals, ints, trial, memory) <= BOUND_CHANGE:
                break
            if rounds == MOST_ROUNDS:
                status = FAILED
                break
            share_made = relax(held, memory, left, share_made)
            kept = True
        put_prescribed(prescribed, start, target, trial)
        lost = status > LINEAR
        good, share, way = not lost, 0.0, 0.0
        if good:
            good, share, way = continues(
                reals, ints, predicted, state, trial, diameter, trouble > NONE, predictor and ease == np.inf,
                motion,
            )  # fmt: skip
        nearer, since = room, moved + way
        if good and (NEARER * since >= room or stride == closing):
            nearer, since = most - overlap(reals, ints, trial)[1], 0.0
            good = nearer >= 0.0
            if not good and step < OVERLAP_TIME:
                outcome = OVERLAP
                break
        if good and status == CONVERGED and clearance > 0.0:
            closes = commit(reals, ints, trial, memory) <= 0.0
            copy_table(held, memory)
            if closes:
                # the contact may hide that the open spring has become unstable on the way
                assemble(reals, ints, state, np.inf, memory, trial, g, H)
                negative, _ = factor(reals, ints, H)
                checks += 1
                good = negative == 0
        if good and status == CONVERGED and slides(memory):
            slid = True
            # the matrix at the state itself, which also tells how the bounds rise with the slips
            assemble(reals, ints, state, clearance, held, trial, g, F)
            copy(trial, home)
            negative, _ = factor(reals, ints, F)
            spent += 1
            good = negative == 0
            if good:
                rise = rise_of_bounds(
                    reals, ints, trial, held, F, diameter, g, push, far, memory, predicted, assemble, solve,
                    retract, motion, renew,
                )  # fmt: skip
        if good and status == CONVERGED:
            stale_solution(reals, ints, F, home, trial, load, 1.0, ahead, solve, carry)
            if predictor and not remembers(memory):
                good = not snapped(
                    reals, ints, state, trial, way, tangent, ahead, step, diameter, predicted, retract, motion
                )
        if not good:
            kept = False
            if ease < np.inf:
                ease = 0.5 * step
            else:
                dt = 0.5 * step
            if step < 2.0 * LEAST_STEP:
                # negative pivots however short the step: the stiffness jumps there, as where a pair opens
                outcome = CRITICAL if trouble == INDEFINITE else STUCK
                if ease < np.inf:
                    outcome = OPENED  # what a pair had held is gone at once: there is no branch to judge by
                break
            continue
        if status == LINEAR:
            if not linear:
                copy(state, origin)
                begin, linear = time, True
        elif linear:
            # a linear stretch took no factorisation: verify its stability once, where it ends
            # up to where the first pair closes, if none is closed: there the substep landed
            wide = clearance > 0.0
            critical, verified = unstable_time(
                reals, ints, memory, origin, begin, tangent, target if wide else time,
                np.inf if wide else 0.0, H, g, assemble, factor, retract,
            )  # fmt: skip
            checks += verified
            linear = False
            if critical < np.inf:
                break
        copy(tangent, old)
        if status == CONVERGED:
            copy(ahead, tangent)
        closed = shortened
        approached = approached or (weak and closed)
        if needed == 0 and approached:
            assemble(reals, ints, trial, 0.0, held, trial, g, F)
            copy(trial, home)
            factor(reals, ints, F)
            spent += 1
        look = looked_at + min(LOOK, SOONER * (zero - looked_at))
        if approached or (needed > 0 and (weak or target >= look)):
            value = least_stiffness(reals, ints, F, mode, ahead, solve)
            if value > NEUTRAL * at_rest or value < softness:
                zero = predicted_zero(target, value, looked_at, softness)
            if APPROACH * (zero - target) < LEAST_STEP and value > NEUTRAL * at_rest:
                zero = np.inf  # the stiffness jumps here, as where a pair opens
            softness, looked_at = value, target
        kept, last = True, step
        if since == 0.0:
            through = predicted_zero(target, nearer, measured, room)
            measured = target
        room, moved = nearer, since
        copy(state, before)
        copy(trial, state)
        time = target
        copy_table(held, memory)
        clearance = commit(reals, ints, state, memory)
        if slid:
            let_rise(memory, rise)
        ease = SETTLING if released(held, memory) else np.inf
        if needed < EASY_COUNT + rounds:  # a round with renewed bounds takes one more
            # the turn grows with the square of the step
            dt = max(dt, step * min(2.0, math.sqrt(SAFE * TURN / share) if share > 0.0 else 2.0))
        if landing:
            copy(state, states[row])
            copy_table(held, memories[row])
            iterations[row] = spent
            spent = 0
            row += 1
    if outcome == COMPLETED and clearance == -np.inf:
        outcome = STRAY
    bracket = 2.0 * stride
    if linear:
        critical, count = unstable_time(
            reals, ints, memory, origin, begin, tangent, time, 0.0, H, g, assemble, factor, retract
        )
        checks += count
    if critical < np.inf:
        outcome, time, bracket = CRITICAL, critical, LEAST_STEP
        while row > 0 and times[row - 1] > critical:
            row -= 1
        retract(reals, ints, origin, tangent, critical - begin, origin, 0.0, state)
    return (  # `Track`; making one in compiled code would call back into the interpreter
        states[:row],
        memories[:row],
        iterations[:row],
        spent,
        outcome,
        time,
        bracket,
        checks,
        pairs,
        state,
        memory,
        history,
    )


@lru_cache(maxsize=1)
def compiled_follow() -> Callable:
    """`follow`, compiled; read from the cache where stored.

    The kernels enter as typed first-class functions: a jitted function passed as an ordinary
    argument would be compiled anew in every process.
    """
    whole, real = types.int64, types.float64
    vector, numbers, table = types.float64[::1], types.int64[::1], types.float64[:, ::1]
    data = (vector, numbers, vector, vector, vector, table, whole)
    control = (real, whole, types.boolean, types.boolean, vector)
    functions = tuple(types.FunctionType(signature) for signature in SIGNATURES)
    return signed(follow, *data, *control, *functions, numbers)
