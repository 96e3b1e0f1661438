"""Transitions of one pair: it touches, slides, opens, is released, grazes, and touches again."""

import math

from coilspring.compiling.compiled import inlined

# Share of a bound that is left when it falls with the slip: less is out of reach, since the rise is at least
# -1/d and a pair moves by no more than half of d in a substep.
LEAST_LEFT = 0.5
TOUCHING = 1e-10  # wire diameters of gap, no more than rounding leaves: with less, a pair that sticks touches
OPEN = 2e-6  # wire diameters of gap at most where a pair that sticks is said to open
TURNED = 0.01  # of what a pair that sticks holds, by which that may turn round in a substep
GRAZING = 1e-9  # wire diameters of gap at most where a grazing pair is said to touch;
PRESSED = 1e-6  # of the load at most by which it is pressed then (that adds up over substeps), between
FINEST_GRAZING, MOST_PRESSED = 1e-12, 1e-6  # wire diameters: what rounding leaves, and the most
FINEST = 1e-10  # wire diameters of slip, before which no pair reaches its bound
# Wire diameters, by which two ways to find where a pair touches first may differ at most: where it sticks
STICK_LOCATED = 2e-6
STICK_PREDICTED = 1e-2  # (share of that to which it is predicted, by an estimate that is no bound)
LOCATED = 1e-5  # and with friction


@inlined
def slid(length, row, gap):
    """Take what a pair with friction slid in a substep into its history; returns how far it is stretched."""
    row.closed, row.fresh = gap < 0.0, False
    slip = (row.stiffness * length - row.bound) / (row.stiffness + row.bound * row.rise)
    if slip > 0.0:
        row.bound *= 1.0 + row.rise * slip
        gone, work = sliding(row, length, gap)
        slip += row.ahead
        row.slid += gone
        row.work += work
    row.held, row.deep = (row.bound, -gap) if row.closed else (0.0, 0.0)
    row.stride, row.wanted, row.ahead = slip if slip > 0.0 else 0.0, 0.0, 0.0
    return row.bound / row.stiffness if slip > 0.0 else length


@inlined
def sliding(row, length, gap):
    """What a pair slips in a substep in which it slides, or opens, mm, and the work that takes, N mm.

    In between its stretch, the bound and the gap are taken to change evenly. The pair sticks until its force
    comes to its bound, and from there on it holds that, until it opens and moves freely.
    """
    bound = row.held if row.held < math.inf else 0.0  # not known of what touched at rest
    begin, end = row.before + row.ahead, length + row.ahead
    if gap > 0.0:
        end = begin + (end - begin) * row.deep / (row.deep + gap)
    if end < 0.0:  # it opens before it has turned round
        begin, end = -begin, -end
    left, beyond = max(bound - row.whole * begin, 0.0), row.stiffness * end - row.bound
    share = left / (left + beyond) if left > 0.0 else 0.0
    slip = end - row.bound / row.stiffness
    return slip, 0.5 * (bound + share * (row.bound - bound) + row.bound) * slip


@inlined
def grazing_slip(row):
    """What a grazing pair slips in the trial state, mm."""
    return (row.sticking - min((1.0 - row.released) * row.sticking, row.bound)) / row.stiffness


@inlined
def leads(row, slip):
    """Whether a pair slips as far as its reference is ahead, at least; else that is taken back."""
    if slip >= row.lead * row.stride:
        return True
    row.wanted = 0.0
    return False


@inlined
def first_touch(before, after, d):
    """Share of the way from one vector of a pair to another after which it touches first: where h = d.

    0 for vectors that touch, and for one and the same that does so but for rounding.
    """
    start, along, square = 0.0, 0.0, 0.0
    for i in range(3):
        change = after[i] - before[i]
        start += before[i] ** 2
        along -= before[i] * change
        square += change**2
    outside = start - d * d
    root = along + math.sqrt(max(along**2 - square * outside, 0.0))
    return outside / root if outside > 0.0 and root > 0.0 else 0.0


@inlined
def located_to(mu):
    """Wire diameters, by which two ways to find where a pair touches first may differ at most."""
    if mu == 0.0:
        return math.inf
    return LOCATED if mu < math.inf else STICK_LOCATED


def predicted_to(mu):
    """Wire diameters, to which a touch is predicted that is not looked for any more: pairs that stick are
    held where they are predicted to touch, with no attempt that leaves them free."""
    return located_to(mu) * (1.0 if mu < math.inf else STICK_PREDICTED)


@inlined
def grazing_depth(force, d, K, k):
    """Wire diameters by which a grazing pair may penetrate, under a load of some size."""
    return min(MOST_PRESSED, max(FINEST_GRAZING, (PRESSED * force / K) ** (1.0 / k) / d))


@inlined
def touches_first(row, law, weight, at, doubt, known):
    """A pair is held from after the share `at` of a substep on: there it touches first, but for a `doubt`.

    `weight` is its stiffness over that of the law.

    A shorter substep is asked for where that is too much: to that place where it is `known`, else half of it.
    """
    most = located_to(law.mu) * law.d
    row.whole = row.stiffness = weight * law.kt
    row.closed, row.fresh, row.grazes, row.bound = True, True, False, math.inf
    row.slid, row.rise, row.held, row.released = 0.0, 0.0, 0.0, 0.0
    row.before, row.deep = 0.0, 0.0
    row.stride, row.wanted, row.lead, row.ahead = 0.0, 0.0, 0.0, 0.0
    row.cut = 1.0
    if doubt > most:
        row.cut = at + 0.5 * (1.0 - at) * most / doubt if known else 0.5


