"""The model's energy with what acts on the top besides a growing load: see `coilspring.driving`."""

from __future__ import annotations

from coilspring.compiled import kernel
from coilspring.driving import drive, rests
from equivbeam import band, kernels


@kernel
def assemble(reals, ints, anchor, clearance, memory, state, g, H):
    """`equivbeam.kernels.assemble`, and what acts on the top."""
    energy, pairs = kernels.assemble(reals, ints, anchor, clearance, memory, state, g, H)
    return energy + drive(reals, ints, state, g, H), pairs


@kernel
def solve(reals, ints, F, b):
    """`equivbeam.band.solve`; a prescribed displacement stays as it is."""
    y = rests(reals, ints, b)
    band.solve(reals, ints, F, b)
    if y >= 0:
        b[y] = 0.0
