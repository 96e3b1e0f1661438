"""Bounds of friction that are those of the normal forces, and the stability of what slides.

With the bounds b the equilibrium q(b) has a potential with the matrix H, and normal forces that give the
bounds B(q). Renewing takes B for b. Newton's method solves B - b = 0: how B changes with the bound of a pair
that slides takes one back substitution. The tangent of Coulomb's law, which has no potential, has the
determinant det(H) det(1 - dB/db).

Where less friction lets the pairs slide on, the normal forces and so the bounds change. One number for all
pairs, their rise as a share of the bounds per slip, does the same work on that motion. With it H loses its
stability about where Coulomb's tangent does (with one pair that slides, just there). Once the bounds are
found it has no effect: where H is indefinite, a larger one makes it positive, and the determinant decides.
"""

import numpy as np

from coilspring.compiling.compiled import clear, part
from coilspring.contact.history import copy_history, set_rise
from coilspring.contact.law import rate_by_bound
from coilspring.contact.rates import GAP_RATE, LENGTH_RATE
from coilspring.solver.equilibrium.newton import INDEFINITE
from coilspring.solver.equilibrium.operations import factor_state, solution
from coilspring.solver.tangential.complementarity import eliminated
from coilspring.solver.tangential.response import find_rates, gradient_of, unit_force_response

WHOLE = 1.0 - 1e-9  # of the tangential stiffness, but for rounding
# Share of the bounds, up or down, over a slip of a wire diameter; more is seen only where slips are stiff.
MOST_RISE = 1.0
RAISED = 4.0  # times as much where H is indefinite,
HIGHEST = 1e5  # up to this
LOWERED = 2.0  # and less by so much where it no longer is
# Steps along the flow of bounds are 1 / damping long: from round to round by so much longer, and shorter
# where one would go beyond what is stable.
LONGER, SHORTER = 2.0, 8.0
LEAST_DAMPING, MOST_DAMPING = 1e-9, 1e12  # with more, rises are no numbers: bounds are just renewed


@part
def slides_stably(system, task, work, path, substep):
    """Whether the trial state, where pairs slide, is stable; sets how their bounds rise, and the tangent."""
    friction = path.friction
    friction.slid = True
    path.spent += 1
    if factor_state(system, work, work.trial, work.trial_history) > 0:
        substep.trouble, substep.unstable = INDEFINITE, True
        return False
    friction.rise = rise_of_bounds(system, task, work)
    if friction.raised > 0.0:
        copy_history(work.trial_history, work.low)
        set_rise(work.low, friction.rise)
        path.spent += 1
        if factor_state(system, work, work.trial, work.low) == 0:
            # the next prediction may be as far off as this one was
            lowers = friction.raised * task.diameter > MOST_RISE / RAISED
            friction.raised = friction.raised / LOWERED if lowers else 0.0
        friction.rise = max(friction.rise, friction.raised)
    path.spent += 1
    substep.turned = slide_tangent(system, task, work) < 0
    return not substep.turned


@part
def raise_bounds(work, path, diameter):
    """Let bounds rise more steeply with the slips, where the matrix is indefinite otherwise."""
    friction = path.friction
    if friction.raised * diameter < HIGHEST:
        friction.raised = max(RAISED * friction.raised, MOST_RISE / diameter)
        set_rise(work.history, friction.raised)


@part
def solve_bounds(system, task, work):
    """One step of Newton's method for the bounds in `work.history`, which are B at the trial state, found
    with those in `work.trial_history`.

    Returns the sign of the determinant of Coulomb's tangent; 0 where it is singular, and nothing is changed.
    """
    sliding, rises, _, negative = _rises(system, task, work)
    sign = _step(work, sliding, rises, 0.0)
    return sign if negative % 2 == 0 else -sign


@part
def let_flow(system, task, work, substep):
    """Let the bounds go where those of the normal forces lead them: they follow db/ds = B(b) - b.

    A step of the implicit Euler method, longer from round to round (pseudo-transient continuation): far from
    a solution that is stable it goes no farther than the flow does, near it it is one of Newton's method.
    Returns whether a solution near would be stable.
    """
    sliding, rises, _, negative = _rises(system, task, work)
    copy_history(work.history, work.low)
    sign = _step(work, sliding, rises, 0.0)
    stable = negative == 0 and sign > 0
    substep.damping = max(substep.damping / LONGER, LEAST_DAMPING)
    while (substep.damping > LEAST_DAMPING or not stable) and substep.damping < MOST_DAMPING:
        copy_history(work.low, work.history)
        if _step(work, sliding, rises, substep.damping) > 0:
            break
        substep.damping *= SHORTER
    return stable


@part
def _rises(system, task, work):
    """Pairs that slide in the trial state; how the bounds of all pairs change with theirs (pairs, sliding),
    and the state (sliding, dofs); and the negative pivots of its matrix, which `work.F` factors."""
    history, held = work.history, work.trial_history
    sliding = _sliding(history, held)
    n, pairs = sliding.size, history.shape[0]
    rises, rates, motions = np.empty((pairs, n)), np.empty((pairs, 2)), np.empty((n, task.load.size))
    copy_history(held, work.low)
    negative = factor_state(system, work, work.trial, work.low)
    for p in range(n):
        length = unit_force_response(system, work, sliding[p])
        more = rate_by_bound(length, held[sliding[p]])
        for i in range(task.load.size):
            motions[p, i] = more * work.ahead[i]
        _find_rates(system, task, work, rates)
        for m in range(pairs):
            rises[m, p] = more * _rate_of_bound(history[m], held[m], rates[m, 0], rates[m, 1])
    return sliding, rises, motions, negative


