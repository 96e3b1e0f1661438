"""A step shortened until the potential falls, and the residual that it needs."""

from __future__ import annotations

import numpy as np

from coilspring.compiled import part

ARMIJO = 1e-4  # usual sufficient-decrease constant (Nocedal & Wright, section 3.1)
ENERGY_NOISE = 1e-13  # relative rounding of the energy: smaller decreases cannot be asked for
MOST_BACKTRACKS = 30
LEAST_CUT = 1e-3
FLAT = 0.5  # of the slope at the start: near enough to the least potential along a step
MOST_FLAT = 20  # attempts for that


@part
def dot(a, b):
    """Scalar product; a plain loop compiles ten times faster than the library call."""
    total = 0.0
    for i in range(a.size):
        total += a[i] * b[i]
    return total


@part
def subtract(b, a):
    """a -= b."""
    for i in range(a.size):
        a[i] -= b[i]


@part
def solution(reals, ints, F, b, sign, out, solve):
    """out = sign F^-1 b."""
    for i in range(b.size):
        out[i] = sign * b[i]
    solve(reals, ints, F, out)


@part
def stale_solution(reals, ints, F, home, state, b, sign, out, solve, carry):
    """out = sign F^-1 b at `state`, with the factor of the state `home`, turned along."""
    for i in range(b.size):
        out[i] = sign * b[i]
    carry(reals, ints, state, home, out)
    solve(reals, ints, F, out)
    carry(reals, ints, home, state, out)


@part
def residual(reals, ints, anchor, clearance, memory, push, state, g, H, assemble):
    """Energy and pairs evaluated at `state`; fills the residual `g` under the load and the matrix `H`."""
    energy, looked = assemble(reals, ints, anchor, clearance, memory, state, g, H)
    subtract(push, g)
    return energy, looked


@part
def falls(energy, gain, slope, length, rounding):
    """Whether the potential changed by `gain` has fallen enough, to the rounding of the energy."""
    return gain <= ARMIJO * length * slope + rounding + ENERGY_NOISE * abs(energy)


@part
def shorter(low, high, farther, before, behind, beyond, gain, slope, cut):
    """Length between `low` and `high`: where the potential's slope, linear between its values there, is
    zero; where it still falls at `high`, the minimum of the parabola through the potential's `gain`.

    Where it rises at `high` and more so `farther` on, both are behind a contact that closes: there the slope
    is zero where the line through these two is, however hard the contact. `cut` is the least share of the way
    from `low` to `high`.
    """
    if 0.0 < behind < beyond:
        length = high - behind * (farther - high) / (beyond - behind)
        if length > low:
            return length
    if low > 0.0 or behind > 0.0:
        share = before / (before - behind) if behind > 0.0 else 0.5
    else:
        curvature = gain - slope * high
        share = -0.5 * slope * high / curvature if curvature > 0.0 else 0.5
    if not np.isfinite(share):
        share = cut
    return low + min(max(share, cut), 0.5 if low == 0.0 and behind <= 0.0 else 1.0) * (high - low)


@part
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
    farther, beyond, cut = 1.0, 0.0, LEAST_CUT
    pairs = 0
    for i in range(MOST_BACKTRACKS):
        length = shorter(low, high, farther, before, behind, beyond, gain, slope, cut)
        retract(reals, ints, state, step, length, state, 0.0, trial)
        value, looked = residual(reals, ints, anchor, clearance, memory, push, trial, g, H, assemble)
        pairs += looked
        gain = value - energy - work(reals, ints, push, state, trial)
        tilt = dot(g, step)
        if falls(abs(energy) + abs(value), gain, slope, length, rounding):
            if looked == 0 or abs(tilt) <= FLAT * abs(slope) or i >= MOST_FLAT:
                return length, value, pairs
            if tilt < 0.0:
                low, before = length, tilt
                behind, beyond = 0.5 * behind, 0.0  # the Illinois rule: or one end might stay for ever
                cut = min(10.0 * cut, 0.5)  # before a hard contact, that rule alone would creep
                continue
        farther, beyond = high, behind
        high, behind = length, tilt
        before = 0.5 * before if low > 0.0 else before
    return 0.0, energy, pairs
