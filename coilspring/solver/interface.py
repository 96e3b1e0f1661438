"""The compiled functions that a model hands to the path followers, and their types.

A model is described by its data (two flat arrays, see `coilspring.compiling.packing`) and twelve kernels,
which the solver takes as typed first-class functions, so that it is compiled once for all models:

``assemble(reals, ints, accepted, least_gap, history, state, g, H) -> (energy, pairs evaluated)``
    Strain and contact energy, its gradient `g` and its matrix `H` (model's own storage, flat; left
    out where it is empty) at `state`. `accepted` is the last accepted state, `least_gap`
    the least gap of its contact pairs: while nothing has moved by half of it, no pair can touch.
    `history` holds what contact remembers: a `coilspring.contact.law.PAIR_HISTORY` of every pair.
``factor(reals, ints, F) -> (negative pivots, least pivot)``
    LDL^T of `F` in place. By Sylvester's law the negative pivots count the negative eigenvalues.
``solve(reals, ints, F, b)``
    Back substitution in place.
``retract(reals, ints, state, step, factor, before, second, out)``
    The state moved by ``factor * step`` (rotations by the exponential map), and by `second` times that
    to the state `before`, which for a Newton step is 0.
``work(reals, ints, load, a, b)``
    Work of a dead load from state `a` to state `b`.
``rotate(reals, ints, a, b, v)``
    Turn the parts of a step or a residual `v` in place with the nodes on which they act, from state `a`
    to `b`: seen so, a factor stays good while the body turns.
``displacement_bound(reals, ints, a, b, least) -> (distance, pair motion, free share)``
    Bound on how far any point moved from state `a` to `b`. Where it is more than `least`: the largest change
    of the vector between the centres of a pair that comes near in between, in wire diameters; the share of
    the motion after which the first pair that is open in `a` has closed, or 2 (`BETWEEN`) where one that
    sticks closes and is open again in `b`. Else 0 and 1.
``update_history(reals, ints, state, history) -> least gap``
    Update the contact history with an accepted state. Minus infinity: a pair touches that is not in
    the model.
``update_pairs(reals, ints, accepted, predicted, state, history) -> change``
    Make the contact history that of a trial state: which pairs touch since the accepted state, and where they
    did first, on the way to the predicted one; bounds of the tangential forces, which are lines over the
    slips in `assemble`, as the normal forces have them. Returns the largest change over the largest force, 0
    without friction.
``pair_rates(reals, ints, state, motion, history, rates)``
    Fill the rates (pairs, 2) at which gaps and tangential lengths of held pairs change, at a state, with a
    motion in its degrees of freedom.
``length_gradient(reals, ints, state, history, pair, g) -> length``
    Fill the gradient `g` of the tangential length of a held pair.
``overlap(reals, ints, state) -> (overlap, excess)``
    By how much the wire, or the circles that stand for it, run into themselves, mm: all of it against all of
    it. And by how much that is more than the deepest contact pair, evaluated where it is more than the
    follower allows. Asked in scenes with contact alone.
"""

from typing import Any, NamedTuple

import numpy as np
from numba import from_dtype, types

from coilspring.contact.law import PAIR_HISTORY

# Entry of a fixed degree of freedom on the diagonal of a matrix, N/mm or N mm. No mode has any part along it,
# and no pivot is taken for it; with 1 the softest mode of a stiff spring was that of its fixed end.
FIXED = 1e30


class Kernels(NamedTuple):
    """A model's compiled functions, or their types."""

    assemble: Any
    factor: Any
    solve: Any
    retract: Any
    work: Any
    rotate: Any
    displacement_bound: Any
    update_history: Any
    update_pairs: Any
    pair_rates: Any
    length_gradient: Any
    overlap: Any


def record_type(dtype: np.dtype, axes: int = 1) -> Any:
    """numba's type of an array of records."""
    return types.Array(from_dtype(dtype), axes, "C")


def _signatures() -> Kernels:
    vector, numbers, history = types.float64[::1], types.int64[::1], record_type(PAIR_HISTORY)
    real, whole = types.float64, types.int64
    data = (vector, numbers)
    return Kernels(
        assemble=types.Tuple((real, whole))(*data, vector, real, history, vector, vector, vector),
        factor=types.Tuple((whole, real))(*data, vector),
        solve=types.void(*data, vector, vector),
        retract=types.void(*data, vector, vector, real, vector, real, vector),
        work=real(*data, vector, vector, vector),
        rotate=types.void(*data, vector, vector, vector),
        displacement_bound=types.UniTuple(real, 3)(*data, vector, vector, real),
        update_history=real(*data, vector, history),
        update_pairs=real(*data, vector, vector, vector, history),
        pair_rates=types.void(*data, vector, vector, history, types.float64[:, ::1]),
        length_gradient=real(*data, vector, history, whole, vector),
        overlap=types.UniTuple(real, 2)(*data, vector),
    )


SIGNATURES = _signatures()
