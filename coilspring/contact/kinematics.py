"""What kernels do with the vectors between the centres of all pairs, (pairs, 3)."""

from __future__ import annotations

import math

import numpy as np

from coilspring.compiling.compiled import part
from coilspring.contact.law import arc, hold, normal_law, renewed

SLIGHT = 1e-7  # wire diameters of penetration: its force is the least that friction bounds are compared with
TOUCH = 0.003  # wire diameters by which a pair may penetrate where a prediction closes it
OVERLAP_ALLOWED = 0.1  # wire diameters by which wires may overlap more than the deepest pair does
NEAR = 1.5  # wire diameters between centres, within which a pair's motion in a substep is watched


@part
def _distance(vectors, m):
    return math.sqrt(vectors[m, 0] ** 2 + vectors[m, 1] ** 2 + vectors[m, 2] ** 2)


@part
def approach(before, after, d):
    """Largest motion of a pair that comes near, and the share of it to where the first one touches.

    A pair counts if it comes near anywhere between: wires must not pass through each other.
    """
    most, free, inner = 0.0, 1.0, ((1.0 - TOUCH) * d) ** 2
    for m in range(before.shape[0]):
        v0, v1, v2 = before[m, 0], before[m, 1], before[m, 2]
        w0, w1, w2 = after[m, 0], after[m, 1], after[m, 2]
        x0, x1, x2 = w0 - v0, w1 - v1, w2 - v2
        start, square = v0 * v0 + v1 * v1 + v2 * v2, x0 * x0 + x1 * x1 + x2 * x2
        along = -(v0 * x0 + v1 * x1 + v2 * x2)
        if start >= d * d and w0 * w0 + w1 * w1 + w2 * w2 < inner:
            # first share with |v + share x|^2 = inner
            free = min(free, (along - math.sqrt(max(along**2 - square * (start - inner), 0.0))) / square)
        if square <= most * most:
            continue
        share = min(max(along / square, 0.0), 1.0)
        if start + share * (share * square - 2.0 * along) < (NEAR * d) ** 2:
            most = math.sqrt(square)
    return most, free


@part
def remember(vectors, history, mu, K, d):
    """Update the contact history with an accepted state; returns the least gap of all pairs.

    With sticking contact or friction a pair that touches is stored; one that has opened loses its history.
    """
    least, e = np.inf, np.empty(3)
    for m in range(vectors.shape[0]):
        h = _distance(vectors, m)
        least = min(least, h - d)
        if mu == 0.0:
            continue
        if h < d:
            hold(vectors[m], h, d, K, history[m], e)
        else:
            history[m].closed = False
    return least


@part
def friction_bounds(vectors, history, mu, K, k, d):
    """Renew the bounds of the tangential forces; returns the largest change over the largest bound."""
    change, most, e = 0.0, mu * normal_law(SLIGHT * d, K, k)[1], np.empty(3)
    for m in range(vectors.shape[0]):
        if not history[m].closed:
            continue
        h, bound = _distance(vectors, m), mu
        if bound < np.inf:
            # at the arm d instead of h, on which arcs are measured
            bound *= normal_law(max(d - h, 0.0), K, k)[1] * h / d
            most = max(most, bound)
        length = d * arc(vectors[m], h, history[m], e) if bound < np.inf else 0.0
        change = max(change, renewed(length, bound, K, history[m]))
    return change / most if change > 0.0 else 0.0
