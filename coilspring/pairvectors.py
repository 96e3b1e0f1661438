"""What kernels do with the vectors between the centres of all pairs, (pairs, 3); the law is `pairlaw`."""

from __future__ import annotations

import math

import numpy as np

from coilspring.compiled import part
from coilspring.pairlaw import BOUND, ON, hold

SLIGHT = 1e-7  # wire diameters of penetration: its force is the least that friction bounds are compared with
TOUCH = 0.003  # wire diameters by which a pair may penetrate where a prediction closes it
NEAR = 1.5  # wire diameters between centres, within which a pair's motion in a substep is watched


@part
def _product(a, b):
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


@part
def approach(before, after, d):
    """Largest motion of a pair that comes near, and the share of the way to where the first one touches.

    A pair counts if it comes near anywhere on the way: wires must not pass through each other.
    """
    most, free, inner = 0.0, 1.0, ((1.0 - TOUCH) * d) ** 2
    x = np.empty(3)
    for m in range(before.shape[0]):
        v, w = before[m], after[m]
        for i in range(3):
            x[i] = w[i] - v[i]
        start, way, along = _product(v, v), _product(x, x), -_product(v, x)
        if start >= d * d and _product(w, w) < inner:
            # first share with |v + share x|^2 = inner
            free = min(free, (along - math.sqrt(max(along**2 - way * (start - inner), 0.0))) / way)
        if way <= most * most:
            continue
        share = min(max(along / way, 0.0), 1.0)
        if start + share * (share * way - 2.0 * along) < (NEAR * d) ** 2:
            most = math.sqrt(way)
    return most, free


@part
def remember(vectors, memory, mu, K, d):
    """Update the contact memory with an accepted state; returns the least gap of all pairs.

    A pair that touches is remembered where there is friction, one that has opened is forgotten.
    """
    least, e = np.inf, np.empty(3)
    for m in range(vectors.shape[0]):
        h = math.sqrt(_product(vectors[m], vectors[m]))
        least = min(least, h - d)
        if mu == 0.0:
            continue
        if h < d:
            hold(vectors[m], h, K, memory[m], e)
        else:
            memory[m, ON] = 0.0
    return least


@part
def renew_bounds(vectors, memory, mu, K, k, d):
    """Renew the bounds of the tangential forces; returns the largest change over the largest bound."""
    change, most = 0.0, mu * K * (SLIGHT * d) ** k
    for m in range(vectors.shape[0]):
        if memory[m, ON] == 0.0:
            continue
        bound = mu
        if bound < np.inf:
            h = math.sqrt(_product(vectors[m], vectors[m]))
            bound *= K * max(d - h, 0.0) ** k
            change = max(change, abs(bound - memory[m, BOUND]))
            most = max(most, bound)
        memory[m, BOUND] = bound
    return change / most if change > 0.0 else 0.0
