"""Equilibrium at a fixed load: Newton's method on the energy, compiled.

The kernels of a model are those of `coilspring.kernelset`.
"""

from __future__ import annotations

import math

import numpy as np

from coilspring.compiled import copy, part, zeros
from coilspring.linesearch import dot, falls, line_search, residual, solution, stale_solution

CONVERGED, LINEAR, SADDLE, FAILED = 0, 1, 2, 3  # to LINEAR: an equilibrium was found
NONE, LONG, INDEFINITE = 0, 1, 2

# Stop when the Newton decrement g H^-1 g, twice the energy still to gain, is below this share of
# the reference work: 1e-8 of the displacements in the energy norm, before the last step is applied.
DECREMENT = 1e-16
MEASURED = 1e-6  # of that, where contact is near: a last step could open or close a pair
# The same, for a factor kept from an earlier state: only a linear response is let through.
LINEAR_DECREMENT = 1e-22
# Stability is decided by the pivots at the equilibrium itself where the least of the last factor, over the
# least at rest, is below this and below what the matrix may have changed by since: CHANGE times the size of
# the last step in the energy norm.
SINGULAR = 0.1
CHANGE = 100.0
LONG_SEARCH = 0.1  # a step cut below this says that the iteration left the neighbourhood
MOST_LOOKS = 8  # at a state within the tolerance
NUDGE = 1e-2  # of the energy of the way: so small a step with a kept factor takes out stiff errors first
CHORDS = 3  # steps with a kept factor that cost less than a new one
FAR = 1e-7  # of the reference work: from such a decrement, another factorisation will be needed
FIRST_SHIFT = 0.1  # in units of the matrix at rest
CUT = 0.5  # a damped step that the line search cuts below this asks for more damping
MOST_SHIFT = 1e8
TRUST = 1e-2  # share of the decrement that a good Newton step from a predicted state leaves at most
HISTORY = 64  # Newton decrements kept as evidence


@part
def advance(reals, ints, state, step, trial, retract):
    """Move `state` by the whole step; `trial` is scratch."""
    retract(reals, ints, state, step, 1.0, state, 0.0, trial)
    copy(trial, state)


@part
def positive_factor(reals, ints, H, rest, shift, F, factor):
    """Factor H + shift * rest, a matrix known to be indefinite, with the first shift, from `shift` on,
    that mends it.

    Returns the shift and the number of factorisations.
    """
    count = 0
    while shift < MOST_SHIFT:
        for i in range(F.size):
            F[i] = H[i] + shift * rest[i]
        negative, _ = factor(reals, ints, F)
        count += 1
        if negative == 0:
            break
        shift *= 4.0
    return shift, count


@part
def worthwhile(left, last, enough, looks, lean):
    """Whether a step with a kept factor is taken; its decrement is `left`, that of the one before `last`.

    Within the tolerance `enough`, while it gains, but near a critical point it may gain little for ever;
    else where so few steps suffice, each gaining as much as the one before, that they cost less than
    another factor.
    """
    if not left < last:
        return False
    if left <= enough:
        return left > MEASURED * enough and looks < MOST_LOOKS
    return lean and last < np.inf and math.log(enough / left) >= CHORDS * math.log(left / last)


