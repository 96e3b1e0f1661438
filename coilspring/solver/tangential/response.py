"""How a trial state answers to what its pairs hold, and how gaps and slips change as it moves: exactly."""

from coilspring.compiling.compiled import part
from coilspring.solver.equilibrium.operations import solution
from coilspring.solver.system import DOF


@part
def unit_force_response(system, work, m):
    """Motion `work.ahead` by which the trial state answers to a tangential force of 1 N more of a pair;
    returns the pair's tangential length. `work.F` is the factor, `work.low` the history of the state."""
    length = gradient_of(system, work, m, work.step)
    solution(system, work.F, work.step, -1.0, work.ahead)
    return length


@part
def gradient_of(system, work, m, g):
    """Fill the gradient of a pair's tangential length at the trial state; returns the length."""
    length = system.length_gradient(system.reals, system.ints, work.trial, work.low, m, g)
    if system.prescribed.size > 0:
        g[int(system.prescribed[DOF])] = 0.0
    return length


@part
def find_rates(system, work, rates):
    """Fill the rates (pairs, 2) of gaps and tangential lengths of held pairs with the motion `work.ahead`."""
    system.pair_rates(system.reals, system.ints, work.trial, work.ahead, work.low, rates)
