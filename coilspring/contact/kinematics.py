"""What kernels do with the vectors between the centres of all pairs, (pairs, 3)."""

import math

import numpy as np

from coilspring.compiling.compiled import inlined
from coilspring.contact.law import arc, normal_law, stretch
from coilspring.contact.touching import (
    creep_slip,
    first_touch,
    gave_way,
    goes_on,
    leads,
    located_to,
    opens_after,
    predicted_badly,
    slid,
    touches_again,
    touches_first,
    touching_gap,
    turns_round,
    update_bound,
)

SLIGHT = 1e-7  # wire diameters of penetration: its force is the least that friction bounds are compared with
TOUCH = 0.002  # wire diameters by which a pair that nothing holds may penetrate where a prediction closes it
OVERLAP_ALLOWED = 0.1  # wire diameters by which wires may overlap more than the deepest pair does
APART = 4e-6  # wire diameters: a pair that sticks and is nearer has just opened, or creeps
BETWEEN = 2.0  # told in place of a share of the way, of which 1 is the largest
NEAR = 1.5  # wire diameters between centres, within which a pair's motion in a substep is watched


@inlined
def _distance(vectors, m):
    return math.sqrt(vectors[m, 0] ** 2 + vectors[m, 1] ** 2 + vectors[m, 2] ** 2)


@inlined
def approach(before, after, d, mu):
    """Largest motion of a pair that comes near, and the share of it to where the first one touches: 1 where
    none does, `BETWEEN` where one that sticks does so on the straight way and is open at its end.

    A pair counts if it comes near anywhere between: wires must not pass through each other.
    """
    passes, outer = False, ((1.0 + APART) * d) ** 2
    most, free, inner = 0.0, 1.0, ((1.0 - (TOUCH if mu == 0.0 else located_to(mu))) * d) ** 2
    for m in range(before.shape[0]):
        v0, v1, v2 = before[m, 0], before[m, 1], before[m, 2]
        w0, w1, w2 = after[m, 0], after[m, 1], after[m, 2]
        x0, x1, x2 = w0 - v0, w1 - v1, w2 - v2
        start, square = v0 * v0 + v1 * v1 + v2 * v2, x0 * x0 + x1 * x1 + x2 * x2
        along = -(v0 * x0 + v1 * x1 + v2 * x2)
        nearest = min(along / square, 1.0) if along > 0.0 else 0.0
        least = start + nearest * (nearest * square - 2.0 * along)
        end = w0 * w0 + w1 * w1 + w2 * w2
        if start >= d * d and end < inner:
            # first share with |v + share x|^2 = inner
            free = min(free, (along - math.sqrt(max(along**2 - square * (start - inner), 0.0))) / square)
        passes = passes or (start > outer and least < inner and mu == math.inf)
        if square > most * most and least < (NEAR * d) ** 2:
            most = math.sqrt(square)
    return most, BETWEEN if passes and free == 1.0 else free


@inlined
def _touch(row, before, ahead, after, law):
    """Hold a pair from where it touches first: on the predicted way where that touches, and what the straight
    one differs from it there is in doubt. Else the rest of the way is; all of it where the pair sticks, since
    contact bends it."""
    d = law.d
    e, doubt = np.empty(3), 0.0
    predicted = ahead[0] ** 2 + ahead[1] ** 2 + ahead[2] ** 2 < d * d
    at, other = first_touch(before, ahead if predicted else after, d), first_touch(before, after, d)
    unknown = 1.0 if law.mu == math.inf else 1.0 - at
    for i in range(3):
        way = after[i] - before[i]
        e[i] = before[i] + at * ((ahead[i] if predicted else after[i]) - before[i])
        left = before[i] + other * way - e[i] if predicted else way * unknown
        doubt += left * left
    h = math.sqrt(e[0] ** 2 + e[1] ** 2 + e[2] ** 2)
    for i in range(3):
        row.vector[i] = e[i]
        row.normal[i] = e[i] / h
    touches_first(row, law, at, math.sqrt(doubt), predicted or law.mu < math.inf)


@inlined
def _across(normal, a, b):
    """Distance of two vectors across a direction."""
    along, square = 0.0, 0.0
    for i in range(3):
        along += normal[i] * (b[i] - a[i])
    for i in range(3):
        square += (b[i] - a[i] - along * normal[i]) ** 2
    return math.sqrt(square)


@inlined
def _stretched(g, h, d, row, e):
    """How far a pair that sticks is stretched, and `e` along that: of one that creeps the arc."""
    return d * arc(g, h, row, e) if row.creeps else stretch(g, row, e)


@inlined
def _hold(row, g, h, d, length, e):
    """Hold a pair so that it is stretched by a length across its direction now, as it is along `e`."""
    along, square = 0.0, 0.0
    for i in range(3):
        along += e[i] * g[i] / h
    for i in range(3):
        e[i] -= along * g[i] / h
        square += e[i] * e[i]
    size = math.sqrt(square) if square > 0.0 else 1.0
    angle = length / d if row.creeps else 0.0
    for i in range(3):
        row.onward[i] = math.cos(angle) * g[i] / h - math.sin(angle) * e[i] / size
        row.vector[i] = g[i] - length * e[i] / size
    _turn(row, row.onward, e)


