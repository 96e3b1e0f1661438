"""Motion of the wire along a step: deformations follow it linearly, the shape follows from them."""

from types import SimpleNamespace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import wirefe
from coilspring import Material, load_scene
from coilspring.compiling.packing import pack
from coilspring.scene.wire import round_section
from coilspring.solver.continuation.branch import predict
from coilspring.solver.system import System
from wirefe import kernels, model
from wirefe.element.beam import deformations
from wirefe.solve import KERNELS, scene_problem

LENGTH, COUNT = 100.0, 20


def spring(element, count):
    problem, _, _ = scene_problem(load_scene("spring-a"), element, count, 4)
    free = np.ones(problem.load.size)
    free[problem.data.held.dof] = 0.0
    return problem, free


def literal(state, step):
    """Positions plus dx, rotations turned by the exponential of the spin."""
    old, new, move = state.reshape(-1, 7), state.reshape(-1, 7).copy(), step.reshape(-1, 6)
    new[:, :3] += move[:, :3]
    turned = Rotation.from_rotvec(move[:, 3:]) * Rotation.from_quat(old[:, 3:], scalar_first=True)
    new[:, 3:] = turned.as_quat(scalar_first=True)
    new[:, 3:] *= np.sign((new[:, 3:] * old[:, 3:]).sum(axis=1))[:, None]
    return new.ravel()


def moved(data, state, step, factor=1.0):
    out = np.empty_like(state)
    kernels.retract(*pack(data), state, step, factor, state, 0.0, out)
    return out


def wave(problem, free, size, seed=0):
    """A smooth step that leaves both ends' held dofs alone."""
    along = np.linspace(0.0, 1.0, free.size // 6)[:, None]
    shift = np.random.default_rng(seed).random(6)
    return (size * np.sin(3.0 * along + shift) * along * [5, 5, 5, 0.3, 0.3, 0.3]).ravel() * free


@pytest.mark.parametrize(("element", "count", "most"), [("straight", 40, 2e-16), ("curved", 4, 1e-15)])
def test_no_step_makes_the_wire_longer(element, count, most):
    """Rounding of rotations adds up along the wire, and would stretch all of it: then contact that is stiff
    takes twice as many factorisations. Measured 5e-17 and 3e-16 in the mean, at most."""
    problem, free = spring(element, count)
    chain, state = problem.data.elements, moved(problem.data, problem.start, wave(problem, free, 1.0))
    for seed in range(20):
        kept = moved(problem.data, state, 0.0 * free)
        after, before = np.empty_like(chain.strain0), np.empty_like(chain.strain0)
        deformations(kept, chain.arm, chain.triads, after)
        deformations(state, chain.arm, chain.triads, before)
        longer = np.linalg.norm(after[:, :3], axis=1) / np.linalg.norm(before[:, :3], axis=1) - 1.0
        assert abs(longer.mean()) < most
        state = moved(problem.data, state, 1e-9 * wave(problem, free, 1.0, seed))


@pytest.mark.parametrize(("element", "count"), [("straight", 40), ("curved", 4)])
def test_it_is_the_step_to_first_order(element, count):
    """The rest falls with the square of the length, at a deformed state too."""
    problem, free = spring(element, count)
    state = moved(problem.data, problem.start, wave(problem, free, 1.0))
    step = wave(problem, free, 1.0, seed=1)
    rest = [
        np.abs(moved(problem.data, state, step, f) - literal(state, f * step)).max() for f in (1e-2, 1e-3)
    ]
    assert rest[0] / rest[1] == pytest.approx(100.0, rel=0.05)
    assert rest[1] < 1e-4


def test_held_freedoms_stay_where_they_are():
    problem, free = spring("straight", 40)
    state = moved(problem.data, problem.start, wave(problem, free, 3.0))
    first, last = state.reshape(-1, 7)[[0, -1]]
    np.testing.assert_array_equal(first, problem.start[:7])
    assert last[2] == problem.start[-5]  # UZ, and no rotation but about Z
    np.testing.assert_allclose(last[4:6], 0.0, atol=1e-15)


def cantilever():
    points = np.zeros((COUNT + 1, 3))
    points[:, 0] = np.linspace(0.0, LENGTH, COUNT + 1)
    rod = wirefe.straight_rod(points, round_section(2.0, Material())).holding(0)
    return model.rod_model(rod, np.zeros(3)), model.rest_state(rod, np.zeros(3))


def test_bending_does_not_stretch():
    """A cantilever's spins s kappa, and the motions that go with them, roll it to a circle: half a turn."""
    data, state = cantilever()
    s = np.linspace(0.0, LENGTH, COUNT + 1)
    step = np.zeros((COUNT + 1, 6))
    step[:, 5] = s / LENGTH
    # the deflection of a polygon whose corners turn: each side by the mean spin of its ends
    step[1:, 1] = np.cumsum(0.5 * (step[1:, 5] + step[:-1, 5]) * np.diff(s))
    rolled = moved(data, state, step.ravel(), np.pi).reshape(-1, 7)[:, :3]
    sides = np.linalg.norm(np.diff(rolled, axis=0), axis=1)
    np.testing.assert_allclose(sides, LENGTH / COUNT, rtol=1e-13)
    radius = 0.5 * sides[0] / np.sin(0.5 * np.pi / COUNT)  # a regular polygon's
    np.testing.assert_allclose(
        rolled[-1], [0.0, 2.0 * radius, 0.0], atol=1e-2 * radius
    )  # a side turns by 2 atan(w/2)


def test_the_prediction_meets_the_state_before():
    """The parabola through two states along the tangent, back by the time between them."""
    problem, free = spring("straight", 40)
    tangent = wave(problem, free, 1.0, seed=2)
    before = moved(problem.data, problem.start, wave(problem, free, 0.5))
    out = np.empty_like(before)
    system = System(*pack(problem.data), problem.prescribed, np.zeros(1), *KERNELS)
    work = SimpleNamespace(state=problem.start, before=before, tangent=tangent, predicted=out)
    path = SimpleNamespace(time=0.5, last_step=0.2)
    predict(system, SimpleNamespace(start=problem.start), work, path, 1.0, 0.3)
    np.testing.assert_allclose(out, before, atol=1e-10)


def test_a_step_turned_along_and_back():
    problem, free = spring("straight", 40)
    state = moved(problem.data, problem.start, wave(problem, free, 1.0))
    step = wave(problem, free, 1.0, seed=3)
    arrays, there = pack(problem.data), step.copy()
    kernels.rotate(*arrays, problem.start, state, there)
    turn = Rotation.from_quat(state.reshape(-1, 7)[1:-1, 3:], scalar_first=True)
    for half in (slice(0, 3), slice(3, 6)):
        old, new = (v.reshape(-1, 6)[1:-1, half] for v in (step, there))
        np.testing.assert_allclose(new, turn.apply(old), atol=1e-14)
    kernels.rotate(*arrays, state, problem.start, there)
    np.testing.assert_allclose(there, step, atol=1e-12)
