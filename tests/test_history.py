"""Loads of several stages and prescribed displacements."""

from dataclasses import replace

import numpy as np
import pytest

import equivbeam
import wirefe
from coilspring import Contact, EquilibriumNotFound, InputError, Load, Supports, spring_a, spring_b
from coilspring.compiling.packing import pack
from coilspring.curves import compare_paths
from coilspring.scene.load import given_loads
from coilspring.solver.equilibrium.operations import assembled, factored, moved, put_prescribed, solution
from coilspring.solver.system import System
from equivbeam.model import beam_problem
from equivbeam.solve import KERNELS as BEAM_KERNELS
from wirefe.solve import KERNELS as WIRE_KERNELS
from wirefe.solve import scene_problem

CURVED = {"element": "curved", "elements_per_turn": 8}
MODELS = [(equivbeam.solve, {}), (wirefe.solve, CURVED)]
FREE_B = replace(spring_b(), contact=Contact(geometry="spheres", sliding="free"))
BARE_A = spring_a().without_contact()
TO_FULL = ((0.0, -50.0), (0.0, -100.0))


def staged(scene, *stages, steps=10):
    return replace(scene, load=Load(stages=stages, steps=steps))


def pressed(scene, *ways, steps=10):
    return replace(scene, load=Load(displacement=ways, steps=steps))


@pytest.mark.parametrize(("solve", "options"), MODELS)
@pytest.mark.parametrize("sliding", ["free", "none"])
def test_two_halves_of_a_load_are_the_whole(solve, options, sliding):
    scene = replace(
        spring_b(), contact=Contact(geometry="spheres", sliding=sliding), load=Load((0.0, -100.0), 20)
    )
    whole, halves = solve(scene, **options), solve(staged(scene, *TO_FULL), **options)
    assert halves.active_contacts[-1] > 0
    np.testing.assert_array_equal(halves.times, whole.times)
    np.testing.assert_allclose(halves.loads, whole.loads, atol=1e-12)
    np.testing.assert_allclose(halves.tips, whole.tips, atol=1e-4 if sliding == "none" else 1e-7)


@pytest.mark.parametrize(("solve", "options"), MODELS)
def test_without_friction_the_way_back_is_the_way_there(solve, options):
    path = solve(staged(FREE_B, (0.0, -100.0), (0.0, 0.0)), **options)
    there, back = path.tips[:9], path.tips[10:19][::-1]
    assert path.active_contacts.max() > 0
    np.testing.assert_allclose(back, there, atol=1e-7)
    np.testing.assert_allclose(path.tips[-1], 0.0, atol=1e-9)
    np.testing.assert_allclose(path.loads[[9, 14, 19], 1], [-100.0, -50.0, 0.0], atol=1e-12)


@pytest.mark.parametrize(("solve", "options"), MODELS)
@pytest.mark.parametrize("first", [(-9.0, 0.0), (0.0, -4.0), (0.0, 4.0)])
def test_the_order_of_dead_loads_does_not_matter_without_contact(solve, options, first):
    straight = solve(replace(BARE_A, load=Load((-9.0, -4.0), 10)), **options)
    path = solve(staged(BARE_A, first, (-9.0, -4.0)), **options)
    np.testing.assert_allclose(path.loads[[9, 19]], [first, (-9.0, -4.0)], atol=1e-12)
    np.testing.assert_allclose(path.tips[-1], straight.tips[-1], rtol=1e-6)


@pytest.mark.parametrize(("solve", "options"), MODELS)
def test_forces_on_what_is_held_do_nothing(solve, options):
    plain, pushed = (solve(staged(FREE_B, (x, -30.0), (-2.0 * x, -60.0)), **options).tips for x in (0.0, 7.0))
    np.testing.assert_array_equal(pushed, plain)


@pytest.mark.parametrize(
    ("solve", "options"), [(equivbeam.solve, {"sliding": "scene"}), (wirefe.solve, CURVED)]
)
def test_a_loop_takes_the_work_of_friction(solve, options):
    """Loaded and unloaded: what the load loses is what the pairs' friction has taken; 1.1 % found."""
    scene = replace(spring_b(), contact=Contact(geometry="spheres", sliding="coulomb", friction=0.1))
    path = solve(staged(scene, (0.0, -120.0), (0.0, 0.0), steps=200), **options)
    lost = np.trapezoid(np.append(0.0, path.loads[:, 1]), np.append(0.0, path.tips[:, 1]))
    taken = np.maximum(np.diff(path.friction.work, axis=0, prepend=0.0), 0.0).sum()
    assert taken > 0.01
    assert lost == pytest.approx(taken, rel=0.03)
    np.testing.assert_allclose(path.tips[-1], 0.0, atol=1e-9)


