"""Banded LDL^T of the equivalent beam's matrix.

Row k holds the entries (k, k + m) at column m, with as many zeros behind: an inner loop of fixed length
then runs over registers, at whatever place of the row it begins.
"""

from __future__ import annotations

import numpy as np

from coilspring.compiled import arithmetic, kernel

BAND = 11  # half bandwidth: a pair couples nodes up to i and i + 3, three freedoms each
WIDTH = BAND + 1
ROW = 2 * WIDTH


@arithmetic
def _eliminate(F):
    n = F.shape[0]
    negative, least = 0, np.inf
    for k in range(n):
        pivot = F[k, 0]
        least = min(least, pivot)
        if not pivot > 0.0:
            negative += 1
        share = 1.0 / pivot
        for m in range(1, min(WIDTH, n - k)):
            if F[k, m] == 0.0:
                continue  # as where no pair touches
            l = F[k, m] * share  # noqa: E741
            for q in range(WIDTH):
                F[k + m, q] -= l * F[k, m + q]
        for m in range(1, WIDTH):
            F[k, m] *= share
    return negative, least


@kernel
def factor(reals, ints, flat):
    """Banded LDL^T in place (unit upper triangle, pivots in column 0).

    Returns the number of negative pivots and the least pivot.
    """
    return _eliminate(flat.reshape((flat.size // ROW, ROW)))


@arithmetic
def _substitute(F, b):
    n = b.size
    for k in range(n):
        y = b[k]
        for m in range(1, min(WIDTH, n - k)):
            b[k + m] -= F[k, m] * y
    for k in range(n):
        b[k] /= F[k, 0]
    for k in range(n - 1, -1, -1):
        y = b[k]
        for m in range(min(BAND, n - 1 - k), 0, -1):
            y -= F[k, m] * b[k + m]
        b[k] = y


@kernel
def solve(reals, ints, flat, b):
    """Back substitution in place."""
    _substitute(flat.reshape((b.size, ROW)), b)
