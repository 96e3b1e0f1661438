"""A model's kernels with its constraint: what is prescribed has no gradient, and stays where it is put."""

from coilspring.compiling.compiled import copy, part
from coilspring.solver.system import CHANGE, DIAGONAL, DOF, PLACE, STIFFNESS


@part
def assembled(system, accepted, least_gap, history, state, g, H):
    """Energy and pairs evaluated; fills the gradient, and the matrix unless it is empty.

    `accepted` and `least_gap`: see `coilspring.solver.interface`. What is prescribed has no gradient, and is
    fixed by its stiffness.
    """
    energy, pairs = system.assemble(system.reals, system.ints, accepted, least_gap, history, state, g, H)
    top = system.prescribed
    if top.size > 0:
        dof = int(top[DOF])
        system.reaction[0] = g[dof]
        g[dof] = 0.0
        if H.size > 0:
            H[int(top[DIAGONAL])] += top[STIFFNESS]
    return energy, pairs


@part
def factored(system, F):
    """LDL^T of `F` in place; negative pivots, and the least one."""
    return system.factor(system.reals, system.ints, F)


@part
def factor_state(system, work, state, history):
    """Factor, in `work.F`, of the matrix at a state with a contact history; returns its negative pivots."""
    assembled(system, state, 0.0, history, state, work.g, work.F)
    copy(state, work.factored_at)
    negative, _ = factored(system, work.F)
    return negative


@part
def solve(system, F, b):
    """b = F^-1 b; what is prescribed stays as it is, unless b holds what moves it."""
    top = system.prescribed
    fixed = int(top[DOF]) if top.size > 0 else -1
    if fixed >= 0 and b[fixed] != 0.0:
        fixed = -1
    system.solve(system.reals, system.ints, F, b)
    if fixed >= 0:
        b[fixed] = 0.0


@part
def solution(system, F, b, sign, out):
    """out = sign F^-1 b."""
    for i in range(b.size):
        out[i] = sign * b[i]
    solve(system, F, out)


@part
def stale_solution(system, work, state, b, sign, out):
    """out = sign F^-1 b at `state`, with the factor of the state `work.factored_at`, turned along."""
    for i in range(b.size):
        out[i] = sign * b[i]
    system.rotate(system.reals, system.ints, state, work.factored_at, out)
    solve(system, work.F, out)
    system.rotate(system.reals, system.ints, work.factored_at, state, out)


@part
def moved(system, state, step, factor, out):
    """The state moved by ``factor * step``."""
    system.retract(system.reals, system.ints, state, step, factor, state, 0.0, out)


@part
def put_prescribed(system, start, time, state):
    """Put what is prescribed to where it is at a time."""
    top = system.prescribed
    if top.size > 0:
        place = int(top[PLACE])
        state[place] = start[place] + time * top[CHANGE]
