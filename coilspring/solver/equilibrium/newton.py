"""Equilibrium at a fixed load: Newton's method on the energy, compiled."""

import math
from functools import cache
from typing import Any

import numpy as np

from coilspring.compiling.compiled import copy, part, typed
from coilspring.solver.bundles import equilibrium_signature
from coilspring.solver.equilibrium.linesearch import dot, line_search, residual, whole_step
from coilspring.solver.equilibrium.operations import assembled, factored, moved, solution, stale_solution

CONVERGED, LINEAR, SADDLE, FAILED = 0, 1, 2, 3  # to LINEAR: an equilibrium was found
AGAIN, GO_ON = -1, -2  # within an iteration: begin the next one; go on with this one
NONE, LONG, INDEFINITE = 0, 1, 2  # trouble

# Stop when the Newton decrement g H^-1 g, twice the energy still to gain, is below this share of
# the reference work: 1e-8 of the displacements in the energy norm, before the last step is applied.
DECREMENT = 1e-16
# Of the potential's rounding: the decrement is no difference of energies, and is known better than these.
DECREMENT_NOISE = 1e-5
MEASURED = 1e-6  # of the tolerance, where contact is near: a last step could open or close a pair
# The same, for a factor kept from an earlier state: only a linear response is let through.
LINEAR_DECREMENT = 1e-22
# Stability is decided by the pivots at the equilibrium itself where the least of the last factor, over the
# least at rest, is below this and below what the matrix may have changed by since: CHANGE times the size of
# the last step in the energy norm.
SINGULAR = 0.1
CHANGE = 100.0
LONG_SEARCH = 0.1  # a step cut below this says that the iteration left the neighbourhood
MOST_LOOKS = 8  # at a state within the tolerance
NUDGE = 1e-2  # of the predicted energy: so small a step with a kept factor takes out stiff errors first
CHORDS = 3  # steps with a kept factor that cost less than a new one
FAR = 1e-7  # of the reference work: from such a decrement, another factorisation will be needed
CUT = 0.5  # a damped step that the line search cuts below this asks for more damping
MOST_SHIFT = 1e8
TRUST = 1e-2  # share of the decrement that a good Newton step from a predicted state leaves at most
GAPS = 8.0  # times the rounding of positions is that of gaps, after some dozens of operations
PATIENCE = 3  # steps that bring no progress, before Newton's method is said to have stalled
STALLED = 0.1  # share of the decrement before: more is no progress
DECREMENTS = 64  # Newton decrements kept as evidence
MOST_LOOPS = 64  # factorisations within the tolerance of which rounding decides on pairs that touch


def equilibrium(system, target, work, state, it):
    """Newton's method with energy line search from `state`, which is moved to the equilibrium.

    Where ``it.reuse`` is set and the last factor alone closes the residual, the response is linear and
    nothing is factored. `it` is the record of the iteration, see `coilspring.solver.system.NEWTON`.

    Returns one of CONVERGED, LINEAR, SADDLE and FAILED.
    """
    it.pairs, it.count, it.trouble, it.looks, it.directions = 0, 0, NONE, 0, 0
    it.doubtful, it.unstable, it.current = False, False, not (target.modified and it.reuse)
    it.least_pivot, it.decrement, it.last, it.damping = np.inf, 0.0, np.inf, target.shift
    evaluate(system, target, work, state, it, it.current or not target.modified)
    for i in range(target.limit):
        if i >= target.damped and it.trouble == INDEFINITE:
            break
        status = reuse_factor(system, target, work, state, it, i) if it.reuse else GO_ON
        if status == GO_ON:
            status = newton_direction(system, target, work, state, it, i == 0)
        if status == GO_ON:
            status = move(system, target, work, state, it)
        if status != AGAIN:
            return status
    return FAILED


@cache
def compiled_equilibrium() -> Any:
    """`equilibrium`, compiled by itself: so two processor cores share the work."""
    return typed(equilibrium, equilibrium_signature())


