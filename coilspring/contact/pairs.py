"""What contact remembers of all pairs: updated as a trial state is found, and as it is accepted."""

import math
from typing import Any, NamedTuple

import numpy as np

from coilspring.compiling.compiled import inlined, lent
from coilspring.contact.law import normal_law
from coilspring.contact.transitions import (
    first_touch,
    gave_way,
    goes_on,
    grazing_slip,
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


class Geometry(NamedTuple):
    """What is to be known of pairs of one kind, as functions of their law, and of what is `there`: the places
    of all in a state. `row` is the record of the pair m, `direction` its slip or the direction of that."""

    weight: Any  # (law, m): stiffness of the pair over that of the law
    distance: Any  # (law, there, m): law.d where the pair touches
    facing: Any  # (law, there, m, v, points): fill v (3,), d long where it touches, and what faces there (6,)
    refer: Any  # (row, points): hold it from where these faced each other
    slip: Any  # (law, there, m, row, e): length of its slip, and `direction`; e (3,) is scratch
    error: Any  # (law, predicted, there, m, row, direction): how far that is from the predicted one
    bound: Any  # (law, h, normal, slope): bound of its friction, and how that grows with its penetration
    lead: Any  # (row): move its reference on, along its last slide, as it is wanted
    ahead: Any  # (law, there, m, row, direction, length): part of its lead along the slip, mm
    hold: Any  # (law, there, m, row, direction, length, left): move its reference to where `left` is left


@inlined
def _touch(geometry, law, places, m, row):
    """Hold a pair from where it touches first: on the predicted way where that touches, and what the straight
    one differs from it there is in doubt. Else the rest of the way is; all of it where the pair sticks, since
    contact bends it."""
    d, v, points = law.d, np.empty((3, 3)), np.empty((3, 6))
    for i in range(3):
        geometry.facing(law, places[i], m, v[i], points[i])
    predicted = v[1, 0] ** 2 + v[1, 1] ** 2 + v[1, 2] ** 2 < d * d
    far = 1 if predicted else 2
    at, other = first_touch(v[0], v[far], d), first_touch(v[0], v[2], d)
    unknown, touching = 1.0 if law.mu == math.inf else 1.0 - at, np.empty(6)
    doubt, square = np.zeros(3), 0.0
    for i in range(6):
        change = points[2, i] - points[0, i]
        touching[i] = points[0, i] + at * (points[far, i] - points[0, i])
        left = points[0, i] + other * change - touching[i] if predicted else change * unknown
        doubt[i % 3] += left if i < 3 else -left
    for i in range(3):
        square += doubt[i] * doubt[i]
    geometry.refer(row, touching)
    touches_first(row, law, geometry.weight(law, m), at, math.sqrt(square), predicted or law.mu < math.inf)


@inlined
def accept(geometry, law, there, history):
    """Update the contact history with an accepted state; returns the least gap of all pairs.

    With sticking contact or friction a pair that touches is held from where it touched first. One that slid
    keeps the stretch that its bound allows. One that has opened releases what it holds.
    """
    least, e, there = math.inf, np.empty(3), lent(there)
    for m in range(history.shape[0]):
        row, gap = history[m], geometry.distance(law, there, m) - law.d
        least = min(least, gap)
        if law.mu == 0.0 or not (row.closed or gap < touching_gap(law)):
            continue
        if not row.closed:
            _touch(geometry, law, (there, there, there), m, row)
        grazed, (length, direction) = row.grazes, geometry.slip(law, there, m, row, e)
        if law.mu < math.inf:
            left = slid(length, row, gap)
        else:
            left = gave_way(length, row, gap)
            if goes_on(row, left, gap, law.d):
                least = min(least, 0.0)
        if row.lead > 0.0:
            geometry.lead(row)
        if left == length:  # it gave way by no more than rounding
            row.stride = 0.0
        if left < length or grazed or row.grazes:
            geometry.hold(law, there, m, row, direction, length, left)
    return least


@inlined
def _along(slip, direction):
    """Part of a slip, its length and direction or vector, along the direction of another one."""
    length, own = slip
    square = own[0] * own[0] + own[1] * own[1] + own[2] * own[2]
    other = direction[0] * direction[0] + direction[1] * direction[1] + direction[2] * direction[2]
    if square * other == 0.0:
        return 0.0
    cosine = own[0] * direction[0] + own[1] * direction[1] + own[2] * direction[2]
    return length * cosine / math.sqrt(square * other)


@inlined
def update(geometry, law, places, history):
    """Update the contact history with a trial state, from what is there in the accepted, the predicted and
    the trial state: which pairs touch since, and where they did first; and the bounds of the tangential
    forces. Returns the largest change over the largest force.
    """
    places = lent(places)
    before, ahead, there = places
    d, mu, e = law.d, law.mu, np.empty(3)
    change, most = 0.0, min(mu, 1.0) * normal_law(SLIGHT * d, law.kc, law.k)[1]
    for m in range(history.shape[0]):
        row, h = history[m], geometry.distance(law, there, m)
        if not (row.closed or h < d):
            continue
        new, row.gap = not row.closed, h - d
        if new:
            _touch(geometry, law, places, m, row)
        elif row.wanted != row.lead:
            geometry.lead(row)
        if row.opening:
            touches_again(row, geometry.distance(law, before, m), h, d)
            continue
        length, direction = geometry.slip(law, there, m, row, e)
        if row.grazes:
            row.sticking = row.stiffness * length
            if row.lead > 0.0 and not leads(row, grazing_slip(row)):
                change = max(change, row.stiffness * row.lead * row.stride)
                geometry.lead(row)
                length, direction = geometry.slip(law, there, m, row, e)
                row.sticking = row.stiffness * length
            row.ahead = geometry.ahead(law, there, m, row, direction, length)
            continue
        if new:
            change = max(change, row.stiffness * length)
            row.released = 1.0 if mu == math.inf and geometry.distance(law, ahead, m) < d else 0.0
        elif row.fresh and geometry.distance(law, ahead, m) < d:
            error = geometry.error(law, ahead, there, m, row, direction)
            was_free = predicted_badly(row, error, located_to(mu) * d)
            change = max(change, was_free * row.stiffness * d)
        _, normal, slope = normal_law(max(d - h, 0.0), geometry.weight(law, m) * law.kc, law.k)
        most = max(most, min(mu, 1.0) * normal)
        if mu == math.inf:
            opens_after(row, geometry.distance(law, before, m), geometry.distance(law, ahead, m), h, d)
            if not row.fresh:
                _, held = geometry.slip(law, before, m, row, e)
                turns_round(row, held, direction, normal, d)
            continue
        bound, steepness = geometry.bound(law, h, normal, slope)
        row.steepness = steepness if h < d else 0.0
        change = max(change, update_bound(length, bound, d, row))
        if row.lead > 0.0 and not leads(row, row.slip):
            geometry.lead(row)
            length, direction = geometry.slip(law, there, m, row, e)
            change = max(change, bound, update_bound(length, bound, d, row))
        if not row.fresh:
            row.before = _along(geometry.slip(law, before, m, row, e), direction)
        row.ahead = geometry.ahead(law, there, m, row, direction, length)
    return change / most if change > 0.0 else 0.0
