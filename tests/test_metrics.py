"""The metrics on paths small enough to work out by hand."""

import copy
import pickle
from dataclasses import dataclass, replace

import numpy as np
import pytest

import coilspring
from coilspring import EquilibriumNotFound, EquilibriumPath, InputError, Load
from coilspring.curves import compare_paths
from validation.study.metrics import tip_deviation


@dataclass(frozen=True)
class Given:
    """A shape whose states are the tips themselves, and whose circles are moved by the tip's UX, UY."""

    def tips(self, states):
        return states

    def centreline(self, state, phases):
        points = np.zeros((len(phases), 3))
        points[:, 0] = phases
        points[0, :2] += state[:2]
        return points


def path(times, tips):
    return EquilibriumPath(
        scene=coilspring.load_scene("spring-a"),
        model="given",
        options={},
        times=np.array(times),
        states=np.array(tips, dtype=float).reshape(len(times), 3),
        iterations=np.ones(len(times), dtype=int),
        least_gaps=np.full(len(times), np.inf),
        outcome="completed",
        message="given",
        shape=Given(),
    )


REFERENCE = path([0.5, 1.0], [[-2.0, -1.0, 0.1], [-4.0, -10.0, 0.2]])


def test_paths_under_two_loads_or_of_two_springs_are_not_compared():
    scene = REFERENCE.scene
    half = replace(REFERENCE, scene=replace(scene, load=Load((0.0, -1.0), steps=2)))
    with pytest.raises(InputError, match="must have one load, got Load"):
        compare_paths(half, REFERENCE)
    longer = replace(scene.spring, active_coils=scene.spring.active_coils + 1.0)
    with pytest.raises(InputError, match=r"cross the working plane \d+ and \d+ times"):
        compare_paths(replace(REFERENCE, scene=replace(scene, spring=longer)), REFERENCE)
    more_steps = replace(REFERENCE, scene=replace(scene, load=replace(scene.load, steps=7)))
    assert compare_paths(more_steps, REFERENCE).curve_max == 0.0


@pytest.mark.parametrize("name", ["times", "states", "iterations", "least_gaps"])
def test_a_path_has_a_row_for_each_time(name):
    with pytest.raises(ValueError, match=r"states, iterations and least_gaps differ in length: .*1"):
        replace(REFERENCE, **{name: getattr(REFERENCE, name)[:1]})


def test_a_path_is_itself_alone_and_what_it_keeps_is_not_written():
    assert REFERENCE == REFERENCE
    assert len({REFERENCE, copy.deepcopy(REFERENCE)}) == 2
    with pytest.raises(ValueError, match="read-only"):
        REFERENCE.tips[0, 0] = 9.0


def test_a_path_that_ended_comes_with_its_error_to_another_process():
    error = EquilibriumNotFound(replace(REFERENCE, outcome="limit_point"))
    for other in (pickle.loads(pickle.dumps(error)), copy.copy(error), copy.deepcopy(error)):
        assert str(other) == str(error)
        assert other.outcome == "limit_point"
        np.testing.assert_array_equal(other.path.tips, error.path.tips)


def test_a_path_equals_itself():
    found = compare_paths(REFERENCE, REFERENCE)
    assert (found.curve_max, found.curve_rms, found.shape_max, found.shape_rms) == (0.0, 0.0, 0.0, 0.0)
    assert (found.steps, found.last_time) == (2, 1.0)


def test_curve_errors_are_over_the_references_own_peak_of_the_worst_component():
    found = compare_paths(path([0.5, 1.0], [[-2.3, -1.0, 0.1], [-4.4, -9.0, 0.2]]), REFERENCE)
    # UX: 0.3/4 and 0.4/4; UY: 0 and 1/10
    assert found.component_max == pytest.approx({"ux": 0.1, "uy": 0.1, "rotz": 0.0})
    assert found.component_rms == pytest.approx(
        {"ux": np.sqrt((0.075**2 + 0.1**2) / 2), "uy": np.sqrt(0.01 / 2), "rotz": 0.0}
    )
    assert found.curve_max == pytest.approx(0.1)
    assert found.curve_rms == pytest.approx(np.sqrt((0.075**2 + 0.1**2) / 2))


def test_rotation_counts_like_any_component():
    found = compare_paths(path([1.0], [[-4.0, -10.0, 0.25]]), REFERENCE)
    assert found.curve_max == pytest.approx(0.25)


def test_shape_is_the_distance_of_circle_centres_at_the_last_common_step():
    found = compare_paths(path([0.5, 1.0], [[0.0, 0.0, 0.0], [-4.3, -10.4, 0.2]]), REFERENCE)
    circles = len(REFERENCE.circle_centres(-1))
    assert circles == 34  # 29 half coils and two end turns
    # the first circle alone is moved, by (0.3, 0.4)
    assert found.shape_max == pytest.approx(0.5)
    assert found.shape_rms == pytest.approx(0.5 / np.sqrt(circles))


def test_a_shorter_path_is_compared_where_both_are():
    found = compare_paths(path([0.5], [[-2.0, -1.5, 0.1]]), REFERENCE)
    assert (found.steps, found.last_time) == (1, 0.5)
    assert found.curve_max == pytest.approx(0.5 / 10.0)
    assert found.shape_max == pytest.approx(0.5)


def test_paths_on_different_grids_share_their_common_times():
    thirds = path(np.arange(1, 4) / 3, [[0, 0, 0], [0, 0, 0], [-4.0, -10.0, 0.2]])
    sixths = path(np.arange(1, 7) / 6, [[0, 0, 0]] * 5 + [[-4.0, -10.0, 0.2]])
    assert compare_paths(thirds, sixths).steps == 3
    assert compare_paths(sixths, thirds).steps == 3


@pytest.mark.parametrize("rounding", [0.0, 1e-12])
def test_components_the_reference_does_not_move_are_left_out(rounding):
    held = path([1.0], [[rounding, -10.0, -rounding]])
    found = compare_paths(path([1.0], [[1e-3, -10.1, 0.1]]), held)
    assert found.component_max == pytest.approx({"uy": 0.01})
    assert found.curve_max == pytest.approx(0.01)


def test_nothing_in_common_is_not_a_number():
    empty = path([], [])
    for found in (compare_paths(empty, REFERENCE), compare_paths(REFERENCE, empty)):
        assert found.steps == 0
        assert np.isnan([found.curve_max, found.curve_rms, found.shape_max, found.shape_rms]).all()


def test_tips_deviate_in_the_components_that_are_free():
    tips = np.array([[-2.0, 4.0, 1e-3], [-2.02, 5.0, np.nan], [-2.02, np.nan, 0.0]])
    found = tip_deviation(tips, np.array([-2.02, 4.0, 1e-12]))
    assert found == pytest.approx([0.02 / 2.02, 0.25, np.nan], nan_ok=True)
    assert tip_deviation(tips[0], np.zeros(3)) == 0.0
    assert np.isnan(tip_deviation(tips[0], tips[1]))


def test_what_is_not_a_number_in_a_reference_is_not_left_out():
    found = compare_paths(REFERENCE, path([0.5, 1.0], [[np.nan, -1.0, 0.1], [-4.0, -10.0, 0.2]]))
    assert np.isnan(found.component_max.pop("ux"))
    assert found.component_max == {"uy": 0.0, "rotz": 0.0}
    assert np.isnan([found.curve_max, found.curve_rms]).all()
