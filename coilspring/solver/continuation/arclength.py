"""Arc-length continuation: the equilibrium path past its limit points.

Unknowns are the state and the time. A point is predicted along the tangent n of the path and
corrected by Newton's method in the plane across n (Riks 1979, Ramm 1981):

    H dq = -(g - t f) + dt f,   n . (dq, dt) = 0

The matrix may be indefinite: the path goes through unstable equilibria, and says so by the number of
negative pivots of every point.
"""

from collections.abc import Callable
from functools import lru_cache
from typing import Any, NamedTuple

import numpy as np
from numba import types

from coilspring.compiling.compiled import copied, copy, part, signed, zeros
from coilspring.contact.law import PAIR_HISTORY
from coilspring.solver.bundles import system_of, system_types
from coilspring.solver.continuation.branch import PAIR_MOTION, displacement_bound
from coilspring.solver.equilibrium.linesearch import dot
from coilspring.solver.equilibrium.operations import assembled, factored, moved, solution
from coilspring.solver.interface import record_type

FIRST_ARC = 0.02  # of the arc that the tangent at rest would take to full load
LEAST_ARC = 1e-7
MOST_ARC = 0.05
MOST_CORRECTIONS = 10
FEW_CORRECTIONS = 4  # the next arc may be longer
CORRECTION = 1e-9  # size of the last correction in the arc's measure: the next would be its square
TURN_COSINE = 0.9  # of the path's direction between neighbouring points, or of the reverse,
KINK_ARC = 1e-3  # but for shorter arcs: contact that opens or closes kinks the path


class Arc(NamedTuple):
    """The last point of a path, its direction, and vectors to work with."""

    state: Any
    least_gap: Any  # least gap of its pairs
    history: Any
    load: Any
    along: Any  # direction: its part in the state
    pitch: Any  # and in time
    scale: Any  # length with which states are measured
    g: Any
    H: Any
    v: Any  # H^-1 f
    w: Any  # correction
    scratch: Any  # a state


class Trace(NamedTuple):
    """What `trace` returns, in this order."""

    times: np.ndarray  # (points,), not monotonic
    states: np.ndarray  # (points, state size)
    iterations: np.ndarray  # (points,) factorisations of each point, rejected attempts included
    negative: np.ndarray  # (points,) negative pivots: 0 where the equilibrium is stable
    bifurcation: float  # time at which another path first branched off; infinite where none was seen
    finished: bool  # False where the arc shrank to nothing
    new_pair: bool  # True where it ended at its last state because a pair touches that is not in the model
    pairs: int  # contact pairs evaluated


@part
def correct(system, arc, state, time):
    """Newton's method across the direction of the arc from `state`, which is moved, at `time`.

    Returns whether it converged, the time, factorisations, negative pivots, and pairs evaluated; `arc.v`
    is left as H^-1 f near the solution.
    """
    g, v, w = arc.g, arc.v, arc.w
    pairs, negative = 0, 0
    for count in range(1, MOST_CORRECTIONS + 1):
        _, near = assembled(system, arc.state, arc.least_gap, arc.history, state, g, arc.H)
        pairs += near
        for i in range(g.size):
            g[i] -= time * arc.load[i]
        negative, _ = factored(system, arc.H)
        solution(system, arc.H, arc.load, 1.0, v)
        solution(system, arc.H, g, -1.0, w)
        shift = -dot(arc.along, w) / (dot(arc.along, v) + arc.scale * arc.scale * arc.pitch)
        size = shift * shift
        for i in range(g.size):
            w[i] += shift * v[i]
            size += (w[i] / arc.scale) ** 2
        if not np.isfinite(size) or size > 1.0:
            return False, time, count, negative, pairs
        moved(system, state, w, 1.0, arc.scratch)
        copy(arc.scratch, state)
        time += shift
        if size <= CORRECTION**2:
            return True, time, count, negative, pairs
    return False, time, MOST_CORRECTIONS, negative, pairs


