"""Arc-length continuation: the equilibrium path past its limit points.

Unknowns are the state and the time. A point is predicted along the tangent n of the path and
corrected by Newton's method in the plane across n (Riks 1979, Ramm 1981):

    H dq = -(g - t f) + dt f,   n . (dq, dt) = 0

The matrix may be indefinite: the path goes through unstable equilibria, and says so by the number of
negative pivots of every point.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import lru_cache
from typing import NamedTuple

import numpy as np
from numba import types

from coilspring.branch import PAIR_MOTION
from coilspring.compiled import copy, part, signed
from coilspring.kernelset import SIGNATURES
from coilspring.linesearch import dot, solution

FIRST_ARC = 0.02  # of the arc that the tangent at rest would take to full load
LEAST_ARC = 1e-7
MOST_ARC = 0.05
MOST_CORRECTIONS = 10
FEW_CORRECTIONS = 4  # the next arc may be longer
CORRECTION = 1e-9  # size of the last correction in the arc's measure: the next would be its square
TURN_COSINE = 0.9  # of the path's direction between neighbouring points,
KINK_ARC = 1e-3  # but for shorter arcs: contact that opens or closes kinks the path


class Trace(NamedTuple):
    """What `trace` returns, in this order."""

    times: np.ndarray  # (points,), not monotonic
    states: np.ndarray  # (points, state size)
    iterations: np.ndarray  # (points,) factorisations of each point, rejected attempts included
    negative: np.ndarray  # (points,) negative pivots: 0 where the equilibrium is stable
    finished: bool  # False where the arc shrank to nothing
    stray: bool  # True where it ended at its last state because a pair touches that is not in the model
    pairs: int  # contact pairs evaluated


@part
def correct(
    reals, ints, anchor, clearance, memory, load, scale, along, pitch, state, time, g, H, v, w,
    assemble, factor, solve, retract,
):  # fmt: skip
    """Newton's method across the direction (`along`, `pitch`) from `state` at `time`.

    Returns whether it converged, the time, factorisations, negative pivots, and pairs evaluated; `v`
    is left as H^-1 f near the solution, `state` is moved.
    """
    trial = np.empty_like(state)
    pairs = 0
    negative = 0
    for count in range(1, MOST_CORRECTIONS + 1):
        _, looked = assemble(reals, ints, anchor, clearance, memory, state, g, H)
        pairs += looked
        for i in range(g.size):
            g[i] -= time * load[i]
        negative, _ = factor(reals, ints, H)
        solution(reals, ints, H, load, 1.0, v, solve)
        solution(reals, ints, H, g, -1.0, w, solve)
        shift = -dot(along, w) / (dot(along, v) + scale * scale * pitch)
        size = shift * shift
        for i in range(g.size):
            w[i] += shift * v[i]
            size += (w[i] / scale) ** 2
        if not np.isfinite(size) or size > 1.0:
            return False, time, count, negative, pairs
        retract(reals, ints, state, w, 1.0, state, 0.0, trial)
        copy(trial, state)
        time += shift
        if size <= CORRECTION**2:
            return True, time, count, negative, pairs
    return False, time, MOST_CORRECTIONS, negative, pairs


@part
def direction(v, negative, scale, along, pitch, new):
    """Unit direction of the path from v = dq/dt.

    Along a path time rises and falls with the sign of det H, also where the path is kinked (the
    orientation of a homotopy path, Allgower & Georg 1990, section 2.1): the parity of the negative
    pivots. Fills `new`; returns its share in time and the cosine with (`along`, `pitch`).
    """
    size = np.sqrt(dot(v, v) / scale**2 + 1.0)
    sign = 1.0 if negative % 2 == 0 else -1.0
    for i in range(v.size):
        new[i] = sign * v[i] / size
    return sign / size, sign * (dot(v, along) / scale**2 + pitch) / size


def trace(
    reals, ints, load, points, start, memory, size, assemble, factor, solve, retract, work, carry,
    motion, commit, renew, overlap, stop,
):  # fmt: skip
    """Trace at most `points` points of the path from rest, or to time 1; arguments as in `follow`."""
    times = np.empty(points)
    states = np.empty((points, start.size))
    iterations = np.zeros(points, np.int64)
    negatives = np.zeros(points, np.int64)
    g, v, w = np.empty_like(load), np.empty_like(load), np.empty_like(load)
    along, new = np.empty_like(load), np.empty_like(load)
    H = np.empty(size)
    state, trial = start.copy(), start.copy()
    memory = memory.copy()
    clearance = commit(reals, ints, state, memory)
    _, pairs = assemble(reals, ints, state, clearance, memory, state, g, H)
    factor(reals, ints, H)
    solution(reals, ints, H, load, 1.0, v, solve)
    scale = np.sqrt(dot(v, v))
    for i in range(v.size):
        along[i] = 0.0
    pitch, _ = direction(v, 0, scale, along, 1.0, new)
    copy(new, along)
    time, arc = 0.0, FIRST_ARC
    row, spent = 0, 1
    while row < points and time < 1.0 and arc >= LEAST_ARC and clearance > -np.inf and stop[0] == 0:
        retract(reals, ints, state, along, arc, state, 0.0, trial)
        good, reached, count, negative, looked = correct(
            reals, ints, state, clearance, memory, load, scale, along, pitch, trial, time + arc * pitch,
            g, H, v, w, assemble, factor, solve, retract,
        )  # fmt: skip
        spent += count
        pairs += looked
        if good:
            share, cosine = direction(v, negative, scale, along, pitch, new)
            _, pair, _ = motion(reals, ints, state, trial, 0.0)
            good = (cosine >= TURN_COSINE or arc <= KINK_ARC) and pair <= PAIR_MOTION
        if not good:
            arc *= 0.5
            continue
        copy(trial, state)
        copy(new, along)
        time, pitch = reached, share
        clearance = commit(reals, ints, state, memory)
        times[row], iterations[row], negatives[row] = time, spent, negative
        copy(state, states[row])
        row, spent = row + 1, 0
        if count <= FEW_CORRECTIONS:
            arc = min(1.5 * arc, MOST_ARC)
    finished = arc >= LEAST_ARC
    stray = clearance == -np.inf
    # `Trace`; see `coilspring.stepping.follow`
    return times[:row], states[:row], iterations[:row], negatives[:row], finished, stray, pairs


@lru_cache(maxsize=1)
def compiled_trace() -> Callable:
    """`trace`, compiled; read from the cache where stored (see `coilspring.stepping.compiled_follow`)."""
    vector, numbers, table = types.float64[::1], types.int64[::1], types.float64[:, ::1]
    data = (vector, numbers, vector, types.int64, vector, table, types.int64)
    functions = tuple(types.FunctionType(signature) for signature in SIGNATURES)
    return signed(trace, *data, *functions, numbers)
