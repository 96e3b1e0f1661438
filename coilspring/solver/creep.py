"""Pairs that creep: each gives way tangentially just so that it touches.

Such a pair would open if it stuck, and be pressed if it held nothing. So it holds a force in between, with
which there is no gap. The forces of all are found by Newton's method: what each does to the gaps takes one
back substitution. In equilibrium a pair holds less by losing a share of its tangential stiffness: the
matrix keeps what is left of it.
"""

from __future__ import annotations

import math

import numpy as np

from coilspring.compiling.compiled import copy, part
from coilspring.contact.history import copy_history
from coilspring.contact.law import CREEP
from coilspring.solver.linesearch import subtract
from coilspring.solver.operations import assembled, factored, moved, solution

TOUCHES, FREE, STICKS = 0, 1, 2
GAP, SLIP, HELD = range(3)
SOLVED, OTHER, SINGULAR = range(3)
MOST_TURNS = 10  # of each pair
LESS = 1e-4  # share of a force that is changed, to see what it does
LEAST_SHARE = 1e-12  # of the stiffness: less counts as none between two shares
NEARLY = 0.5  # of the stiffness: where a pair opened with no share so far, all of it is tried from here on
NEARBY = 1e-5  # wire diameters of motion over which gaps are differentiated


@part
def renew_creep(system, task, work):
    """Renew the released shares in `work.history` of pairs that creep, at the trial state found with them.

    Returns the largest gap, or penetration of a pair that gives way, in wire diameters: up to
    `coilspring.contact.law.CREEP` nothing is changed; infinity where no answer was found.
    """
    history = work.history
    active, worst = _active(history)
    worst /= task.diameter
    if worst <= CREEP:
        return worst
    n = active.size
    opens, slips, rows = np.empty((n, n)), np.empty((n, n)), np.empty((3, n))
    _factor_sliding(system, work, active)
    for p in range(n):
        row = work.low[active[p]]
        more = LESS * row.sticking
        more = -more if row.bound > 0.5 * row.sticking else more
        copy_history(work.low, work.high)
        work.high[active[p]].bound += more
        small = answer(system, task, work)
        answered(system, work, small)
        more *= small
        for q in range(n):
            row, there = history[active[q]], work.high[active[q]]
            opens[q, p] = (there.gap - row.gap) / more
            slips[q, p] = (there.sticking - row.sticking) / more - (1.0 if p == q else 0.0)
        row = history[active[p]]
        rows[GAP, p], rows[SLIP, p], rows[HELD, p] = row.gap, row.sticking - _held(row), _held(row)
    if not complementary(opens, slips, rows):
        return np.inf
    for p in range(n):
        row, held = history[active[p]], max(rows[HELD, p], 0.0)
        sticking = held + max(rows[SLIP, p], 0.0)
        share = held / sticking if sticking > 0.0 else 1.0
        row.released = 1.0 - (_between(row, share) if n == 1 else share)
    return worst


@part
def _active(history):
    """Pairs whose force decides their gap, and the largest gap that is not as it should be, mm."""
    active, count, worst = np.empty(history.shape[0], np.int64), 0, 0.0
    for m in range(history.shape[0]):
        row = history[m]
        sticks = row.released == 0.0 and row.gap <= 0.0
        free = row.released == 1.0 and row.gap >= 0.0
        if row.creeps and not (sticks or free):
            active[count] = m
            count += 1
            worst = max(worst, abs(row.gap))
    return active[:count], worst


@part
def _held(row):
    """The tangential force of a pair that creeps."""
    return (1.0 - row.released) * row.sticking


@part
def _factor_sliding(system, work, active):
    """Gradient and factor of the trial state with the active pairs, in `work.low`, at the bounds of their
    forces."""
    low = work.low
    copy_history(work.history, low)
    for m in active:
        low[m].bound, low[m].released, low[m].rise = _held(low[m]) * (1.0 - LESS), 0.0, 0.0
    assembled(system, work.trial, 0.0, low, work.trial, work.g, work.F)
    copy(work.trial, work.factored_at)
    factored(system, work.F)


@part
def answer(system, task, work):
    """Motion `work.ahead` by which the trial state answers to the bounds in `work.high`, after those in
    `work.low`; returns the share of it over which what pairs do is nearly linear.

    `work.F` is the factor at the trial state with `work.low`, and `work.g` its gradient.
    """
    step, there = work.step, work.scratch
    assembled(system, work.trial, 0.0, work.high, work.trial, step, work.F[:0])
    subtract(work.g, step)
    solution(system, work.F, step, -1.0, work.ahead)
    moved(system, work.trial, work.ahead, 1.0, there)
    distance, _, _ = system.displacement_bound(system.reals, system.ints, work.trial, there, np.inf)
    return NEARBY * task.diameter / distance if distance > 0.0 else 1.0


