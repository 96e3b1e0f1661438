"""Grazing pairs: each gives way tangentially just so that it touches.

Such a pair would open if it stuck, and be pressed if it held nothing. So it holds a force in between, with
which there is no gap. The forces of all are found by Newton's method: what each does to the gaps takes one
back substitution. In equilibrium a pair holds less by losing a share of its tangential stiffness: the
matrix keeps what is left of it.
"""

import math

import numpy as np

from coilspring.compiling.compiled import copy, part
from coilspring.contact.history import copy_history
from coilspring.contact.rates import GAP_RATE, LENGTH_RATE
from coilspring.contact.transitions import GRAZING
from coilspring.solver.equilibrium.operations import factor_state, solution
from coilspring.solver.tangential.complementarity import GAP, HELD, SLIP, complementary, eliminated
from coilspring.solver.tangential.response import find_rates, unit_force_response

LESS = 1e-4  # share of a force by which its bound is below it: the pair slides
LEAST_SHARE = 1e-12  # of the stiffness: less counts as none between two shares
FULL_ROUNDS = 6  # rounds in which the whole change of the forces is taken: mostly they suffice
SHORTER, LONGER, LEAST_STEP = 0.25, 2.0, 1e-4
NEARLY = 0.5  # of the stiffness: where a pair opened with no share so far, all of it is tried from here on


@part
def update_grazing(system, task, work, substep, pressed):
    """Renew the released shares in `work.history` of grazing pairs, at the trial state found with them.

    Returns the largest gap over `coilspring.contact.transitions.GRAZING`, or penetration of a pair that gives
    way over `pressed`, in wire diameters: up to 1 nothing is changed; infinity where no answer was found.
    """
    history = work.history
    # rounds that go to and fro leave out a pair at a time
    every = substep.rounds > FULL_ROUNDS
    active, worst = _active(history, GRAZING * task.diameter, pressed * task.diameter, every)
    if worst <= 1.0:
        return worst
    n = active.size
    opens, slips, rows, rates = (
        np.empty((n, n)),
        np.empty((n, n)),
        np.empty((3, n)),
        np.empty((history.shape[0], 2)),
    )
    _factor_sliding(system, work, active, False)
    for p in range(n):
        unit_force_response(system, work, active[p])
        find_rates(system, work, rates)
        for q in range(n):
            m = active[q]
            opens[q, p] = rates[m, GAP_RATE]
            slips[q, p] = history[m].stiffness * rates[m, LENGTH_RATE] - (1.0 if p == q else 0.0)
        row = history[active[p]]
        rows[GAP, p], rows[SLIP, p], rows[HELD, p] = row.gap, row.sticking - _held(row), _held(row)
    before = rows.copy()
    solved, substep.several = complementary(opens, slips, rows)
    if not solved:
        return np.inf
    _shorten_step(substep, worst)
    for p in range(n):
        row = history[active[p]]
        held = before[HELD, p] + substep.step * (max(rows[HELD, p], 0.0) - before[HELD, p])
        slip = before[SLIP, p] + substep.step * (max(rows[SLIP, p], 0.0) - before[SLIP, p])
        share = held / (held + slip) if held + slip > 0.0 else 1.0
        row.released = 1.0 - (_between(row, share) if n == 1 else share)
    return worst


@part
def _shorten_step(substep, worst):
    """Take less of the change of the forces where rounds go to and fro: gaps are no nearer to zero."""
    if substep.rounds > FULL_ROUNDS:
        nearer = worst < substep.worst
        substep.step = min(LONGER * substep.step, 1.0) if nearer else max(SHORTER * substep.step, LEAST_STEP)
    substep.worst = worst


@part
def grazing_tangent(system, task, work):
    """Set `work.tangent` at a state just accepted, where pairs graze: their forces change so that they go on
    touching. With the forces as they are, or the share of the stiffness that is left, they would not.
    Returns the number of factorisations.
    """
    history = work.history
    active = _slipping(history)
    n = active.size
    if n == 0:
        return 0
    _factor_sliding(system, work, active, True)
    M, motions, rates = np.empty((n, n + 1)), np.empty((n, task.load.size)), np.empty((history.shape[0], 2))
    for p in range(n):
        unit_force_response(system, work, active[p])
        find_rates(system, work, rates)
        for q in range(n):
            M[q, p] = rates[active[q], GAP_RATE]
        for i in range(task.load.size):
            motions[p, i] = work.ahead[i]
    solution(system, work.F, task.load, 1.0, work.ahead)
    find_rates(system, work, rates)
    for q in range(n):
        M[q, n] = -rates[active[q], GAP_RATE]
    if eliminated(M) == 0:
        return 1
    copy(work.ahead, work.tangent)
    for p in range(n):
        history[active[p]].growth = M[p, n]
        for i in range(task.load.size):
            work.tangent[i] += M[p, n] * motions[p, i]
    return 1


@part
def _active(history, wide, deep, every):
    """Pairs whose force decides their gap, or `every` one that grazes, and the largest gap or penetration
    that is not as it should be, in units of those that may be left."""
    active, count, worst = np.empty(history.shape[0], np.int64), 0, 0.0
    for m in range(history.shape[0]):
        row = history[m]
        sticks = row.released == 0.0 and row.gap <= 0.0
        free = row.released == 1.0 and row.gap >= 0.0
        right = sticks or free
        known = right and (not every or row.sticking == 0.0)
        if row.grazes and not known:
            active[count] = m
            count += 1
        if row.grazes and not right:
            worst = max(worst, row.gap / wide, -row.gap / deep)
    return active[:count], worst


@part
def _slipping(history):
    """Pairs that grazed in the last substep and hold a force."""
    slipping, count = np.empty(history.shape[0], np.int64), 0
    for m in range(history.shape[0]):
        history[m].growth = 0.0
        if history[m].grazes and history[m].slip > 0.0 and history[m].held > 0.0:
            slipping[count] = m
            count += 1
    return slipping[:count]


@part
def _held(row):
    """The tangential force of a grazing pair."""
    return (1.0 - row.released) * row.sticking


@part
def _factor_sliding(system, work, active, accepted):
    """Factor of the trial state with the active pairs, in `work.low`, at the bounds of their forces; of a
    state that is `accepted`, those it has."""
    low = work.low
    copy_history(work.history, low)
    for m in active:
        force = low[m].held if accepted else _held(low[m])
        low[m].bound, low[m].released, low[m].rise = force * (1.0 - LESS), 0.0, 0.0
    factor_state(system, work, work.trial, low)


@part
def _between(row, share):
    """The share, or one between those with which a pair is pressed and opens, where it is not between them.

    The gap has a kink where the pair begins to press: Newton's method alone may go to and fro.
    """
    if row.gap > 0.0:
        row.most = 1.0 - row.released
    else:
        row.least = 1.0 - row.released
    if row.least >= row.most:  # that was with other shares of other pairs
        row.least, row.most = -1.0, 2.0
    elif not row.least < share < row.most:
        share = math.sqrt(max(row.least, LEAST_SHARE) * min(row.most, 1.0))
        if row.most > 1.0 and share > NEARLY:
            share = 1.0
    return share
