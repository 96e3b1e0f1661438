"""Banded LDL^T of the equivalent beam's matrix.

Row k holds the entries (k, k + m) at column m, with as many zeros behind: an inner loop of fixed length
then runs over registers, at whatever place of the row it begins.
"""

import numpy as np

from coilspring.compiling.compiled import arithmetic, inlined, kernel, shaped
from coilspring.solver.interface import FIXED

BAND = 8  # half bandwidth: a pair couples the nodes i and i + 2, three degrees of freedom each
WIDTH = BAND + 1
ROW = 2 * WIDTH


@arithmetic
def eliminate(F, width):
    """LDL^T in place of rows of `width` entries; returns the negative pivots and the least pivot."""
    n = F.shape[0]
    negative, least = 0, np.inf
    for k in range(n):
        pivot = F[k, 0]
        least = min(least, pivot)
        if not pivot > 0.0:
            negative += 1
        share = 1.0 / pivot
        for m in range(1, min(width, n - k)):
            if F[k, m] == 0.0:
                continue  # as where no pair touches
            l = F[k, m] * share  # noqa: E741
            for q in range(width):
                F[k + m, q] -= l * F[k, m + q]
        for m in range(1, width):
            F[k, m] *= share
    return negative, least


@inlined
def fix(g, H, p):
    """Fix the degree of freedom `p`: no force; in the matrix, unless it is empty, nothing but FIXED."""
    g[p] = 0.0
    if H.shape[0] == 0:
        return
    for m in range(H.shape[1] // 2):
        H[p, m] = 0.0
        if 0 < m <= p:
            H[p - m, m] = 0.0
    H[p, 0] = FIXED


@kernel
def factor(reals, ints, flat):
    """Banded LDL^T in place (unit upper triangle, pivots in column 0).

    Returns the number of negative pivots and the least pivot.
    """
    return eliminate(shaped(flat, (flat.size // ROW, ROW)), WIDTH)


@arithmetic
def _substitute(F, b):
    """Solve in place; what the next rows still lack or need is kept in registers, not in memory."""
    n = b.size
    x0 = x1 = x2 = x3 = x4 = x5 = x6 = x7 = 0.0
    for k in range(n):
        R = F[k]
        y = b[k] - x0
        b[k] = y
        x0, x1, x2, x3 = x1 + R[1] * y, x2 + R[2] * y, x3 + R[3] * y, x4 + R[4] * y
        x4, x5, x6, x7 = x5 + R[5] * y, x6 + R[6] * y, x7 + R[7] * y, R[8] * y
    x0 = x1 = x2 = x3 = x4 = x5 = x6 = x7 = 0.0
    for k in range(n - 1, -1, -1):
        R = F[k]
        far = R[4] * x3 + R[5] * x4 + R[6] * x5 + R[7] * x6 + R[8] * x7
        y = b[k] / R[0] - far - R[3] * x2 - R[2] * x1 - R[1] * x0
        b[k] = y
        x7, x6, x5, x4, x3, x2, x1, x0 = x6, x5, x4, x3, x2, x1, x0, y


@kernel
def solve(reals, ints, flat, b):
    """Back substitution in place."""
    _substitute(flat.reshape((b.size, ROW)), b)
