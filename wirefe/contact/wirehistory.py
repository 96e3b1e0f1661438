"""Contact history of wires: what `coilspring.contact.kinematics` does for spheres, by material points."""

import math

import numpy as np

from coilspring.compiling.compiled import inlined
from coilspring.contact.kinematics import SLIGHT
from coilspring.contact.law import normal_law
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
from wirefe.contact.wires import between_sections, gap, placed, tangential_slip, touches, touching_points
from wirefe.element.algebra import dot, plus


@inlined
def _distance(contact, points, m):
    """Distance of two wires across their gap, longer by what they run into each other at rest: d where they
    touch."""
    return gap(contact, points, m)[0] + contact.rest_overlap[m]


@inlined
def _touch(contact, states, m, row):
    """See `coilspring.contact.kinematics`; `states`: accepted, predicted, trial one, with their stations."""
    there, d = np.empty((3, 6)), contact.d
    v = np.empty((3, 3))
    for i in range(3):
        state, points = states[i]
        h, (_, n, _, _, _) = _distance(contact, points, m), gap(contact, points, m)
        v[i, 0], v[i, 1], v[i, 2] = h * n[0], h * n[1], h * n[2]
        touching_points(contact, points, state, m, (0.0, 0.0, 0.0), there[i])
    predicted = v[1, 0] ** 2 + v[1, 1] ** 2 + v[1, 2] ** 2 < d * d
    far = 1 if predicted else 2
    at, other = first_touch(v[0], v[far], d), first_touch(v[0], v[2], d)
    unknown = 1.0 if contact.mu == math.inf else 1.0 - at
    doubt, apart = np.zeros(3), 0.0
    for i in range(6):
        way = there[2, i] - there[0, i]
        row.arms[i] = there[0, i] + at * (there[far, i] - there[0, i])
        left = there[0, i] + other * way - row.arms[i] if predicted else way * unknown
        doubt[i % 3] += left if i < 3 else -left
    for i in range(3):
        apart += doubt[i] * doubt[i]
        row.normal[i] = v[2, i]
    touches_first(row, contact, at, math.sqrt(apart), predicted or contact.mu < math.inf)


@inlined
def accept_wire_history(contact, state, history):
    """See `coilspring.contact.kinematics.accept_history`."""
    least, points = np.inf, placed(contact, state)
    here = (state, points)
    for m in range(history.shape[0]):
        row = history[m]
        h, (_, n, _, _, _) = _distance(contact, points, m), gap(contact, points, m)
        gap_left = h - contact.d
        least = min(least, gap_left)
        if not (row.closed or gap_left < touching_gap(contact)):
            continue
        if not row.closed:
            _touch(contact, (here, here, here), m, row)
        row.normal[0], row.normal[1], row.normal[2] = n
        length, way = tangential_slip(contact, points, state, m, row)
        left = length
        if contact.mu == np.inf:
            left = gave_way(length, row, gap_left)
            if goes_on(row, left, gap_left, contact.d):
                least = min(least, 0.0)
        elif slid(length, row, gap_left):
            left = row.bound / row.stiffness
        if row.lead > 0.0:
            _lead(row)
        if left < length:
            for i in range(6):
                row.onward[i] = row.arms[i]
            touching_points(contact, points, state, m, plus(way, left / length - 1.0, way), row.arms)
            for i in range(6):
                row.onward[i] = row.arms[i] - row.onward[i]
    return least


@inlined
def _lead(row):
    """Move the reference of a pair on, along its last slide, as it is wanted."""
    for i in range(6):
        row.arms[i] += (row.wanted - row.lead) * row.onward[i]
    row.lead = row.wanted


@inlined
def _ahead(contact, state, m, row, way, length):
    """By how much the reference of a pair is ahead, along the slide at hand."""
    if row.lead == 0.0 or length == 0.0:
        return 0.0
    return -row.lead * dot(between_sections(contact, state, m, row.onward), way) / length


@inlined
def update_wires(contact, accepted, predicted, state, history):
    """See `coilspring.contact.kinematics.update_pairs`."""
    points, before = placed(contact, state), placed(contact, accepted)
    ahead = placed(contact, predicted)
    states = ((accepted, before), (predicted, ahead), (state, points))
    least_bound = min(contact.mu, 1.0)
    change, most = 0.0, least_bound * normal_law(SLIGHT * contact.d, contact.kc, contact.k)[1]
    for m in range(history.shape[0]):
        row = history[m]
        if not (row.opening or row.closed or row.creeps or touches(contact, points, m)):
            continue
        h, d = _distance(contact, points, m), contact.d
        if (row.opening or row.creeps) and row.wanted != row.lead:
            _lead(row)
        if row.opening:
            touches_again(row, _distance(contact, before, m), h, d)
        elif row.creeps:
            length, way = tangential_slip(contact, points, state, m, row)
            row.gap, row.sticking = h - d, row.stiffness * length
            if row.lead > 0.0 and not leads(row, creep_slip(row)):
                change = max(change, row.stiffness * row.lead * row.stride)
                _lead(row)
                length, way = tangential_slip(contact, points, state, m, row)
                row.sticking = row.stiffness * length
            row.ahead = _ahead(contact, state, m, row, way, length)
        if row.opening or row.creeps:
            continue
        new = not row.closed
        if new:
            _touch(contact, states, m, row)
        if row.wanted != row.lead:
            _lead(row)
        length, way = tangential_slip(contact, points, state, m, row)
        if new:
            change = max(change, row.stiffness * length)
            row.released = 1.0 if contact.mu == np.inf and _distance(contact, ahead, m) < d else 0.0
        elif row.fresh and _distance(contact, ahead, m) < d:
            _, expected = tangential_slip(contact, ahead, predicted, m, row)
            error = plus(way, -1.0, expected)
            was_free = predicted_badly(row, math.sqrt(dot(error, error)), located_to(contact.mu) * d)
            change = max(change, was_free * row.stiffness * d)
        _, normal, slope = normal_law(max(d - h, 0.0), contact.kc, contact.k)
        most, row.gap = max(most, least_bound * normal), h - d
        if contact.mu == np.inf:
            opens_after(row, _distance(contact, before, m), _distance(contact, ahead, m), h, d)
            if not row.fresh:
                _, held = tangential_slip(contact, before, accepted, m, row)
                turns_round(row, held, way, normal, d)
        else:
            bound = contact.mu * normal
            row.steepness = contact.mu * slope if h < d else 0.0
            change = max(change, update_bound(length, bound, contact, row))
            if row.lead > 0.0 and not leads(row, row.slip):
                _lead(row)
                length, way = tangential_slip(contact, points, state, m, row)
                change = max(change, bound, update_bound(length, bound, contact, row))
            row.ahead = _ahead(contact, state, m, row, way, length)
    return change / most if change > 0.0 else 0.0
