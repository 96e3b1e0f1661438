"""Pairs of wires as contact remembers them: by the material points that touched first."""

import math

from coilspring.compiling.compiled import inlined
from coilspring.contact.pairs import Geometry
from wirefe.contact.wires import between_sections, gap, placed, tangential_slip, touching_points
from wirefe.element.algebra import dot, plus


@inlined
def wires():
    """Pairs of wires, by what is `standing` in a state."""
    return Geometry(_weight, _distance, _facing, _refer, _slip, _error, _bound, _lead, _ahead, _hold)


@inlined
def standing(contact, state):
    """A state, and the places of all stations in it."""
    return state, placed(contact, state)


@inlined
def _weight(contact, m):
    """Stiffness of a pair over that of the law."""
    return contact.weights[m]


@inlined
def _distance(contact, there, m):
    """Distance across the gap, longer by what the wires run into each other at rest."""
    return gap(contact, there[1], m)[0] + contact.rest_overlap[m]


@inlined
def _facing(contact, there, m, v, points):
    h, (_, n, _, _, _) = _distance(contact, there, m), gap(contact, there[1], m)
    v[0], v[1], v[2] = h * n[0], h * n[1], h * n[2]
    touching_points(contact, there[1], there[0], m, (0.0, 0.0, 0.0), points)


@inlined
def _refer(row, points):
    for i in range(6):
        row.arms[i] = points[i]


@inlined
def _slip(contact, there, m, row, e):
    return tangential_slip(contact, there[1], there[0], m, row)


@inlined
def _error(contact, predicted, there, m, row, direction):
    _, expected = tangential_slip(contact, predicted[1], predicted[0], m, row)
    error = plus(direction, -1.0, expected)
    return math.sqrt(dot(error, error))


@inlined
def _bound(contact, h, normal, slope):
    return contact.mu * normal, contact.mu * slope


@inlined
def _lead(row):
    for i in range(6):
        row.arms[i] += (row.wanted - row.lead) * row.onward[i]
    row.lead = row.wanted


@inlined
def _ahead(contact, there, m, row, direction, length):
    if row.lead == 0.0 or length == 0.0:
        return 0.0
    return -row.lead * dot(between_sections(contact, there[0], m, row.onward), direction) / length


@inlined
def _hold(contact, there, m, row, direction, length, left):
    if left == length:
        return
    for i in range(6):
        row.onward[i] = row.arms[i]
    back = plus(direction, left / length - 1.0, direction)
    touching_points(contact, there[1], there[0], m, back, row.arms)
    for i in range(6):
        row.onward[i] = row.arms[i] - row.onward[i]
