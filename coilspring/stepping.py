"""Load path of a model: adaptive substeps that land on the requested times and keep the branch."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from numba import njit, typeof, types

from coilspring.newton import CONVERGED, HISTORY, LINEAR, SADDLE, equilibrium

COMPLETED, CRITICAL, STUCK = 0, 1, 2

FIRST_STEP = 0.25  # largest first substep: the tangent at rest knows nothing of the contact to come
LEAST_STEP = 1e-6  # of the time 0..1: below it, what cannot be passed is called a critical point
# A converged state continues the branch when it lies near the straight prediction: within this share
# of the way it came (a fold or a jump turns the path by more), or within a small distance at all
# (a closing contact kinks the path, so that no step is short enough for the share).
TURN = 0.25
SMALL = 0.05  # wire diameters
# A pair may not move by more in one substep: beyond, coils could pass through or over each other.
PAIR_MOTION = 0.5  # wire diameters
EASY_TURN = 0.1  # the next substep may be twice as long
EASY_COUNT = 5
SAMPLES = 16  # of a linear stretch at which its stability is verified
SOFT = 0.05  # share of the least eigenvalue at rest, below which the tangent counts as singular


class Track(NamedTuple):
    """What `follow` returns."""

    states: np.ndarray  # (reached, state size), at the requested times
    iterations: np.ndarray  # (reached,), factorisations since the previous row
    rest: np.ndarray  # factorisations spent after the last row
    outcome: int
    time: float  # last accepted time
    bracket: float  # length of the time bracket of the critical point
    checks: int  # factorisations that only verified the stability of a linear stretch
    pairs: int  # contact pairs evaluated
    mode: np.ndarray  # softest mode at the last accepted state, where the outcome is CRITICAL
    history: np.ndarray  # last Newton decrements over the reference work


@njit(cache=True, error_model="numpy")
def softest(model, state, memory, time, load, g, H, assemble, factor, solve):
    """Least eigenvalue (in size) of the matrix at `state` and its mode, by inverse iteration."""
    assemble(model, state, 0.0, memory, state, time, g, H)
    factor(model, H)
    seed = np.linspace(1.0, 2.0, load.size)  # no symmetry that could hide the mode
    mode = seed / np.sqrt(np.dot(seed, seed))
    value = 0.0
    for _ in range(30):
        new = mode.copy()
        solve(model, H, new)
        norm = np.sqrt(np.dot(new, new))
        value = np.dot(new, mode) / norm**2
        mode = new / norm
    return value, mode


@njit(cache=True, error_model="numpy")
def unstable_time(model, memory, origin, begin, tangent, end, H, g, assemble, factor, retract):
    """First time of a linear stretch at which the matrix has a negative pivot.

    Along the stretch the state is `origin` moved by ``(time - begin) * tangent``; it is sampled at
    `SAMPLES` times and bisected. Returns the time before the sign change (infinite where every
    sample is stable) and the number of factorisations.
    """
    state = np.empty_like(origin)
    low, high, time = begin, np.inf, begin
    count = 0
    while high - low > LEAST_STEP:
        time = 0.5 * (low + high) if high < np.inf else min(low + (end - begin) / SAMPLES, end)
        retract(model, origin, tangent, time - begin, state)
        assemble(model, state, 0.0, memory, state, time, g, H)
        count += 1
        if factor(model, H) > 0:
            high = time
        elif time == end:
            return np.inf, count
        else:
            low = time
    return low, count


@njit(cache=True, error_model="numpy")
def continues(model, predicted, state, trial, diameter, troubled, judged, motion):
    """Whether `trial` continues the branch of `state`, and the share by which the path turned."""
    way, pair = motion(model, state, trial)
    if pair > PAIR_MOTION:
        return False, 1.0
    if not judged:
        return True, 0.0
    turn, _ = motion(model, predicted, trial)
    share = turn / way if way > 0.0 else 0.0
    near = turn <= SMALL * diameter
    return near or (share <= TURN and not troubled), share


def follow(
    model,
    load,
    times,
    start,
    memory,
    template,
    diameter,
    limit,
    predictor,
    assemble,
    factor,
    solve,
    retract,
    motion,
    commit,
):
    """Follow the equilibrium from rest through the increasing `times`.

    Parameters
    ----------
    model : data of the model (NamedTuple).
    load : (n,) load vector at time 1.
    times : (steps,) requested times.
    start : state at rest.
    memory : contact memory at rest; changed in place by ``commit(model, state, memory)``, which
        returns the least gap of all pairs (the clearance), with accepted states only.
    template : array of the shape of the model's matrix.
    diameter : wire diameter, mm: the length with which moves are compared.
    limit : largest number of iterations of a substep.
    predictor : start from the tangent's prediction and judge the branch by it; else from the last
        state, as the paper did.
    assemble, factor, solve, retract, motion : kernels, see `coilspring.newton`.
    """
    size = times.size
    states = np.empty((size, start.size))
    iterations = np.zeros(size, np.int64)
    spent = np.zeros(1, np.int64)
    history = np.zeros(HISTORY)
    g = np.empty_like(load)
    H = np.empty_like(template)
    F = np.empty_like(template)
    state = start.copy()
    trial = start.copy()
    predicted = start.copy()
    tangent = load.copy()
    mode = np.zeros_like(load)
    clearance = commit(model, state, memory)
    _, pairs = assemble(model, state, clearance, memory, state, 0.0, g, H)
    rest = H.copy()
    F[...] = H
    if factor(model, F) > 0:
        return Track(states[:0], iterations[:0], spent, CRITICAL, 0.0, 0.0, 0, pairs, mode, history)
    spent[0] = 1
    solve(model, F, tangent)
    work = np.dot(load, tangent)
    origin, begin = state.copy(), 0.0  # of the linear stretch whose stability is not yet verified
    linear, kept = False, True
    checks, critical = 0, np.inf
    outcome = COMPLETED
    time, dt = 0.0, min(times[0], FIRST_STEP)
    row = 0
    while row < size:
        landing = times[row] - time <= dt * (1.0 + 1e-9)
        target = times[row] if landing else time + dt
        step = target - time
        retract(model, state, tangent, step if predictor else 0.0, predicted)
        trial[:] = predicted
        status, count, troubled, looked = equilibrium(
            model, state, clearance, memory, target, work * target**2, limit, trial,
            g, H, rest, F, kept, history, assemble, factor, solve, retract,
        )  # fmt: skip
        spent[0] += count
        pairs += looked
        good, share = status in (CONVERGED, LINEAR), 0.0
        if good:
            good, share = continues(model, predicted, state, trial, diameter, troubled, predictor, motion)
        if not good:
            kept = False
            dt = 0.5 * step
            if dt < LEAST_STEP:
                outcome = CRITICAL if status == SADDLE else STUCK
                break
            continue
        if status == LINEAR:
            if not linear:
                origin[:], begin, linear = state, time, True
        elif linear:
            # a linear stretch took no factorisation: verify its stability once, where it ends
            critical, count = unstable_time(
                model, memory, origin, begin, tangent, time, H, g, assemble, factor, retract
            )
            checks += count
            linear = False
            if critical < np.inf:
                break
        if status == CONVERGED:
            tangent[:] = load
            solve(model, F, tangent)
        kept = True
        state[:] = trial
        time = target
        clearance = commit(model, state, memory)
        if share < EASY_TURN and count <= EASY_COUNT:
            dt = max(dt, 2.0 * step)
        if landing:
            states[row] = state
            iterations[row] = spent[0]
            spent[0] = 0
            row += 1
    bracket = 2.0 * dt
    if linear:
        critical, count = unstable_time(
            model, memory, origin, begin, tangent, time, H, g, assemble, factor, retract
        )
        checks += count
    if critical < np.inf:
        outcome, time, bracket = CRITICAL, critical, LEAST_STEP
        row = np.searchsorted(times, critical)
        retract(model, origin, tangent, critical - begin, state)
    if outcome != COMPLETED:
        least, mode = softest(model, state, memory, time, load, g, H, assemble, factor, solve)
        stiffness, _ = softest(model, start, memory, 0.0, load, g, H, assemble, factor, solve)
        if abs(least) < SOFT * abs(stiffness):
            outcome = CRITICAL
    return Track(
        states[:row], iterations[:row], spent, outcome, time, bracket, checks, pairs, mode, history
    )


class Kernels(NamedTuple):
    """A model's compiled functions; `coilspring.newton` and `follow` say what each does."""

    assemble: Callable
    factor: Callable
    solve: Callable
    retract: Callable
    motion: Callable
    commit: Callable