@part
def equilibrium(
    reals,
    ints,
    anchor,
    clearance,
    memory,
    push,
    reference,
    way,
    rounding,
    limit,
    state,
    g,
    H,
    lean,
    rest,
    stiffness,
    F,
    home,
    kept,
    history,
    assemble,
    factor,
    solve,
    retract,
    work,
    carry,
):
    """Newton's method with energy line search from `state`, which is moved to the equilibrium.

    `push` is the load; `kept` says that `F` holds the factor of the state `home`; where that alone already
    closes the residual the response is linear and nothing is factored. `lean` says that the matrix is
    costly: it is asked for only where it is factored, and the factor is kept for further steps while it
    closes the residual fast. `reference`, a work, scales the stop test, `way` is the energy of the way
    predicted, `stiffness` the least pivot at rest, `rounding` the absolute noise of the energy, `limit`
    bounds the iterations, `history` receives the decrements over `reference`.

    Returns status, factorisations, trouble (NONE, LONG line search, or an INDEFINITE matrix that was
    shifted), and the pairs evaluated.
    """
    step = zeros(g.size)
    trial = zeros(state.size)
    matrix = H[:0] if lean else H  # of trial states
    current = not (lean and kept)  # `H` is that of `state`
    energy, looked = residual(
        reals, ints, anchor, clearance, memory, push, state, g, H if current else matrix, assemble
    )
    pairs = looked
    enough = max(DECREMENT * reference, rounding)  # less energy than its rounding cannot be asked for
    count, trouble, looks, doubtful = 0, NONE, 0, False
    least, before, last, damping = np.inf, 0.0, np.inf, FIRST_SHIFT
    for i in range(limit):
        if kept:
            # the factor of a state nearby may close the residual: then nothing is factored for it
            stale_solution(reals, ints, F, home, state, g, -1.0, step, solve, carry)
            left = abs(dot(g, step))
            if i == 0 and left <= LINEAR_DECREMENT * reference:
                advance(reals, ints, state, step, trial, retract)
                return LINEAR, count, trouble, pairs
            near = left <= enough and i > 0
            if near and looked == 0:
                advance(reals, ints, state, step, trial, retract)
            elif (
                i + 1 < limit and worthwhile(left, last, enough, looks, lean)
                if i > 0
                else lean and left <= NUDGE * way
            ):
                # a step may open or close a pair: the state is looked at again
                advance(reals, ints, state, step, trial, retract)
                if i > 0:
                    energy, looked = residual(
                        reals, ints, anchor, clearance, memory, push, state, g, matrix, assemble
                    )
                    pairs += looked
                    last = left
                    looks += 1 if near else 0
                    continue
                current = False
            if near and not (doubtful or looked == 0 or left <= MEASURED * enough):
                doubtful = True  # a factor with another pair closed may take any state for a solution
            elif near:
                if least >= stiffness * min(SINGULAR, CHANGE * math.sqrt(before / reference)):
                    return CONVERGED, count, trouble, pairs
                # nearly singular: the pivots must be those of the equilibrium itself
                _, looked = assemble(reals, ints, anchor, clearance, memory, state, g, H)
                copy(H, F)
                copy(state, home)
                negative, _ = factor(reals, ints, F)
                status = SADDLE if negative > 0 else CONVERGED
                return status, count + 1, INDEFINITE if negative > 0 else trouble, pairs + looked
        if lean and not current:
            energy, looked = residual(reals, ints, anchor, clearance, memory, push, state, g, H, assemble)
            pairs += looked
        copy(H, F)
        copy(state, home)
        negative, least = factor(reals, ints, F)
        count, current = count + 1, False
        shift = 0.0
        solution(reals, ints, F, g, -1.0, step, solve)
        slope = dot(g, step)
        if negative > 0 and i == 0:
            # a predicted state may be indefinite near a stable equilibrium: plain Newton finds it
            retract(reals, ints, state, step, 1.0, state, 0.0, trial)
            energy, looked = residual(
                reals, ints, anchor, clearance, memory, push, trial, g, matrix, assemble
            )
            solution(reals, ints, F, g, 1.0, step, solve)
            pairs += looked
            if abs(dot(g, step)) <= TRUST * abs(slope):
                copy(trial, state)
                kept = False
                continue
            energy, looked = residual(
                reals, ints, anchor, clearance, memory, push, state, g, matrix, assemble
            )
            pairs += looked
        if negative > 0:
            trouble = INDEFINITE
            shift, spent = positive_factor(reals, ints, H, rest, damping, F, factor)
            count += spent
            solution(reals, ints, F, g, -1.0, step, solve)
            slope = dot(g, step)
        for j in range(HISTORY - 1):
            history[j] = history[j + 1]
        history[HISTORY - 1] = -slope / reference
        if not np.isfinite(slope) or slope > 0.0:
            return FAILED, count, trouble, pairs
        if -slope <= enough:
            if shift > 0.0:
                return SADDLE, count, trouble, pairs
            advance(reals, ints, state, step, trial, retract)
            if looked == 0:
                return CONVERGED, count, trouble, pairs
            energy, looked = residual(
                reals, ints, anchor, clearance, memory, push, state, g, matrix, assemble
            )
            pairs += looked
            kept, before, last = True, -slope, np.inf
            continue
        retract(reals, ints, state, step, 1.0, state, 0.0, trial)
        far = -slope > FAR * reference
        value, looked = residual(
            reals, ints, anchor, clearance, memory, push, trial, g, H if far else matrix, assemble
        )
        current = far
        pairs += looked
        gain = value - energy - work(reals, ints, push, state, trial)
        length = 1.0
        if falls(abs(energy) + abs(value), gain, slope, 1.0, rounding):
            energy = value
        else:
            length, energy, looked = line_search(
                reals, ints, anchor, clearance, memory, push, state, step, energy, slope, gain, dot(g, step),
                rounding, g, matrix, trial, assemble, retract, work,
            )  # fmt: skip
            pairs += looked
            current = False
        if length == 0.0:
            return FAILED, count, trouble, pairs
        if length < LONG_SEARCH:
            trouble = max(trouble, LONG)
        if shift > 0.0:
            # a step cut short went too far along a soft mode: damp the next one more
            damping = 4.0 * shift if length < CUT else max(0.25 * shift, FIRST_SHIFT)
        kept = shift == 0.0 and not (lean and current)
        before = -slope
        last = before if kept and length == 1.0 else np.inf
        copy(trial, state)
    return FAILED, count, trouble, pairs