@inlined
def _lead(row):
    """Turn the reference of a pair on, along the great circle of its last slide, as it is wanted."""
    size = math.sqrt(row.onward[0] ** 2 + row.onward[1] ** 2 + row.onward[2] ** 2)
    angle = (row.wanted - row.lead) * size
    for i in range(3):
        n, t = row.normal[i], row.onward[i] / size
        row.normal[i] = math.cos(angle) * n + math.sin(angle) * t
        row.onward[i] = (math.cos(angle) * t - math.sin(angle) * n) * size
    row.lead = row.wanted


@inlined
def _ahead(row, d, e):
    """Part along a slide `e`, mm, of how far the reference of a pair is ahead."""
    return row.lead * d * (e[0] * row.onward[0] + e[1] * row.onward[1] + e[2] * row.onward[2])


@inlined
def _slide(row, g, h, left, t):
    """Move the reference of a pair after its direction now, to an angle `left` behind it along `t`."""
    if row.lead > 0.0:
        _lead(row)
    for i in range(3):
        row.vector[i] = math.cos(left) * g[i] / h - math.sin(left) * t[i]
    _turn(row, row.vector, t)


@inlined
def _turn(row, normal, t):
    """Turn the reference of a pair to a direction."""
    angle = arc(normal, 1.0, row, t)
    for i in range(3):
        row.normal[i], row.onward[i] = normal[i], angle * t[i]
    if angle == 0.0:  # by no more than rounding
        row.stride = 0.0


@inlined
def accept_history(vectors, history, law):
    """Update the contact history with an accepted state; returns the least gap of all pairs.

    With sticking contact or friction a pair that touches is held from where it touched first. One that slid
    keeps the stretch that its bound allows. One that has opened releases what it holds.
    """
    least, d, e = np.inf, law.d, np.empty(3)
    for m in range(vectors.shape[0]):
        h, row = _distance(vectors, m), history[m]
        least = min(least, h - d)
        if law.mu == 0.0 or not (row.closed or h - d < touching_gap(law)):
            continue
        if not row.closed:
            _touch(row, vectors[m], vectors[m], vectors[m], law)
        if law.mu < np.inf:
            length = d * arc(vectors[m], h, row, e)
            if slid(length, row, h - d):
                _slide(row, vectors[m], h, row.bound / (row.stiffness * d), e)
            continue
        crept, length = row.creeps, _stretched(vectors[m], h, d, row, e)
        left = gave_way(length, row, h - d)
        if goes_on(row, left, h - d, d):
            least = min(least, 0.0)
        if row.lead > 0.0:
            _lead(row)
        if left < length or crept or row.creeps:
            _hold(row, vectors[m], h, d, left, e)
    return least


@inlined
def update_pairs(before, ahead, vectors, history, law):
    """Update the contact history with a trial state, from the pairs' vectors in the accepted, the predicted
    and the trial state: which pairs touch since, and where they did first; and the bounds of the tangential
    forces. Returns the largest change over the largest force.
    """
    mu, d, e, held = law.mu, law.d, np.empty(3), np.empty(3)
    change, most = 0.0, min(mu, 1.0) * normal_law(SLIGHT * d, law.kc, law.k)[1]
    for m in range(vectors.shape[0]):
        h, row = _distance(vectors, m), history[m]
        if (row.opening or row.creeps) and row.wanted != row.lead:
            _lead(row)
        if row.opening:
            touches_again(row, _distance(before, m), h, d)
        elif row.creeps:
            row.gap, row.sticking = h - d, row.stiffness * _stretched(vectors[m], h, d, row, e)
            if row.lead > 0.0 and not leads(row, creep_slip(row)):
                change = max(change, row.stiffness * row.lead * row.stride)
                _lead(row)
                row.sticking = row.stiffness * _stretched(vectors[m], h, d, row, e)
            row.ahead = _ahead(row, d, e)
        if row.opening or row.creeps or not (row.closed or h < d):
            continue
        if not row.closed:
            _touch(row, before[m], ahead[m], vectors[m], law)
            change = max(change, row.stiffness * stretch(vectors[m], row, e))
            row.released = 1.0 if mu == np.inf and _distance(ahead, m) < d else 0.0
        elif row.fresh and _distance(ahead, m) < d:
            error = _across(row.normal, ahead[m], vectors[m])
            was_free = predicted_badly(row, error, located_to(mu) * d)
            change = max(change, was_free * row.stiffness * d)
        _, normal, slope = normal_law(max(d - h, 0.0), law.kc, law.k)
        most, row.gap = max(most, min(mu, 1.0) * normal), h - d
        if mu == np.inf:
            opens_after(row, _distance(before, m), _distance(ahead, m), h, d)
            if not row.fresh:
                stretch(before[m], row, held)
                stretch(vectors[m], row, e)
                turns_round(row, held, e, normal, d)
            continue
        if row.wanted != row.lead:
            _lead(row)
        # at the arm d instead of h, on which arcs are measured
        bound = mu * normal * h / d
        row.steepness = mu * (slope * h - normal) / d if h < d else 0.0
        change = max(change, update_bound(d * arc(vectors[m], h, row, e), bound, law, row))
        if row.lead > 0.0 and not leads(row, row.slip):
            _lead(row)
            change = max(change, bound, update_bound(d * arc(vectors[m], h, row, e), bound, law, row))
        row.ahead = _ahead(row, d, e)
    return change / most if change > 0.0 else 0.0