_followers: dict[tuple, Callable] = {}


def compiled_follow(model: tuple, template: np.ndarray, kernels: Kernels) -> Callable:
    """`follow`, compiled for a model's data, matrix and kernels; read from the cache where stored.

    The kernels enter as typed first-class functions: a jitted function passed as an ordinary
    argument would be compiled anew in every process.
    """
    kind, matrix = typeof(model), typeof(template)
    if (kind, matrix) not in _followers:
        signatures = _signatures(kind, matrix)
        for kernel, signature in zip(kernels, signatures, strict=True):
            kernel.compile(signature.args)
        vector, table = types.float64[::1], types.float64[:, ::1]
        data = (kind, vector, vector, vector, table, matrix)
        control = (types.float64, types.int64, types.boolean)
        functions = tuple(types.FunctionType(signature) for signature in signatures)
        _followers[kind, matrix] = njit(data + control + functions, cache=True, error_model="numpy")(follow)
    return _followers[kind, matrix]


def _signatures(kind: types.Type, matrix: types.Type) -> Kernels:
    vector, table = types.float64[::1], types.float64[:, ::1]
    real, whole = types.float64, types.int64
    return Kernels(
        assemble=types.Tuple((real, whole))(kind, vector, real, table, vector, real, vector, matrix),
        factor=whole(kind, matrix),
        solve=types.void(kind, matrix, vector),
        retract=types.void(kind, vector, vector, real, vector),
        motion=types.UniTuple(real, 2)(kind, vector, vector),
        commit=real(kind, vector, table),
    )
