"""Banded LDL^T of the beam in the plane across, whose pairs couple four nodes."""

from __future__ import annotations

from coilspring.compiled import arithmetic, kernel
from equivbeam.band import eliminate

BAND = 11  # half bandwidth: nodes i to i + 3, three freedoms each
WIDTH = BAND + 1
ROW = 2 * WIDTH


@kernel
def factor(reals, ints, flat):
    """See `equivbeam.band.factor`."""
    return eliminate(flat.reshape((flat.size // ROW, ROW)), WIDTH)


@arithmetic
def _substitute(F, b):
    for k in range(b.size):
        for m in range(1, min(WIDTH, b.size - k)):
            b[k + m] -= F[k, m] * b[k]
    for k in range(b.size - 1, -1, -1):
        b[k] /= F[k, 0]
        for m in range(1, min(WIDTH, b.size - k)):
            b[k] -= F[k, m] * b[k + m]


@kernel
def solve(reals, ints, flat, b):
    """Back substitution in place."""
    _substitute(flat.reshape((b.size, ROW)), b)