def test_a_path_that_ends_in_its_second_stage_says_when():
    """The limit point at 0.983755 of 200 N, between 100 and 250 N."""
    soft = replace(FREE_B, contact=Contact(geometry="spheres", stiffness=400.0))
    with pytest.raises(EquilibriumNotFound) as caught:
        equivbeam.solve(staged(soft, (0.0, -100.0), (0.0, -250.0), steps=50))
    expected = 0.5 + 0.5 * (0.983755 * 200.0 - 100.0) / 150.0
    assert caught.value.outcome == "limit_point"
    assert caught.value.critical_time == pytest.approx(expected, abs=2e-6)
    assert len(caught.value.path.times) == 82 == np.floor(100 * expected)


def test_stages_start_anew_with_what_was_found():
    """Wires so soft that neighbours touch elsewhere than one turn apart."""
    options = {"element": "curved", "elements_per_turn": 40, "pairs_per_turn": 40, "penalty": 30.0}
    x, y = np.array(spring_a().load.force)
    scene = staged(spring_a(), (0.5 * x, 0.5 * y), (x, y), steps=2)
    whole = wirefe.solve(spring_a(), steps=4, **options)
    path = wirefe.solve(scene, **options)
    assert min(each.options["pairs_found"] for each in (whole, path)) > 10
    np.testing.assert_allclose(path.tips[-1], whole.tips[-1], rtol=1e-3)


@pytest.mark.parametrize(("solve", "options"), MODELS)
def test_a_prescribed_displacement_finds_the_load_curve(solve, options):
    by_force = solve(replace(FREE_B, load=Load((0.0, -100.0), 20)), **options)
    ways = by_force.tips[:, 1]
    for row in (4, 12, 19):
        path = solve(pressed(FREE_B, ways[row], steps=5), **options)
        assert path.loads[-1, 1] == pytest.approx(by_force.loads[row, 1], rel=1e-7)
        np.testing.assert_array_max_ulp(path.tips[:, 1], ways[row] * path.times, 64)


def test_a_prescribed_displacement_goes_through_limit_points():
    """Frictionless wires of Spring B slide off each other at 130 N; arc-length continuation says how."""
    path = wirefe.solve(pressed(FREE_B, -13.0, steps=130), **CURVED)
    traced = wirefe.trace(FREE_B, points=160, **CURVED)
    assert traced.negative_pivots.max() == 1
    assert (np.diff(-traced.loads[:, 1]) < 0.0).any()  # the load falls beyond the limit point
    rising = np.maximum.accumulate(-traced.tips[:, 1])  # no snap-back in the displacement
    for way in (12.0, 12.5, 12.9):
        row = np.abs(path.tips[:, 1] + way).argmin()
        expected = np.interp(-path.tips[row, 1], rising, traced.loads[:, 1])
        assert path.loads[row, 1] == pytest.approx(expected, rel=2e-3)
    assert path.loads[:, 1].min() < path.loads[100, 1]


@pytest.mark.parametrize(("solve", "options"), MODELS)
def test_a_prescribed_displacement_comes_back(solve, options):
    path = solve(pressed(FREE_B, -8.0, -2.0, steps=4), **options)
    np.testing.assert_allclose(path.tips[:, 1], [-2, -4, -6, -8, -6.5, -5, -3.5, -2], rtol=1e-13)
    assert path.loads[-1, 1] == pytest.approx(path.loads[0, 1], rel=1e-7)


@pytest.mark.parametrize("model", ["equivbeam", "wirefe"])
def test_what_is_prescribed_has_no_gradient_and_is_stiff(model):
    """At rest and away from it: only the top's y differs, its reaction is kept, and a solution leaves it."""
    scene = spring_a()
    if model == "equivbeam":
        data = equivbeam.model.build_model(scene)
        problem, kernels = beam_problem(data, equivbeam.model.load_vector(data, scene)), BEAM_KERNELS
    else:
        problem, kernels = scene_problem(scene, "straight", 8, 4)[0], WIRE_KERNELS
    top, n = problem.top, problem.load.size
    prescribed = np.array([top.state[1], top.dof[1], top.diagonal, 1e6, -2.0])
    free, held = (
        System(*pack(problem.data), what, np.zeros(1), *kernels) for what in (np.zeros(0), prescribed)
    )
    step, state = 0.01 * np.random.default_rng(3).normal(size=n), np.empty_like(problem.start)
    moved(free, problem.start, step, 1.0, state)
    found = []
    for system in (free, held):
        g, H = np.empty(n), np.empty(problem.matrix_size)
        assembled(system, problem.start, 0.0, problem.history, state, g, H)
        found.append((g, H))
    (g, H), (g_held, H_held) = found
    assert held.reaction[0] == g[top.dof[1]] != 0.0
    assert np.flatnonzero(g != g_held).tolist() == [top.dof[1]]
    assert g_held[top.dof[1]] == 0.0
    assert np.flatnonzero(H_held != H).tolist() == [top.diagonal]
    assert H_held[top.diagonal] - H[top.diagonal] == pytest.approx(1e6, rel=1e-6)
    factored(held, H_held)
    out = np.empty(n)
    solution(held, H_held, g_held, -1.0, out)
    assert out[top.dof[1]] == 0.0 != out[top.dof[0]]
    put_prescribed(held, problem.start, 0.25, state)
    assert state[top.state[1]] == problem.start[top.state[1]] - 0.5


