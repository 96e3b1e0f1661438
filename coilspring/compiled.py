"""How the kernels are compiled, in one place."""

from __future__ import annotations

from numba import njit

# Division by zero gives inf or nan, as in numpy: checking for it would cost a branch at each division.
kernel = njit(cache=True, error_model="numpy")

# For kernels that are plain arithmetic: sums may be reordered and multiplied on the fly.
arithmetic = njit(cache=True, error_model="numpy", fastmath={"contract", "reassoc", "nsz", "arcp"})


@kernel
def copy(source, target):
    """target[:] = source for flat arrays; slice assignment compiles seconds of error messages."""
    for i in range(source.size):
        target[i] = source[i]


@kernel
def copy_table(source, target):
    """target[:] = source for tables."""
    for i in range(source.shape[0]):
        for j in range(source.shape[1]):
            target[i, j] = source[i, j]
