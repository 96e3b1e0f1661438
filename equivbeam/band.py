"""Banded LDL^T of the equivalent beam's matrix."""

from __future__ import annotations

import numpy as np

from coilspring.compiled import kernel

BAND = 8  # half bandwidth: a pair couples nodes i and i + 2, three freedoms each


@kernel
def factor(reals, ints, flat):
    """Banded LDL^T in place (unit lower triangle, pivots in column 0).

    Returns the number of negative pivots and the least pivot.
    """
    F = flat.reshape((flat.size // (BAND + 1), BAND + 1))
    n = F.shape[0]
    negative, least = 0, np.inf
    for i in range(n):
        first = max(0, i - BAND)
        for j in range(first, i):
            total = F[i, i - j]
            for m in range(max(first, j - BAND), j):
                total -= F[i, i - m] * F[j, j - m]
            F[i, i - j] = total  # L[i, j] * pivot[j]
        pivot = F[i, 0]
        for j in range(first, i):
            scaled = F[i, i - j] / F[j, 0]
            pivot -= F[i, i - j] * scaled
            F[i, i - j] = scaled
        F[i, 0] = pivot
        least = min(least, pivot)
        if not pivot > 0.0:
            negative += 1
    return negative, least


@kernel
def solve(reals, ints, flat, b):
    """Back substitution in place."""
    n = b.size
    F = flat.reshape((n, BAND + 1))
    for i in range(n):
        for j in range(max(0, i - BAND), i):
            b[i] -= F[i, i - j] * b[j]
    for i in range(n):
        b[i] /= F[i, 0]
    for i in range(n - 1, -1, -1):
        for j in range(max(0, i - BAND), i):
            b[j] -= F[i, i - j] * b[i]
