"""Where paths with friction end: bounds whose fixed point repels, and Coulomb's own tangent."""

from dataclasses import replace

import numpy as np
import pytest

import equivbeam
from coilspring import Contact, EquilibriumNotFound, spring_a
from coilspring.friction import _determinant
from coilspring.packing import pack
from coilspring.solving import HELD, LOST
from coilspring.stability import Body
from equivbeam.model import matrix_size
from equivbeam.solve import KERNELS
from validation.campaign.scenes import make_case
from validation.campaign.verdict import SOLVERS


def solve(name):
    case = make_case(name, 1)
    return SOLVERS[case.model](case.scene, **case.options)


def test_determinant_of_coulombs_tangent():
    """Over that with the bounds held, against dense matrices of differences of the forces."""
    scene = replace(spring_a(), contact=Contact(sliding="coulomb", friction=0.3))
    path = equivbeam.solve(scene, steps=40, sliding="scene")
    data, n = pack(path.shape.data), path.states.shape[1] - 3
    size = matrix_size(path.shape.data)
    state, memory = path.states[-1], path.memories[-3].copy()  # slid since then
    KERNELS.renew(*data, state, memory)

    def force(step, *, held):
        moved, bounds, g = state.copy(), memory.copy(), np.empty(n)
        moved[3:] += step
        if not held:
            KERNELS.renew(*data, moved, bounds)
        KERNELS.assemble(*data, moved, 0.0, bounds, moved, g, np.empty(0))
        return g

    def determinant(held):
        steps = 1e-7 * np.eye(n)
        columns = [(force(step, held=held) - force(-step, held=held)) / 2e-7 for step in steps]
        free = np.ones(n, dtype=bool)
        free[-3:] = path.shape.data.held == 0.0
        return np.linalg.slogdet(np.array(columns).T[np.ix_(free, free)])

    (sign, log), (sign_held, log_held) = determinant(False), determinant(True)
    ratio = _determinant(Body(KERNELS, data, n, size), state, memory)
    assert ratio == pytest.approx(sign * sign_held * np.exp(log - log_held), rel=1e-4)
    assert abs(ratio - 1.0) > 1e-3  # sliding pairs there are


def test_repelling_bounds_are_found():
    """Sliding raises these normal forces so much that bounds renewed without relaxation are lost earlier."""
    with pytest.raises(EquilibriumNotFound) as found:
        solve("w00616")
    assert float(found.value.message.split()[-1]) > 0.545


def test_an_end_of_the_iteration_is_no_limit_point():
    with pytest.raises(EquilibriumNotFound) as found:
        solve("w00872")
    assert found.value.outcome == "not_converged"
    assert found.value.message.startswith(HELD)
    assert found.value.critical_time is None


def test_a_pair_that_opens_takes_what_it_held_with_it():
    """No sliding: its tangential force is gone at once, and the path has no neighbour to go on to."""
    with pytest.raises(EquilibriumNotFound) as found:
        solve("w00201")
    assert found.value.outcome == "not_converged"
    assert found.value.message.startswith(LOST)
