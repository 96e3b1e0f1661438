"""How the bounds of friction rise with the slips: what the matrix knows of Coulomb's law.

Where less friction lets the pairs slide on, the normal forces and so the bounds change. One number for all
pairs, as a share of their bounds per slip, does the same work on that way. Towards a limit point that way is
the softest mode, and the symmetric matrix loses its stability about where Coulomb's own tangent does (with
one pair that slides, just there); elsewhere the rise only speeds up the renewal of the bounds.
"""

from __future__ import annotations

import numpy as np

from coilspring.compiled import copy_table, part
from coilspring.linesearch import solution, subtract
from coilspring.pairlaw import BOUND, ON, RISE, WAY

LESS = 1e-4  # share by which friction is taken back
NEARBY = 1e-5  # wire diameters of the way: bounds of hard contact are far from straight lines over it
# Share of the bounds, up or down, over a slip of a wire diameter; more is seen only where slips are stiff.
MOST_RISE = 1.0


@part
def rise_of_bounds(
    reals,
    ints,
    state,
    memory,
    F,
    diameter,
    g,
    push,
    far,
    near,
    moved,
    assemble,
    solve,
    retract,
    motion,
    renew,
):
    """Rise of the bounds, 1/mm, at an equilibrium found with `memory`.

    `F` is the factor of its matrix, and `g` its gradient without a load; `push`, `far`, `near` and `moved`
    are scratch.
    """
    copy_table(memory, far)
    for m in range(far.shape[0]):
        far[m, BOUND] *= 1.0 - LESS
    assemble(reals, ints, state, 0.0, far, state, push, F[:0])
    subtract(push, g)
    solution(reals, ints, F, g, 1.0, push, solve)
    retract(reals, ints, state, push, 1.0, state, 0.0, moved)
    way, _, _ = motion(reals, ints, state, moved, np.inf)
    small = NEARBY * diameter / way if way > 0.0 else 0.0
    copy_table(memory, far)
    copy_table(memory, near)
    retract(reals, ints, state, push, small, state, 0.0, moved)
    renew(reals, ints, moved, far)
    retract(reals, ints, state, push, -small, state, 0.0, moved)
    renew(reals, ints, moved, near)
    most = MOST_RISE / diameter
    return min(max(_rise(near, far), -most), most)


@part
def _rise(near, far):
    """From the memories renewed on both sides of the state, of which the second slid farther."""
    work, whole = 0.0, 0.0
    for m in range(near.shape[0]):
        if near[m, ON] > 0.0 and far[m, WAY] > abs(near[m, WAY]):
            way = far[m, WAY] - near[m, WAY]
            first = near[m, BOUND] * (1.0 + near[m, RISE] * max(near[m, WAY], 0.0))
            last = far[m, BOUND] * (1.0 + far[m, RISE] * max(far[m, WAY], 0.0))
            work += (last - first) * way
            whole += 0.5 * (first + last) * way * way
    return work / whole if whole > 0.0 else 0.0