@part
def answered(system, work, share):
    """What pairs do, in `work.high`, after a share of the motion `work.ahead`."""
    there = work.scratch
    moved(system, work.trial, work.ahead, share, there)
    copy_history(work.low, work.high)
    system.update_pairs(system.reals, system.ints, there, there, there, work.high)


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


@part
def complementary(opens, slips, rows):
    """Forces of pairs of which each touches, is open and holds nothing, or is pressed and does not slip.

    Gaps and slips are linear in the forces. Pairs that are none of the three are turned one at a time, those
    of least index first: where the matrices are P-matrices that ends (Murty 1974, Linear Algebra and its
    Applications 9, 93).

    Parameters
    ----------
    opens, slips : (n, n), derivatives of the gaps, mm/N, and of the slips by the forces.
    rows : (3, n), gaps, slips (as the force that they would take) and forces; the last two are replaced by
        those of the solution.

    Returns
    -------
    bool
        Whether there was a regular system to solve.
    """
    n = opens.shape[0]
    state, M = np.zeros(n, np.int64), np.empty((n, n + 1))
    found = _turned(state, opens, slips, rows, M)
    if found == OTHER:
        # the ones that what they hold closes rather are open however much they hold, or pressed
        for p in range(n):
            state[p] = TOUCHES if opens[p, p] > 0.0 else FREE if rows[GAP, p] > 0.0 else STICKS
        found = _turned(state, opens, slips, rows, M)
    if found == SINGULAR:
        return False
    for p in range(n):
        for q in range(n):
            rows[SLIP, p] += slips[p, q] * M[q, n]
        rows[HELD, p] += M[p, n]
        if state[p] != TOUCHES:
            rows[HELD if state[p] == FREE else SLIP, p] = 0.0
    return True


@part
def _turned(state, opens, slips, rows, M):
    """Turn pairs until all are what they are said to be: `SOLVED` where they are at last."""
    n = opens.shape[0]
    for turn in range(MOST_TURNS * n + 1):
        for p in range(n):
            _equation(state[p], p, opens, slips, rows, M)
        if eliminated(M) == 0:
            return SINGULAR
        p = _next(state, opens, slips, rows, M)
        if p == n:
            return SOLVED
        if turn == MOST_TURNS * n:
            break
        state[p] = TOUCHES if state[p] != TOUCHES else FREE if rows[HELD, p] + M[p, n] < 0.0 else STICKS
    return OTHER


@part
def _next(state, opens, slips, rows, M):
    """The first pair that is not what it is said to be, n where there is none."""
    n = opens.shape[0]
    for p in range(n):
        gap, slip = rows[GAP, p], rows[SLIP, p]
        for q in range(n):
            gap += opens[p, q] * M[q, n]
            slip += slips[p, q] * M[q, n]
        if state[p] == TOUCHES:
            wrong = rows[HELD, p] + M[p, n] < 0.0 or slip < 0.0
        else:
            wrong = gap < 0.0 if state[p] == FREE else gap > 0.0
        if wrong:
            return p
    return n


@part
def _equation(state, p, opens, slips, rows, M):
    """Row of a pair: no gap, no force or no slip."""
    n = opens.shape[0]
    for q in range(n):
        if state == TOUCHES:
            M[p, q] = opens[p, q]
        elif state == STICKS:
            M[p, q] = slips[p, q]
        else:
            M[p, q] = 1.0 if p == q else 0.0
    if state == TOUCHES:
        M[p, n] = -rows[GAP, p]
    elif state == STICKS:
        M[p, n] = -rows[SLIP, p]
    else:
        M[p, n] = -rows[HELD, p]


@part
def eliminated(M):
    """Solve a system with its right side in the last column, in place.

    Returns the sign of the determinant, 0 where the system is singular.
    """
    n, sign = M.shape[0], 1
    for i in range(n):  # equations of different units
        most = 0.0
        for j in range(n):
            most = max(most, abs(M[i, j]))
        for j in range(n + 1):
            M[i, j] = M[i, j] / most if most > 0.0 else 0.0
    for k in range(n):
        pivot = k
        for i in range(k + 1, n):
            if abs(M[i, k]) > abs(M[pivot, k]):
                pivot = i
        if not abs(M[pivot, k]) > 0.0:
            return 0
        if (pivot != k) != (M[pivot, k] < 0.0):
            sign = -sign
        for j in range(k, n + 1):
            M[k, j], M[pivot, j] = M[pivot, j], M[k, j]
        for i in range(n):
            if i != k:
                factor = M[i, k] / M[k, k]
                for j in range(k, n + 1):
                    M[i, j] -= factor * M[k, j]
    for k in range(n):
        M[k, n] /= M[k, k]
    return sign