@part
def evaluate(system, target, work, state, it, with_matrix):
    """Energy and residual at a state, and its matrix if asked for."""
    H = work.H if with_matrix else work.H[:0]
    it.energy, it.near = residual(system, target, state, work.g, H)
    set_tolerance(system, target, it)
    it.pairs += it.near


@part
def set_tolerance(system, target, it):
    """Rounding of the potential at the state that was evaluated last, and the decrement that is asked for."""
    it.rounding = max(target.rounding, target.grain * abs(system.reaction[0]))
    it.tolerance = max(DECREMENT * target.precision * target.reference, DECREMENT_NOISE * it.rounding)


@part
def advance(system, work, state):
    """Move `state` by the whole step."""
    moved(system, state, work.step, 1.0, work.scratch)
    copy(work.scratch, state)


@part
def reuse_factor(system, target, work, state, it, i):
    """Try the factor of a state nearby: where it closes the residual, nothing is factored.

    Returns GO_ON where the matrix is to be factored, AGAIN where the step was taken.
    """
    stale_solution(system, work, state, work.g, -1.0, work.step)
    left = abs(dot(work.g, work.step))
    if i == 0 and left <= LINEAR_DECREMENT * target.reference:
        advance(system, work, state)
        return LINEAR
    within = left <= it.tolerance and i > 0
    if within and it.near == 0:
        advance(system, work, state)
    elif i == 0 and target.modified and left <= NUDGE * target.predicted:
        advance(system, work, state)
        it.current = False
    elif 0 < i < target.limit - 1 and worthwhile(left, it, target.modified):
        # a step may open or close a pair: the state is evaluated again
        advance(system, work, state)
        evaluate(system, target, work, state, it, not target.modified)
        it.last = left
        it.looks += within
        return AGAIN
    if not within:
        return GO_ON
    if not (it.doubtful or it.near == 0 or left <= MEASURED * it.tolerance):
        it.doubtful = True  # a factor with another pair closed may take any state for a solution
        return GO_ON
    if it.least_pivot >= target.least_pivot * min(
        SINGULAR, CHANGE * math.sqrt(it.decrement / target.reference)
    ):
        return CONVERGED
    return stable_itself(system, target, work, state, it)


@part
def stable_itself(system, target, work, state, it):
    """Where the matrix is nearly singular the pivots must be those of the equilibrium itself."""
    _, near = assembled(system, target.accepted, target.least_gap, target.history, state, work.g, work.H)
    it.pairs += near
    negative = factor_at(system, work, state, it)
    if negative > 0:
        it.trouble = INDEFINITE
        return SADDLE
    return CONVERGED


@part
def factor_at(system, work, state, it):
    """Factor the matrix of `state`; returns the number of negative pivots."""
    copy(work.H, work.F)
    copy(state, work.factored_at)
    negative, it.least_pivot = factored(system, work.F)
    it.count += 1
    return negative


@part
def worthwhile(left, it, modified):
    """Whether a step with a kept factor is taken; its decrement is `left`.

    Within the tolerance, while it gains, but near a critical point it may gain little for ever;
    else where so few steps suffice, each gaining as much as the one before, that they cost less than
    another factor.
    """
    if not left < it.last:
        return False
    if left <= it.tolerance:
        return left > MEASURED * it.tolerance and it.looks < MOST_LOOKS
    return (
        modified and it.last < np.inf and math.log(it.tolerance / left) >= CHORDS * math.log(left / it.last)
    )


@part
def newton_direction(system, target, work, state, it, first):
    """Factor the matrix, damped where it is indefinite, and find the step.

    Returns GO_ON with the step, its slope and its shift, AGAIN where a step was taken, or a status.
    """
    if target.modified and not it.current:
        evaluate(system, target, work, state, it, True)
    negative = factor_at(system, work, state, it)
    it.current, it.shift = False, 0.0
    solution(system, work.F, work.g, -1.0, work.step)
    it.slope = dot(work.g, work.step)
    if negative > 0 and first and plain_step(system, target, work, state, it):
        return AGAIN
    if negative > 0:
        it.trouble, it.unstable = INDEFINITE, it.unstable or first
        if target.damped == 0:
            return FAILED
        make_positive(system, work, it)
        solution(system, work.F, work.g, -1.0, work.step)
        it.slope = dot(work.g, work.step)
    decrements = work.decrements
    for j in range(DECREMENTS - 1):
        decrements[j] = decrements[j + 1]
    decrements[DECREMENTS - 1] = -it.slope / target.reference
    it.directions += 1
    if not np.isfinite(it.slope) or it.slope > 0.0:
        return FAILED
    return GO_ON


