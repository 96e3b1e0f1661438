"""The compiled functions that a model hands to the path followers, and their types."""

from __future__ import annotations

from typing import Any, NamedTuple

from numba import types


class Kernels(NamedTuple):
    """A model's compiled functions (or their types); `coilspring.newton` says what each does."""

    assemble: Any
    factor: Any
    solve: Any
    retract: Any
    predict: Any
    work: Any
    carry: Any
    motion: Any
    commit: Any
    renew: Any


def _signatures() -> Kernels:
    vector, numbers, table = types.float64[::1], types.int64[::1], types.float64[:, ::1]
    real, whole = types.float64, types.int64
    data = (vector, numbers)
    return Kernels(
        assemble=types.Tuple((real, whole))(*data, vector, real, table, vector, vector, vector),
        factor=types.Tuple((whole, real))(*data, vector),
        solve=types.void(*data, vector, vector),
        retract=types.void(*data, vector, vector, real, vector),
        predict=types.void(*data, vector, vector, vector, real, real, real, vector),
        work=real(*data, vector, vector, vector),
        carry=types.void(*data, vector, vector, vector),
        motion=types.UniTuple(real, 3)(*data, vector, vector),
        commit=real(*data, vector, table),
        renew=real(*data, vector, table),
    )


SIGNATURES = _signatures()
