"""How the bounds of friction rise with the slips: what the matrix knows of Coulomb's law.

Where less friction lets the pairs slide on, the normal forces and so the bounds change. One number for all
pairs, as a share of their bounds per slip, does the same work on that motion. Towards a limit point it is
the softest mode, and the symmetric matrix loses its stability about where Coulomb's own tangent does (with
one pair that slides, just there); elsewhere the rise only speeds up the renewal of the bounds.
"""

from __future__ import annotations

import numpy as np

from coilspring.compiling.compiled import part
from coilspring.contact.history import copy_history
from coilspring.solver.linesearch import subtract
from coilspring.solver.operations import assembled, moved, solution

LESS = 1e-4  # share by which friction is taken back
NEARBY = 1e-5  # wire diameters of slip: bounds of hard contact are far from straight lines over it
# Share of the bounds, up or down, over a slip of a wire diameter; more is seen only where slips are stiff.
MOST_RISE = 1.0


@part
def rise_of_bounds(system, task, work):
    """Rise of the bounds, 1/mm, at the trial state, an equilibrium found with `work.trial_history`.

    `work.F` is the factor of its matrix, and `work.g` its gradient without a load; `work.step`,
    `work.predicted` and the tables `low` and `high` are overwritten.
    """
    state, step, there, near, far = work.trial, work.step, work.predicted, work.low, work.high
    copy_history(work.trial_history, far)
    for m in range(far.shape[0]):
        far[m].bound *= 1.0 - LESS
    assembled(system, state, 0.0, far, state, step, work.F[:0])
    subtract(step, work.g)
    solution(system, work.F, work.g, 1.0, step)
    moved(system, state, step, 1.0, there)
    distance, _, _ = system.displacement_bound(system.reals, system.ints, state, there, np.inf)
    small = NEARBY * task.diameter / distance if distance > 0.0 else 0.0
    copy_history(work.trial_history, far)
    copy_history(work.trial_history, near)
    moved(system, state, step, small, there)
    system.update_pairs(system.reals, system.ints, there, there, there, far)
    moved(system, state, step, -small, there)
    system.update_pairs(system.reals, system.ints, there, there, there, near)
    most = MOST_RISE / task.diameter
    return min(max(_rise(near, far), -most), most)


@part
def _rise(near, far):
    """From the histories renewed on both sides of the state, of which the second slid farther."""
    work, whole = 0.0, 0.0
    for m in range(near.shape[0]):
        if near[m].closed and far[m].slip > abs(near[m].slip):
            slip = far[m].slip - near[m].slip
            first = near[m].bound * (1.0 + near[m].rise * max(near[m].slip, 0.0))
            last = far[m].bound * (1.0 + far[m].rise * max(far[m].slip, 0.0))
            work += (last - first) * slip
            whole += 0.5 * (first + last) * slip * slip
    return work / whole if whole > 0.0 else 0.0