@part
def _rate_of_bound(row, held, force, slides):
    """Rate of a pair's bound b by those of mu F and of the slip: b (1 + r s) = mu F."""
    if not held.closed:
        return 0.0
    slip = max(row.slip, 0.0)
    slides = slides if slip > 0.0 else 0.0
    return (force - row.bound * held.rise * slides) / (1.0 + held.rise * slip)


@part
def slide_tangent(system, task, work):
    """Set `work.ahead` to the tangent of the path by Coulomb's law at the trial state, where pairs slide.

    Along it their bounds change with the normal forces; with bounds that stay it would be another one.
    Returns the sign of the determinant of the law's tangent, 0 where that is singular.
    """
    history, held = work.history, work.trial_history
    sliding, rises, motions, negative = _rises(system, task, work)
    n, rates = sliding.size, np.empty((history.shape[0], 2))
    solution(system, work.F, task.load, 1.0, work.ahead)
    _find_rates(system, task, work, rates)
    M = _bounds_matrix(sliding, rises, 0.0)
    for q in range(n):
        m = sliding[q]
        M[q, n] = _rate_of_bound(history[m], held[m], rates[m, 0], rates[m, 1])
    sign = eliminated(M)
    if sign != 0:
        for p in range(n):
            for i in range(task.load.size):
                work.ahead[i] += M[p, n] * motions[p, i]
    return sign if negative % 2 == 0 else -sign


@part
def _bounds_matrix(sliding, rises, damping):
    """1 + damping - dB/db, with room for a right side: (n, n + 1)."""
    n = sliding.size
    M = np.empty((n, n + 1))
    for q in range(n):
        for p in range(n):
            M[q, p] = (1.0 + damping if p == q else 0.0) - rises[sliding[q], p]
    return M


@part
def _step(work, sliding, rises, damping):
    """Solve (1 + damping - dB/db) step = B - b, and take the step; returns the sign of the determinant, 0
    where it vanishes, and nothing is changed."""
    history, held, n = work.history, work.trial_history, sliding.size
    M = _bounds_matrix(sliding, rises, damping)
    for q in range(n):
        m = sliding[q]
        M[q, n] = history[m].bound - held[m].bound
    sign = eliminated(M)
    if sign == 0:
        return 0
    for p in range(n):
        history[sliding[p]].bound = held[sliding[p]].bound + M[p, n]
    for m in range(history.shape[0]):
        if not (held[m].closed and held[m].bound > 0.0 and history[m].slip > 0.0):
            for p in range(n):
                history[m].bound += rises[m, p] * M[p, n]
        history[m].bound = max(history[m].bound, 0.0)
    return sign


@part
def _sliding(history, held):
    """Pairs that slide in the trial state, found with the bounds `held`."""
    sliding, count = np.empty(history.shape[0], np.int64), 0
    for m in range(history.shape[0]):
        if held[m].closed and held[m].bound > 0.0 and history[m].slip > 0.0:
            sliding[count] = m
            count += 1
    return sliding[:count]


@part
def _find_rates(system, task, work, rates):
    """Fill the rates (pairs, 2) of the bounds of the normal forces and of the slips with `work.ahead`, where
    `work.history` has the bounds of the normal forces at the trial state."""
    find_rates(system, work, rates)
    for m in range(rates.shape[0]):
        row = work.history[m]
        bound = -row.steepness * rates[m, GAP_RATE] if row.closed else 0.0
        # where hard contact just touches, its stiffness falls with the bound
        slip = rates[m, LENGTH_RATE] - (bound / row.whole if row.stiffness > WHOLE * row.whole else 0.0)
        rates[m, 0], rates[m, 1] = bound, slip


@part
def rise_of_bounds(system, task, work):
    """Rise of the bounds, 1/mm, at the trial state, an equilibrium found with `work.trial_history`.

    `work.F` is the factor of its matrix; `work.step`, `work.ahead` and the table `low` are overwritten.
    """
    pairs, pull = work.history.shape[0], work.scratch[: task.load.size]
    rates, rise, whole = np.empty((pairs, 2)), 0.0, 0.0
    copy_history(work.trial_history, work.low)
    clear(pull)
    for m in _sliding(work.history, work.low):
        row = work.low[m]
        share = row.bound * rate_by_bound(gradient_of(system, work, m, work.step), row)
        for i in range(pull.size):
            pull[i] += share * work.step[i]
    solution(system, work.F, pull, 1.0, work.ahead)
    _find_rates(system, task, work, rates)
    for m in range(pairs):
        row = work.history[m]
        if row.closed and row.bound < np.inf and row.slip > 0.0 and rates[m, 1] > 0.0:
            rise += rates[m, 0] * rates[m, 1]
            whole += row.bound * (1.0 + row.rise * row.slip) * rates[m, 1] ** 2
    most = MOST_RISE / task.diameter
    return min(max(rise / whole, -most), most) if whole > 0.0 else 0.0