@part
def direction(v, negative, side, scale, along, pitch, new):
    """Unit direction of the path from v = dq/dt.

    Along a path time rises and falls with the sign of det H, the parity of the negative pivots, also where
    the path is kinked (the orientation of a homotopy path, Allgower & Georg 1990, section 2.1). Where another
    path branches off, det H changes its sign and time goes on as before (section 8.1), so that a point ahead
    seems to lead back: there `side`, 1 or -1, changes too. Fills `new`; returns its share in time and the
    cosine with (`along`, `pitch`).
    """
    size = np.sqrt(dot(v, v) / scale**2 + 1.0)
    sign = side if negative % 2 == 0 else -side
    for i in range(v.size):
        new[i] = sign * v[i] / size
    return sign / size, sign * (dot(v, along) / scale**2 + pitch) / size


def trace(data, kernels, load, points, start, history, size, stop):
    """Trace at most `points` points of the path from rest, or to time 1.

    `history` is overwritten. `size` is the length of the matrix; the others as in
    `coilspring.solver.continuation.follower.follow`.
    """
    system = system_of(data, kernels)
    times, states = np.empty(points), np.empty((points, start.size))
    iterations, negatives = np.zeros(points, np.int64), np.zeros(points, np.int64)
    v, along, new, g, w = (
        zeros(load.size),
        zeros(load.size),
        zeros(load.size),
        zeros(load.size),
        zeros(load.size),
    )
    state, trial, scratch, H = copied(start), copied(start), copied(start), zeros(size)
    least_gap = system.update_history(data.reals, data.ints, state, history)
    _, pairs = assembled(system, state, least_gap, history, state, g, H)
    factored(system, H)
    solution(system, H, load, 1.0, v)
    scale = np.sqrt(dot(v, v))
    pitch, _ = direction(v, 0, 1.0, scale, along, 1.0, new)
    copy(new, along)
    time, length, row, spent = 0.0, FIRST_ARC, 0, 1
    side, bifurcation = 1.0, np.inf
    while row < points and time < 1.0 and length >= LEAST_ARC and least_gap > -np.inf and stop[0] == 0:
        arc = Arc(state, least_gap, history, load, along, pitch, scale, g, H, v, w, scratch)
        moved(system, state, along, length, trial)
        good, reached, count, negative, near = correct(system, arc, trial, time + length * pitch)
        spent += count
        pairs += near
        if good:
            share, cosine = direction(v, negative, side, scale, along, pitch, new)
            _, pair, _ = displacement_bound(system, state, trial, 0.0)
            good = (abs(cosine) >= TURN_COSINE or length <= KINK_ARC) and pair <= PAIR_MOTION
        if not good:
            length *= 0.5
            continue
        if cosine <= -TURN_COSINE:
            side, bifurcation = -side, reached if bifurcation == np.inf else bifurcation
            share, _ = direction(v, negative, side, scale, along, pitch, new)
        copy(trial, state)
        copy(new, along)
        time, pitch = reached, share
        least_gap = system.update_history(data.reals, data.ints, state, history)
        times[row], iterations[row], negatives[row] = time, spent, negative
        copy(state, states[row])
        row, spent = row + 1, 0
        if count <= FEW_CORRECTIONS:
            length = min(1.5 * length, MOST_ARC)
    # `Trace`; making one in compiled code would call back into the interpreter
    finished, new_pair = length >= LEAST_ARC, least_gap == -np.inf
    return (
        times[:row],
        states[:row],
        iterations[:row],
        negatives[:row],
        bifurcation,
        finished,
        new_pair,
        pairs,
    )


@lru_cache(maxsize=1)
def compiled_trace() -> Callable:
    """`trace`, compiled; read from the cache where stored."""
    vector = types.float64[::1]
    data = (*system_types(), vector, types.int64, vector, record_type(PAIR_HISTORY), types.int64)
    return signed(trace, *data, types.int64[::1])
