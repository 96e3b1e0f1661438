"""Where paths with friction end: limit points of Coulomb's law, and its own tangent."""

from dataclasses import replace

import numpy as np
import pytest

import equivbeam
from coilspring import Contact, EquilibriumNotFound, spring_a
from coilspring.compiling.packing import pack
from coilspring.solver.coulomb import SLACK, coulomb
from coilspring.solver.solve import HELD
from coilspring.solver.stability import Body
from equivbeam.model import matrix_size
from equivbeam.solve import KERNELS
from validation.campaign.scenes import make_case
from validation.campaign.verdict import SOLVERS, Verdict, reached, under
from validation.campaign.wire import wire_forces
from validation.campaign.wireverifier import verify_wire_critical


def solve(name, seed=1):
    case = make_case(name, seed, "spheres")
    return SOLVERS[case.model](case.scene, **case.options)


def test_determinant_of_coulombs_tangent():
    """Over that with the bounds held, against dense matrices of differences of the forces."""
    scene = replace(spring_a(), contact=Contact(sliding="coulomb", friction=0.3))
    path = equivbeam.solve(scene, steps=40, sliding="scene")
    data, n = pack(path.shape.data), path.states.shape[1] - 3
    size = matrix_size(path.shape.data)
    state, history = path.states[-1], path.histories[-3].copy()  # slid since then
    history["rise"] = 0.0
    KERNELS.update_pairs(*data, state, state, state, history)
    slack = np.where(history["closed"], SLACK * history["bound"], 0.0)

    def force(step, *, held):
        moved, bounds, g = state.copy(), history.copy(), np.empty(n)
        moved[3:] += step
        if not held:
            KERNELS.update_pairs(*data, moved, moved, moved, bounds)
        bounds["bound"] -= slack
        KERNELS.assemble(*data, moved, 0.0, bounds, moved, g, np.empty(0))
        return g

    def tangent(held):
        steps = 1e-7 * np.eye(n)
        columns = [(force(step, held=held) - force(-step, held=held)) / 2e-7 for step in steps]
        free = np.ones(n, dtype=bool)
        free[-3:] = path.shape.data.fixed == 0.0
        return np.array(columns).T[np.ix_(free, free)], free

    (A, free), (H, _) = tangent(False), tangent(True)
    (sign, log), (sign_held, log_held) = np.linalg.slogdet(A), np.linalg.slogdet(H)
    body, load = Body(KERNELS, data, n, size), np.where(free, 1.0, 0.0)
    ratio, rate = coulomb(body, state, history, load, path.scene.spring.wire_diameter)
    assert ratio == pytest.approx(sign * sign_held * np.exp(log - log_held), rel=1e-4)
    assert abs(ratio - 1.0) > 1e-3  # sliding pairs there are
    np.testing.assert_allclose(
        rate[free], np.linalg.solve(A, load[free]), rtol=1e-4, atol=1e-6 * np.abs(rate).max()
    )


@pytest.mark.parametrize(
    ("name", "time"), [("w00182", 0.7783), ("w00139", 0.5743), ("w00263", 0.4357), ("w00691", 0.56618)]
)
def test_coils_that_slide_off_each_other_reach_a_limit_point(name, time):
    """Held bounds lose their stability earlier than Coulomb's law, or later."""
    with pytest.raises(EquilibriumNotFound) as found:
        solve(name)
    assert found.value.outcome == "limit_point"
    assert found.value.critical_time == pytest.approx(time, abs=2e-4)
    assert found.value.path.critical_bracket <= 2e-6


@pytest.mark.parametrize("name", ["w00186", pytest.param("w00474", marks=pytest.mark.slow)])
def test_limit_point_is_that_of_coulombs_own_tangent(name):
    """Unsymmetric, in plain numpy: it becomes singular there and nowhere else."""
    case = make_case(name, 1, "spheres")
    path, forces = reached(case), wire_forces(case.scene, **case.options)
    assert forces.pairs(reached(case, under(case.scene, 0.999 * path.critical_time)), -1).slides.any()
    for share in (1.0, 0.99):
        verdict = Verdict()
        claimed = replace(path, critical_time=share * path.critical_time)
        verify_wire_critical(verdict, forces, case, claimed)
        assert bool(verdict.complaints) == (share < 1.0)


def test_where_the_iteration_alone_ends_is_no_critical_point():
    with pytest.raises(EquilibriumNotFound) as found:
        solve("w00247", seed=2)
    assert found.value.outcome == "not_converged"
    assert found.value.message.startswith(HELD)
    assert found.value.critical_time is None