@inlined
def predicted_badly(row, error, most):
    """Ask for a shorter substep where a pair that touched first was predicted with an error above `most`.

    One that is to stick was left free to find that: from here on it is held. Returns whether it was free.
    """
    if error > most:
        row.cut = min(row.cut, 0.8 * math.sqrt(most / error))
    free = row.released > 0.0
    row.released = 0.0
    return free


@inlined
def touching_gap(law):
    """Gap, mm, below which a pair is held from an accepted state on: one that sticks, where it touches but
    for rounding. Else the last digits of a spring whose coils touch at rest would decide which of them do."""
    return TOUCHING * law.d if law.mu == math.inf else 0.0


@inlined
def opens_after(row, before, ahead, after, d):
    """Set the share of the substep after which a sticking pair is just open.

    Up to where it opens it follows the prediction, and from there on it is faster: its stiffness held it.
    """
    if row.fresh:
        row.cut = row.cut if after <= (1.0 + OPEN) * d else 0.5
    elif after <= (1.0 + OPEN) * d:
        row.cut = 1.0
    else:
        opens = (d - before) / (ahead - before) if before < d < ahead else 0.0
        start = d if opens > 0.0 else before
        row.cut = opens + (1.0 - opens) * ((1.0 + 0.5 * OPEN) * d - start) / (after - start)


@inlined
def turns_round(row, before, after, normal, d):
    """Ask for a substep that ends where a sticking pair, stretched as `before` and `after` it, just holds
    nothing: on the way back it is pressed by nothing where it touched first, too, and opens there.

    Not where the `normal` force is larger than what it holds.
    """
    square, along, other = 0.0, 0.0, 0.0
    for i in range(3):
        square += before[i] * before[i]
        along -= before[i] * after[i]
        other += after[i] * after[i]
    turns = along > TURNED * square and square > (FINEST * d) ** 2
    if turns and normal < row.stiffness * math.sqrt(other):
        row.cut = min(row.cut, (1.0 + 0.5 * TURNED) / (1.0 + along / square))


@inlined
def touches_again(row, before, after, d):
    """Set the share of a release after which an opening pair just touches again."""
    near = (1.0 - 0.5 * OPEN) * d
    row.cut = (before - near) / (before - after) if after < (1.0 - OPEN) * d else 1.0


@inlined
def goes_on(row, length, gap, d):
    """What a pair that sticks does after an accepted state, in which it is stretched by a length.

    Where it has opened it is released, unless it has touched just now: it is no better located. Where it then
    touches again it grazes: it gives way so that it just touches, until it is pressed and sticks. Returns
    whether it is held without touching.
    """
    if row.grazes:
        row.closed = gap < GRAZING * d
        row.grazes = row.closed and gap >= -OPEN * d
    elif row.opening and gap < 0.0:
        row.opening, row.grazes, row.gap = False, True, gap
    elif not row.fresh and gap >= (0.0 if row.opening else TOUCHING * d):
        row.closed = row.opening = length > 0.0
    row.fresh, row.kept, row.before = False, 1.0 - row.released, length
    row.held = row.kept * row.stiffness * length if row.opening or row.grazes else 0.0
    return row.closed and gap >= 0.0


@inlined
def gave_way(length, row, gap):
    """Take what a pair that sticks gave way into its history; returns how far it is stretched.

    What was lost on the way from the force and stretch (T0, s0) to (T1, s1), on which one falls as the other
    grows, is the area (T0 s1 - T1 s0) / 2. A pair that touches then sticks with the whole stiffness: the
    stretch that its force needs no more is slip, and its energy lost.
    """
    row.slip, K, ahead = 0.0, row.stiffness, row.ahead
    row.stride, row.wanted, row.ahead = 0.0, 0.0, 0.0
    if row.released == 0.0:
        return length
    force = (1.0 - row.released) * K * length
    row.work += 0.5 * (row.held * length - force * row.before)
    if row.opening and gap >= 0.0 and force > 0.0:
        return length
    row.work += 0.5 * force * (length - force / K) + 0.5 * (row.held + force) * ahead
    row.slip = length - force / K + ahead
    row.slid += row.slip
    row.stride = row.slip if row.grazes else 0.0
    row.released = 0.0
    return force / K


@inlined
def update_bound(length, bound, d, row):
    """Set the bound of a held pair so that it is `bound` at its present slip.

    Returns the change: of the bound where the pair slides with one of the two, else of the force. Where hard
    contact just touches, the slip at the bound would be less than rounding leaves of positions: the pair is
    softer there.
    """
    before, slides = row.stiffness, row.stiffness * length > row.bound
    if bound < math.inf:
        row.stiffness = min(row.whole, bound / (FINEST * d)) if bound > 0.0 else row.whole
        row.slip = length - bound / row.stiffness
        slides = slides or row.slip > 0.0
        bound /= max(1.0 + row.rise * max(row.slip, 0.0), LEAST_LEFT)
    change = abs(bound - row.bound) if slides and bound != row.bound else abs(row.stiffness - before) * length
    row.bound = bound
    return change