def test_reactions_are_compared_where_the_way_is_prescribed():
    beam, wire_path = (solve(pressed(FREE_B, -10.0), **options) for solve, options in MODELS)
    found = compare_paths(beam, wire_path)
    assert found.component_max.keys() == {"uy"}
    apart = np.abs(beam.loads[:, 1] - wire_path.loads[:, 1]).max() / np.abs(wire_path.loads[:, 1]).max()
    assert 1e-3 < found.curve_max == pytest.approx(apart)


def test_one_force_grows_with_time_beyond_time_1_too():
    """Where a traced path may end."""
    found = given_loads(spring_a().load, np.array([-0.1, 0.5, 1.02]))
    np.testing.assert_allclose(found, [[0.9, 0.4], [-4.5, -2.0], [-9.18, -4.08]])


def test_what_takes_one_force_alone_says_so():
    with pytest.raises(InputError, match="load must be one force for trace"):
        wirefe.trace(staged(FREE_B, *TO_FULL))
    path = equivbeam.solve(pressed(FREE_B, -1.0))
    with pytest.raises(InputError, match="sensitivities needs a path under forces"):
        equivbeam.sensitivities(path, ["E"])


def test_sensitivities_hold_in_stages():
    names = ["E", "wire_diameter"]
    whole = equivbeam.solve(replace(BARE_A, load=Load((-4.0, -2.0), 2)))
    halves = equivbeam.solve(staged(BARE_A, (-2.0, -1.0), (-4.0, -2.0), steps=1))
    first, second = (equivbeam.sensitivities(path, names).tips for path in (whole, halves))
    np.testing.assert_allclose(second, first, rtol=1e-6)


@pytest.mark.parametrize(
    ("load", "words"),
    [
        ({}, r"load\.force must be two numbers .* not both zero"),
        ({"stages": ()}, r"load\.force must be two numbers"),
        ({"stages": []}, r"load\.stages must be 1 to 1000 stages, got 0"),
        ({"stages": 3}, r"load\.stages must be a list of forces"),
        ({"stages": [(0.0, 0.0)]}, r"load\.stages\[0\] must differ from what it begins with"),
        ({"stages": [(0.0, -1.0), (0.0, -1.0)]}, r"load\.stages\[1\] must differ .* \(0\.0, -1\.0\)"),
        ({"stages": [(0.0, -1.0), (0.0,)]}, r"load\.stages\[1\] must be two numbers \[Fx, Fy\]"),
        (
            {"stages": [(0.0, -1.0)], "force": (0.0, -2.0)},
            r"load\.force must be left out beside load\.stages",
        ),
        (
            {"stages": [(0.0, -1.0)], "displacement": -2.0},
            r"stages or displacement, not both, got \[\(0\.0, -1\.0\)\] and -2\.0",
        ),
        ({"displacement": 0.0}, r"load\.displacement\[0\] must differ from what it begins with, 0\.0"),
        ({"displacement": []}, r"load\.displacement must be 1 to 1000 stages"),
        ({"displacement": "much"}, r"load\.displacement must be a number"),
        ({"displacement": -1.0, "force": (0.0, -1.0)}, r"load\.force must be left out beside load\.disp"),
    ],
)
def test_bad_histories(load, words):
    with pytest.raises(InputError, match=words):
        Load(**load)


def test_histories_that_the_supports_do_not_allow():
    with pytest.raises(InputError, match=r"supports\.top_held must be without uy"):
        replace(spring_b(), supports=Supports(("uy",)), load=Load(displacement=-1.0))
    with pytest.raises(InputError, match=r"load\.displacement must be above -28\.6, .* got -30\.0"):
        pressed(spring_b(), -30.0)
    with pytest.raises(InputError, match=r"load\.stages must change in a direction that is free, got \(5\.0"):
        staged(spring_b(), (0.0, -1.0), (5.0, -1.0))
