"""Equilibrium at a fixed load: Newton's method on the energy, compiled.

A model is described by its data (two flat arrays, see `coilspring.packing`) and ten kernels, which
the functions here take as typed first-class functions, so that they are compiled once for all models:

``assemble(reals, ints, anchor, clearance, memory, state, g, H) -> (energy, pairs evaluated)``
    Strain and contact energy, its gradient `g` and its matrix `H` (model's own storage, flat; left
    out where it is empty) at `state`. `anchor` is the last accepted state, `clearance`
    the least gap of its contact pairs: while nothing has moved by half of it, no pair can touch.
    `memory` holds what contact remembers.
``factor(reals, ints, F) -> (negative pivots, least pivot)``
    LDL^T of `F` in place. By Sylvester's law the negative pivots count the negative eigenvalues.
``solve(reals, ints, F, b)``
    Back substitution in place.
``retract(reals, ints, state, step, factor, out)``
    The state moved by ``factor * step`` (rotations by the exponential map).
``predict(reals, ints, before, state, tangent, last, step, bend, out)``
    The path extrapolated from `state` by a `step` of time: along its `tangent`, and with ``bend = 1`` on
    the parabola that also meets the state `before`, a time `last` ago; with 0 on the straight line.
``work(reals, ints, load, a, b)``
    Work of a dead load from state `a` to state `b`.
``carry(reals, ints, a, b, v)``
    Turn the parts of a step or a residual `v` in place with the nodes on which they act, from state `a`
    to `b`: seen so, a factor stays good while the body turns.
``motion(reals, ints, a, b) -> (distance, pair motion, free share)``
    Bound on how far any point moved from state `a` to `b`; the largest change of the vector between the
    centres of a pair that comes near on the way, in wire diameters; the share of the way after which
    the first pair that is open in `a` has closed.
``commit(reals, ints, state, memory) -> least gap``
    Update the contact memory with an accepted state. Minus infinity: a pair touches that is not in
    the model.
``renew(reals, ints, state, memory) -> change``
    Set the bounds of the tangential forces, which are numbers in `assemble`, to those of the normal
    forces at `state`; returns their largest change over the largest bound, 0 without friction.
"""

from __future__ import annotations

import math

import numpy as np

from coilspring.compiled import copy, kernel

CONVERGED, LINEAR, SADDLE, FAILED = 0, 1, 2, 3
NONE, LONG, INDEFINITE = 0, 1, 2

# Stop when the Newton decrement g H^-1 g, twice the energy still to gain, is below this share of
# the reference work: 1e-8 of the displacements in the energy norm, before the last step is applied.
DECREMENT = 1e-16
MEASURED = 1e-6  # of that, where contact is near: a last step could open or close a pair
# The same, for a factor kept from an earlier state: only a linear response is let through.
LINEAR_DECREMENT = 1e-22
# Stability is decided by the pivots at the equilibrium itself where the least of the last factor is below
# this share of the least at rest, or could have come from a change of the matrix since: CHANGE times the
# size of the step in the energy norm.
SINGULAR = 0.1
CHANGE = 100.0
ARMIJO = 1e-4  # usual sufficient-decrease constant (Nocedal & Wright, section 3.1)
ENERGY_NOISE = 1e-13  # relative rounding of the energy: smaller decreases cannot be asked for
MOST_BACKTRACKS = 30
LEAST_CUT = 1e-3
FLAT = 0.5  # of the slope at the start: near enough to the least potential along a step
MOST_FLAT = 6  # attempts for that
LONG_SEARCH = 0.1  # a step cut below this says that the iteration left the neighbourhood
NUDGE = 1e-2  # of the energy of the way
CHORDS = 3  # steps with a kept factor that cost less than a new one
FAR = 1e-7  # of the reference work: from such a decrement, another factorisation will be needed
FIRST_SHIFT = 0.1  # in units of the matrix at rest
CUT = 0.5  # a damped step that the line search cuts below this asks for more damping
MOST_SHIFT = 1e8
TRUST = 1e-2  # share of the decrement that a good Newton step from a predicted state leaves at most
HISTORY = 64  # Newton decrements kept as evidence


@kernel
def dot(a, b):
    """Scalar product; a plain loop compiles ten times faster than the library call."""
    total = 0.0
    for i in range(a.size):
        total += a[i] * b[i]
    return total


@kernel
def subtract(push, g):
    """g -= push."""
    for i in range(g.size):
        g[i] -= push[i]


@kernel
def solution(reals, ints, F, b, sign, out, solve):
    """out = sign F^-1 b."""
    for i in range(b.size):
        out[i] = sign * b[i]
    solve(reals, ints, F, out)


@kernel
def stale_solution(reals, ints, F, home, state, b, sign, out, solve, carry):
    """out = sign F^-1 b at `state`, with the factor of the state `home`, turned along."""
    for i in range(b.size):
        out[i] = sign * b[i]
    carry(reals, ints, state, home, out)
    solve(reals, ints, F, out)
    carry(reals, ints, home, state, out)


