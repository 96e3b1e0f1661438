"""How the kernels are compiled, in one place."""

from __future__ import annotations

import numpy as np
from numba import njit
from numba.extending import register_jitable

# Division by zero gives inf or nan ("numpy"): checking for it would cost a branch at each division.

# A function that Python calls or that is handed to the path follower: compiled once, stored on disk.
kernel = njit(cache=True, error_model="numpy")

# A part of kernels, compiled into them alone: without what Python would need to call it, which is a
# quarter of the time of compiling. Called from Python it is plain Python.
part = register_jitable(no_cfunc_wrapper=True, error_model="numpy")

# The same for plain arithmetic: sums may be reordered and multiplied on the fly.
arithmetic = register_jitable(
    no_cfunc_wrapper=True, error_model="numpy", fastmath={"contract", "reassoc", "nsz", "arcp"}
)


@part
def clear(vector):
    """vector[:] = 0; slice assignment compiles seconds of error messages."""
    for i in range(vector.size):
        vector[i] = 0.0


@part
def clear_table(table):
    """table[:] = 0."""
    for i in range(table.shape[0]):
        for j in range(table.shape[1]):
            table[i, j] = 0.0


@part
def copy(source, target):
    """target[:] = source for vectors."""
    for i in range(source.size):
        target[i] = source[i]


@part
def copy_table(source, target):
    """target[:] = source for tables."""
    for i in range(source.shape[0]):
        for j in range(source.shape[1]):
            target[i, j] = source[i, j]


@part
def zeros(size):
    """Vector of zeros: one way to make a vector is compiled once, each of numpy's by itself."""
    out = np.empty(size)
    clear(out)
    return out


@part
def copied(source):
    """Copy of a vector."""
    out = zeros(source.size)
    copy(source, out)
    return out


@part
def copied_table(source):
    """Copy of a table."""
    out = np.empty(source.shape)
    copy_table(source, out)
    return out