@part
def plain_step(system, target, work, state, it):
    """A predicted state may be indefinite near a stable equilibrium: whether plain Newton finds it."""
    moved(system, state, work.step, 1.0, work.scratch)
    evaluate(system, target, work, work.scratch, it, not target.modified)
    solution(system, work.F, work.g, 1.0, work.step)
    if abs(dot(work.g, work.step)) <= TRUST * abs(it.slope):
        copy(work.scratch, state)
        it.reuse = False
        return True
    evaluate(system, target, work, state, it, not target.modified)
    return False


@part
def make_positive(system, work, it):
    """Factor H + shift * rest, with the first shift from the damping on that makes it positive."""
    F, H, rest = work.F, work.H, work.rest
    it.shift = it.damping
    while it.shift < MOST_SHIFT:
        for i in range(F.size):
            F[i] = H[i] + it.shift * rest[i]
        negative, _ = factored(system, F)
        it.count += 1
        if negative == 0:
            break
        it.shift *= 4.0


@part
def stalled(work, it):
    """Whether the last steps came no nearer: rounding is what is left, or decides which pairs of hard contact
    touch."""
    last, before = np.inf, np.inf
    for j in range(max(DECREMENTS - it.directions, 0), DECREMENTS):
        if j < DECREMENTS - PATIENCE:
            before = min(before, work.decrements[j])
        else:
            last = min(last, work.decrements[j])
    return it.directions > PATIENCE and -it.slope <= it.noise and STALLED * before <= last


@part
def move(system, target, work, state, it):
    """Stop within the tolerance; else take the step, shortened until the potential falls."""
    # pairs that are off by the step hold a force, of which the rounding of their gaps is noise
    it.noise = GAPS * max(it.rounding, target.grain * math.sqrt(-it.slope * target.hardness))
    ends = stalled(work, it)
    if -it.slope <= it.tolerance or ends:
        if it.shift > 0.0:
            return SADDLE
        if ends or it.count > MOST_LOOPS:
            return CONVERGED  # rounding decides which pairs touch: a step opens some and closes others
        advance(system, work, state)
        if it.near == 0:
            return CONVERGED
        evaluate(system, target, work, state, it, not target.modified)
        it.reuse, it.decrement, it.last = True, -it.slope, np.inf
        return AGAIN
    energy = it.energy
    moved(system, state, work.step, 1.0, work.scratch)
    it.current = -it.slope > FAR * target.reference
    evaluate(system, target, work, work.scratch, it, it.current or not target.modified)
    gain = it.energy - energy - system.work(system.reals, system.ints, target.load, state, work.scratch)
    length = 1.0
    if not whole_step(work, it, abs(energy) + abs(it.energy), gain):
        it.energy = energy
        length = line_search(system, target, work, state, it, gain)
        it.current = False
        set_tolerance(system, target, it)
    if length == 0.0:
        return CONVERGED if it.shift == 0.0 and -it.slope <= it.noise else FAILED  # rounding is left
    if length < LONG_SEARCH:
        it.trouble = max(it.trouble, LONG)
    if it.shift > 0.0:
        # a step cut short went too far along a soft mode: damp the next one more
        it.damping = 4.0 * it.shift if length < CUT else max(0.25 * it.shift, target.shift)
    it.reuse = it.shift == 0.0 and not (target.modified and it.current)
    it.decrement = -it.slope
    it.last = it.decrement if it.reuse and length == 1.0 else np.inf
    copy(work.scratch, state)
    return AGAIN