@kernel
def residual(reals, ints, anchor, clearance, memory, push, state, g, H, assemble):
    """Energy and pairs evaluated at `state`; fills the residual `g` under the load and the matrix `H`."""
    energy, looked = assemble(reals, ints, anchor, clearance, memory, state, g, H)
    subtract(push, g)
    return energy, looked


@kernel
def advance(reals, ints, state, step, trial, retract):
    """Move `state` by the whole step; `trial` is scratch."""
    retract(reals, ints, state, step, 1.0, trial)
    copy(trial, state)


@kernel
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


@kernel
def falls(energy, gain, slope, length, rounding):
    """Whether the potential changed by `gain` has fallen enough, to the rounding of the energy."""
    return gain <= ARMIJO * length * slope + rounding + ENERGY_NOISE * abs(energy)


@kernel
def shorter(low, high, before, behind, gain, slope):
    """Length between `low` and `high`: where the potential's slope, linear between its values there, is
    zero; where it still falls at `high`, the minimum of the parabola through the potential's `gain`."""
    if low > 0.0 or behind > 0.0:
        share = before / (before - behind) if behind > 0.0 else 0.5
    else:
        curvature = gain - slope * high
        share = -0.5 * slope * high / curvature if curvature > 0.0 else 0.5
    if not np.isfinite(share):
        share = LEAST_CUT
    return low + min(max(share, LEAST_CUT), 0.5 if low == 0.0 and behind <= 0.0 else 1.0) * (high - low)


@kernel
def line_search(
    reals, ints, anchor, clearance, memory, push, state, step, energy, slope, gain, behind, rounding, g, H,
    trial, assemble, retract, work,
):  # fmt: skip
    """Shorten `step` until the potential has fallen enough; `trial`, `g`, `H` belong to the result.

    The whole step changes the potential by `gain`, too little of a fall, and its slope there is `behind`.
    Where contact is near, the length is that of the least potential, roughly: there the pairs that the
    step closes do touch, so that the next step knows their stiffness.

    Returns the accepted length (0 where none was found), the energy there and the pairs evaluated.
    """
    low, high, before = 0.0, 1.0, slope
    pairs = 0
    for i in range(MOST_BACKTRACKS):
        length = shorter(low, high, before, behind, gain, slope)
        retract(reals, ints, state, step, length, trial)
        value, looked = residual(reals, ints, anchor, clearance, memory, push, trial, g, H, assemble)
        pairs += looked
        gain = value - energy - work(reals, ints, push, state, trial)
        tilt = dot(g, step)
        if falls(abs(energy) + abs(value), gain, slope, length, rounding):
            if looked == 0 or abs(tilt) <= FLAT * abs(slope) or i >= MOST_FLAT:
                return length, value, pairs
            if tilt < 0.0:
                low, before = length, tilt
                behind *= 0.5  # the Illinois rule: or one end might stay for ever
                continue
        high, behind = length, tilt
        before = 0.5 * before if low > 0.0 else before
    return 0.0, energy, pairs


@kernel
def worthwhile(left, last, enough, lean):
    """Whether a step with a kept factor is taken, its decrement being `left` and that of the one before `last`.

    Within the tolerance `enough`, while it still gains; else where so few steps suffice, each gaining as
    much as the one before, that they cost less than a new factor.
    """
    if not left < last:
        return False
    if left <= enough:
        return left > MEASURED * enough
    return lean and last < np.inf and math.log(enough / left) >= CHORDS * math.log(left / last)


@kernel
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

    `push` is the load; `kept` says that `F` holds the factor of the last accepted state; where that
    alone already closes the residual the response is linear and nothing is factored. `reference`, a work, scales the
    stop test, `lean` says that the matrix is asked for only where it is factored,
    `stiffness` is the least pivot at rest, `rounding` is the absolute noise of the energy, `limit` bounds
    the iterations, `history` receives the decrements over `reference`.

    Returns status, factorisations, trouble (NONE, LONG line search, or an INDEFINITE matrix that was
    shifted), and the pairs evaluated.
    """
    step = np.empty_like(g)
    trial = np.empty_like(state)
    matrix = H[:0] if lean else H  # of trial states
    current = not (lean and kept)  # `H` is that of `state`
    energy, looked = residual(
        reals, ints, anchor, clearance, memory, push, state, g, H if current else matrix, assemble
    )
    pairs = looked
    enough = max(DECREMENT * reference, rounding)  # less energy than its rounding cannot be asked for
    count, trouble = 0, NONE
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
            elif worthwhile(left, last, enough, lean) if i > 0 else lean and left <= NUDGE * way:
                # a step may open or close a pair: the state is looked at again
                advance(reals, ints, state, step, trial, retract)
                if i > 0:
                    energy, looked = residual(
                        reals, ints, anchor, clearance, memory, push, state, g, matrix, assemble
                    )
                    pairs += looked
                    last = left
                    continue
                current = False
            if near:
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
            retract(reals, ints, state, step, 1.0, trial)
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
        retract(reals, ints, state, step, 1.0, trial)
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
        before = -slope if kept and length == 1.0 else 0.0
        last = before if before > 0.0 else np.inf
        copy(trial, state)
    return FAILED, count, trouble, pairs
