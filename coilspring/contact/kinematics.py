"""What kernels do with the vectors between the centres of all pairs, (pairs, 3)."""

import math

import numpy as np

from coilspring.compiling.compiled import inlined
from coilspring.contact.law import arc, stretch
from coilspring.contact.pairs import Geometry
from coilspring.contact.transitions import located_to

TOUCH = 0.002  # wire diameters by which a pair that nothing holds may penetrate where a prediction closes it
OVERLAP_ALLOWED = 0.1  # wire diameters by which wires may overlap more than the deepest pair does
APART = 4e-6  # wire diameters: a pair that sticks and is nearer has just opened, or grazes
BETWEEN = 2.0  # told in place of a share of the way, of which 1 is the largest
NEAR = 1.5  # wire diameters between centres, within which a pair's motion in a substep is watched


@inlined
def spheres():
    """Pairs of spheres or circles, by the vectors between their centres in a state."""
    return Geometry(_weight, _distance, _facing, _refer, _slip, _error, _bound, _lead, _ahead, _hold)


@inlined
def _weight(law, m):
    """Stiffness of a pair over that of the law: all are as stiff."""
    return 1.0


@inlined
def _distance(law, vectors, m):
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
def _facing(law, vectors, m, v, points):
    for i in range(3):
        v[i], points[i], points[3 + i] = vectors[m, i], vectors[m, i], 0.0


@inlined
def _refer(row, points):
    h = math.sqrt(points[0] ** 2 + points[1] ** 2 + points[2] ** 2)
    for i in range(3):
        row.vector[i], row.normal[i] = points[i], points[i] / h


@inlined
def _slip(law, vectors, m, row, e):
    """How far a pair that sticks is stretched; of others the arc, and its direction."""
    if row.grazes or law.mu < math.inf:
        length = law.d * arc(vectors[m], _distance(law, vectors, m), row, e)
    else:
        length = stretch(vectors[m], row, e)
    return length, (e[0], e[1], e[2])


@inlined
def _error(law, predicted, vectors, m, row, direction):
    along, square = 0.0, 0.0
    for i in range(3):
        along += row.normal[i] * (vectors[m, i] - predicted[m, i])
    for i in range(3):
        square += (vectors[m, i] - predicted[m, i] - along * row.normal[i]) ** 2
    return math.sqrt(square)


@inlined
def _bound(law, h, normal, slope):
    """At the arm d instead of h, on which arcs are measured."""
    return law.mu * normal * h / law.d, law.mu * (slope * h - normal) / law.d


@inlined
def _lead(row):
    """Along the great circle of its last slide."""
    size = math.sqrt(row.onward[0] ** 2 + row.onward[1] ** 2 + row.onward[2] ** 2)
    angle = (row.wanted - row.lead) * size
    for i in range(3):
        n, t = row.normal[i], row.onward[i] / size
        row.normal[i] = math.cos(angle) * n + math.sin(angle) * t
        row.onward[i] = (math.cos(angle) * t - math.sin(angle) * n) * size
    row.lead = row.wanted


@inlined
def _ahead(law, vectors, m, row, direction, length):
    onward = row.onward
    along = direction[0] * onward[0] + direction[1] * onward[1] + direction[2] * onward[2]
    return row.lead * law.d * along


@inlined
def _hold(law, vectors, m, row, direction, length, left):
    """By an arc where it slides or grazes, else by the vector that it would have without a stretch."""
    g, h = vectors[m], _distance(law, vectors, m)
    if law.mu < math.inf:
        angle = row.bound / (row.stiffness * law.d)
        for i in range(3):
            row.vector[i] = math.cos(angle) * g[i] / h - math.sin(angle) * direction[i]
        _turn(row, row.vector)
        return
    along, square, e = 0.0, 0.0, np.empty(3)
    for i in range(3):
        along += direction[i] * g[i] / h
    for i in range(3):
        e[i] = direction[i] - along * g[i] / h
        square += e[i] * e[i]
    size = math.sqrt(square) if square > 0.0 else 1.0
    angle = left / law.d if row.grazes else 0.0
    for i in range(3):
        row.onward[i] = math.cos(angle) * g[i] / h - math.sin(angle) * e[i] / size
        row.vector[i] = g[i] - left * e[i] / size
    _turn(row, row.onward)


@inlined
def _turn(row, normal):
    """Turn the reference of a pair to a direction."""
    t = np.empty(3)
    angle = arc(normal, 1.0, row, t)
    for i in range(3):
        row.normal[i], row.onward[i] = normal[i], angle * t[i]
    if angle == 0.0:  # by no more than rounding
        row.stride = 0.0
