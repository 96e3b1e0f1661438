"""A step shortened until the potential falls, and the residual that it needs."""

import math
from typing import NamedTuple

import numpy as np

from coilspring.compiling.compiled import part
from coilspring.solver.equilibrium.operations import assembled, moved

ARMIJO = 1e-4  # usual sufficient-decrease constant (Nocedal & Wright, section 3.1)
ENERGY_NOISE = 1e-13  # relative rounding of the energy: smaller decreases cannot be asked for
MOST_BACKTRACKS = 30
LEAST_CUT = 1e-3
FLAT = 0.5  # of the slope at the start: near enough to the least potential along a step
MOST_FLAT = 20  # attempts for that
EVERY = 3  # attempts, one of which is the geometric mean: where the slope jumps no line tells where
NEXT = 1e-4  # of the length above, in place of that below where this is 0


class Tried(NamedTuple):
    """Three lengths of a step, and the potential's slopes along it there."""

    low: float
    high: float
    farther: float
    before: float  # at `low`
    behind: float  # at `high`
    beyond: float  # `farther` on


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
def residual(system, target, state, g, H):
    """Energy and pairs evaluated at `state`; fills the residual `g` under the load and the matrix `H`."""
    energy, near = assembled(system, target.accepted, target.least_gap, target.history, state, g, H)
    subtract(target.load, g)
    return energy, near


@part
def falls(energy, gain, slope, length, noise):
    """Whether the potential changed by `gain` has fallen enough, to the rounding of the energy."""
    return gain <= ARMIJO * length * slope + noise + ENERGY_NOISE * abs(energy)


@part
def whole_step(work, it, energy, gain):
    """Whether the whole step is taken: the potential falls; where its change is lost in rounding, its slope
    levels out.

    The second is the approximate Wolfe condition of Hager & Zhang (2005). The rounded potential alone would
    take steps between which hard pairs open and close for ever.
    """
    if abs(gain) > it.noise + ENERGY_NOISE * energy:
        return gain <= ARMIJO * it.slope
    return abs(dot(work.g, work.step)) <= FLAT * abs(it.slope)


@part
def shorter(tried, gain, slope, cut):
    """Length between `low` and `high` of what was `tried`: where the potential's slope, linear between its
    values there, is zero; where it still falls at `high`, the minimum of the parabola through the potential's
    `gain` there and its `slope` at the start.

    Where it rises at `high` and more so `farther` on, both are behind a contact that closes: there the slope
    is zero where the line through these two is, however hard the contact. `cut` is the least share of the way
    from `low` to `high`.
    """
    low, high, farther, before, behind, beyond = tried
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
def line_search(system, target, work, state, it, gain):
    """Shorten the step until the potential has fallen enough; `work.scratch`, `work.g` and the matrix belong
    to the result.

    The whole step changes the potential by `gain`, too little of a fall. Where contact is near, the length is
    that of the least potential, roughly: there the pairs that the step closes do touch, so that the next step
    knows their stiffness.

    Returns the accepted length, 0 where none was found; ``it.energy`` and ``it.near`` are those there.
    """
    H = work.H[:0] if target.modified else work.H
    low, high, before, behind = 0.0, 1.0, it.slope, dot(work.g, work.step)
    farther, beyond, cut = 1.0, 0.0, LEAST_CUT
    for i in range(MOST_BACKTRACKS):
        tried = Tried(low, high, farther, before, behind, beyond)
        length = shorter(tried, gain, it.slope, cut)
        if i % EVERY == EVERY - 1:
            length = math.sqrt(high * max(low, NEXT * high))
        moved(system, state, work.step, length, work.scratch)
        value, near = residual(system, target, work.scratch, work.g, H)
        it.pairs += near
        gain = value - it.energy - system.work(system.reals, system.ints, target.load, state, work.scratch)
        tilt = dot(work.g, work.step)
        if falls(abs(it.energy) + abs(value), gain, it.slope, length, it.noise):
            if near == 0 or abs(tilt) <= FLAT * abs(it.slope) or i >= MOST_FLAT:
                it.energy, it.near = value, near
                return length
            if tilt < 0.0:
                low, before = length, tilt
                behind, beyond = 0.5 * behind, 0.0  # the Illinois rule: or one end might stay for ever
                cut = min(10.0 * cut, 0.5)  # before a hard contact, that rule alone would creep
                continue
        farther, beyond = high, behind
        high, behind = length, tilt
        before = 0.5 * before if low > 0.0 else before
    return 0.0
