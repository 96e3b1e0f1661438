"""Contact of wires: the gap is taken across both, and slips are those of material points of the sections.

Of a pair of stations, with w from the first to the second and tau the sum of their unit tangents,

    u = tau / |tau|,   s = w . u,   h n = w - s u,   |n| = 1,

h is the distance of two wires that are straight and parallel, or curved alike, whichever of their points
face each other. What sticks or rubs is the slip of the two material points that touched first.
"""

import math

import numpy as np

from coilspring.compiling.compiled import arithmetic, inlined
from wirefe.contact.stations import ROTATION, fill_stations
from wirefe.element.algebra import dot, plus
from wirefe.element.poses import ROW, four, three, three_of
from wirefe.element.rotations import conjugate, turned

ROUNDS = 4  # to find a section's vector: rotations of its two nodes differ little


@arithmetic
def placed(contact, state):
    """Positions and tangents of all stations, shape (stations, 6)."""
    points = np.empty((contact.attached.size, 6))
    fill_stations(contact.attached, contact.parts, state, points)
    return points


@arithmetic
def facing(points, a, b):
    """w and tau of two stations."""
    w = plus(three_of(points, b, 0), -1.0, three_of(points, a, 0))
    return w, plus(three_of(points, b, 3), 1.0, three_of(points, a, 3))


@arithmetic
def gap(contact, points, m):
    """h, n, u, s and |tau| of a pair."""
    w, tau = facing(points, contact.pairs[m, 0], contact.pairs[m, 1])
    return gap_of(w, tau)


@arithmetic
def gap_of(w, tau):
    """The same by w and tau."""
    length = math.sqrt(dot(tau, tau))
    u = (tau[0] / length, tau[1] / length, tau[2] / length)
    s = dot(w, u)
    across = plus(w, -s, u)
    h = math.sqrt(dot(across, across))
    return h, (across[0] / h, across[1] / h, across[2] / h), u, s, length


@arithmetic
def across(contact, points, m):
    """Vector across the gap of a pair, of the length of the gap and d."""
    w, tau = facing(points, contact.pairs[m, 0], contact.pairs[m, 1])
    v = plus(w, -dot(w, tau) / dot(tau, tau), tau)
    if contact.rest_overlap[m] == 0.0:
        return v
    return plus(v, contact.rest_overlap[m] / math.sqrt(dot(v, v)), v)


@arithmetic
def touches(contact, points, m):
    """Whether a pair's gap is below d."""
    v = across(contact, points, m)
    return dot(v, v) < contact.d**2


@arithmetic
def section_turned(contact, state, k, v):
    """A vector fixed to the section of a station, at rest `v`, as turned now."""
    i, share = ROW * contact.attached[k], contact.parts[k, ROTATION]
    low = turned(four(state, i + 3), v)
    if share == 0.0:
        return low
    return plus(plus(low, -share, low), share, turned(four(state, i + ROW + 3), v))


@arithmetic
def section_at_rest(contact, state, k, v):
    """The vector at rest that `section_turned` makes `v`."""
    i, share = ROW * contact.attached[k], contact.parts[k, ROTATION]
    rest = (0.0, 0.0, 0.0)
    for _ in range(ROUNDS):
        left = plus(v, -1.0, section_turned(contact, state, k, rest))
        low = turned(conjugate(four(state, i + 3)), left)
        if share != 0.0:
            low = plus(plus(low, -share, low), share, turned(conjugate(four(state, i + ROW + 3)), left))
        rest = plus(rest, 1.0, low)
    return rest


@arithmetic
def touching_points(contact, points, state, m, back, out):
    """Write to `out` (6,) the material points at rest that face each other now, less a slip `back` (3)."""
    h, n, u, s, _ = gap(contact, points, m)
    half = plus((0.5 * h * n[0], 0.5 * h * n[1], 0.5 * h * n[2]), 0.5 * s, u)
    half = plus(half, -0.5, back)
    a = section_at_rest(contact, state, contact.pairs[m, 0], half)
    b = section_at_rest(contact, state, contact.pairs[m, 1], (-half[0], -half[1], -half[2]))
    out[0], out[1], out[2] = a
    out[3], out[4], out[5] = b


@arithmetic
def slip(contact, points, state, m, arms):
    """Vector xi between the material points whose places in the sections at rest are `arms` (6,)."""
    a, b = contact.pairs[m, 0], contact.pairs[m, 1]
    apart = plus(three(points[b], 0), -1.0, three(points[a], 0))
    return plus(apart, 1.0, between_sections(contact, state, m, arms))


@arithmetic
def between_sections(contact, state, m, arms):
    """Vector from the first to the second of `arms` (6,), fixed to the sections of a pair, as turned now."""
    a = section_turned(contact, state, contact.pairs[m, 0], three(arms, 0))
    return plus(section_turned(contact, state, contact.pairs[m, 1], three(arms, 3)), -1.0, a)


@inlined
def tangential_slip(contact, points, state, m, row):
    """Length of the part of a pair's slip across n, and that part."""
    _, n, _, _, _ = gap(contact, points, m)
    vector = slip(contact, points, state, m, row.arms)
    vector = plus(vector, -dot(vector, n), n)
    return math.sqrt(dot(vector, vector)), vector
