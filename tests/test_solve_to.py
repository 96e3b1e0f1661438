"""Accuracy on request: the error is what was asked for, and what cannot be reached is refused."""

import json
import math
import re
from contextlib import suppress
from dataclasses import replace
from fractions import Fraction
from itertools import combinations

import numpy as np
import pandas as pd
import pytest

import wirefe
from coilspring import (
    Contact,
    EquilibriumNotFound,
    InputError,
    Load,
    Material,
    Scene,
    Spring,
    Supports,
    load_path,
    scene_text,
    spring_a,
    spring_b,
)
from coilspring.curves import compare_paths
from coilspring.scene.profile import CoilSection
from coilspring.scene.toml import scene_table
from validation.cli import main
from validation.study.partialsolve import partial_path
from validation.sweep import choice, run
from validation.sweep.grid import Varied, points, read_varied
from validation.verification import requested, requestedruns
from validation.verification.requestedpage import prepared, summary
from wirefe import trials
from wirefe.meshes import Levels, Trial, difference, few, thinned
from wirefe.trials import Trials, refusal

SHORT = replace(spring_a(), spring=replace(spring_a().spring, active_coils=4.0, active_height=7.0))


def touching(**contact):
    return replace(SHORT, load=Load((-4.0, -8.0), 10), contact=Contact(**contact))


def differ(monkeypatch, difference):
    """Have paths differ so, wherever they are compared."""
    for module in ("trials", "adaptive"):
        monkeypatch.setattr(f"wirefe.{module}.difference", difference)


@pytest.mark.parametrize("asked", [1e-2, 1e-3, 1e-4])
def test_stations_and_mesh_are_as_fine_as_asked_for(asked):
    path = wirefe.solve_to(touching(), asked)
    finest = wirefe.solve(touching(), element="curved", elements_per_turn=64, pairs_per_turn=500)
    assert path.active_contacts.any()
    assert difference(path, finest) <= min(asked, 3.0 * path.estimated_error)
    assert path.estimated_error <= asked == path.accuracy
    assert 4.0 <= path.options["pairs_per_turn"] / path.options["elements_per_turn"] <= 16.0


def trials_of(scene, *meshes):
    """Trials with paths on levels with stations."""
    trials = Trials(Levels.of(scene, None), 1e-3, 10)
    for level, stations in meshes:
        path = partial_path(wirefe.solve, scene, **trials.levels.options(level, stations))
        trials.take(*trials.found, Trial(level, stations, path))
    return trials


def test_finer_is_asked_finer_is_solved():
    """In stations, which leave the larger part of the error here, and in elements where there are none."""
    wanted = (1e-2, 1e-3, 3e-5, 1e-5)
    found = [wirefe.solve_to(touching(), asked).options for asked in wanted]
    stations, levels = ([mesh[name] for mesh in found] for name in ("pairs_per_turn", "elements_per_turn"))
    assert stations == sorted(set(stations))
    assert levels == sorted(levels)
    assert levels[-1] > levels[0]
    leaning = replace(touching(geometry="spheres"), load=Load((-30.0, -8.0), 10))
    levels = [wirefe.solve_to(leaning, asked).options["elements_per_turn"] for asked in (1e-3, 1e-4, 1e-5)]
    assert levels[0] < levels[1] < levels[2]


def test_without_contact_two_coarse_meshes_are_enough():
    scene = replace(SHORT, load=Load((-0.5, -0.5), 50), contact=Contact(enabled=False))
    lines = []
    path = wirefe.solve_to(scene, 1e-4, progress=lines.append)
    assert path.options["elements_per_turn"] == 4
    assert [line.split(";")[0] for line in lines] == [
        "4 elements per turn, 50 steps",
        "8 elements per turn, 5 steps",
    ]


@pytest.mark.parametrize(("asked", "steps"), [(2e-3, 5), (1e-3, 20)])
def test_sticking_pairs_are_compared_in_more_steps_where_fewer_may_agree_by_chance(asked, steps):
    """They touched alike in 10 and 5 steps, and elsewhere in 20: 6e-4 off where 1e-4 was asked for."""
    lines = []
    with suppress(InputError):
        wirefe.solve_to(touching(geometry="spheres", sliding="none"), asked, progress=lines.append)
    assert lines[1].startswith(f"8 elements per turn, {steps} steps")


def test_without_contact_nothing_is_asked_of_coils(monkeypatch):
    """Where their points are was evaluated for each state, and again for each mesh."""
    monkeypatch.setattr("wirefe.results.shape.contact_centres", None)
    monkeypatch.setattr(Trial, "touching", property(lambda trial: pytest.fail("it was asked")))
    path = wirefe.solve_to(replace(touching(), contact=Contact(enabled=False)), 1e-3)
    assert path.gaps.shape == path.contact_forces.shape == (10, 0)


@pytest.mark.parametrize(("enabled", "steps"), [(True, 50), (False, 5)], ids=["touching", "clear"])
def test_the_coarsest_mesh_is_the_answer_where_a_finer_one_agrees(enabled, steps):
    """Where coils touch in all steps: just after one has closed errors are several times as large."""
    scene = touching(geometry="spheres", enabled=enabled).overridden(steps=50)
    path = wirefe.solve_to(scene, 1e-2)
    finer = wirefe.solve(scene, steps=steps, element="curved", elements_per_turn=8)
    assert path.options["elements_per_turn"] == 4
    assert len(path.times) == 50
    assert path.active_contacts.any() == enabled
    assert path.estimated_error == 2.0 * difference(path, finer)


@pytest.mark.parametrize(("asked", "paths"), [(2e-3, 2), (1e-3, 3)])
def test_two_meshes_with_stations_may_agree_by_chance(monkeypatch, asked, paths):
    """A spring whose coils touch in its last step alone was off by 6.1e-4 where 1e-4 was asked for."""
    lines = []
    differ(monkeypatch, lambda coarse, fine: 1e-9)
    wirefe.solve_to(touching(), asked, progress=lines.append)
    assert len(lines) == paths


def test_the_answer_has_all_rows_where_the_path_at_few_points_is_accurate_enough(monkeypatch):
    differ(monkeypatch, lambda coarse, fine: 5.5e-3)  # twice that is too much
    path = wirefe.solve_to(touching(geometry="spheres").overridden(steps=50), 1e-2)
    assert path.options["elements_per_turn"] == 8
    assert len(path.times) == 50


def test_coils_that_come_nowhere_near_take_the_fewest_stations():
    open_ends = replace(SHORT.spring, end_turns=0.0)  # the others touch where they begin
    scene = replace(SHORT, spring=open_ends, load=Load((-0.5, -0.5), 10), contact=Contact())
    assert wirefe.solve_to(scene, 1e-4).options["pairs_per_turn"] == 16


def test_spheres_are_taken_as_given():
    path = wirefe.solve_to(touching(geometry="spheres"), 1e-4, pairs_per_turn=2)
    assert path.options["pairs_per_turn"] == 2
    mesh = {"element": "curved", "elements_per_turn": 64, "pairs_per_turn": 2}
    assert difference(path, wirefe.solve(touching(geometry="spheres"), **mesh)) <= 1e-4


def test_friction_takes_finer_substeps_and_gives_the_scenes_rows():
    scene = touching(sliding="coulomb", friction=0.3)
    scene = replace(scene, load=Load(stages=((-4.0, -8.0), (0.0, 0.0)), steps=3))
    path = wirefe.solve_to(scene, 1e-2)
    assert path.times.tolist() == [row / 6 for row in range(1, 7)]
    assert path.scene.load.steps == 3
    assert path.total_iterations >= path.iterations.sum() > 0
    finest = wirefe.solve(scene, steps=48, element="curved", elements_per_turn=32, pairs_per_turn=192)
    assert difference(path, finest) <= 1e-2


def test_one_path_on_a_finer_mesh_in_fewer_steps_is_enough_where_friction_does_little():
    lines = []
    path = wirefe.solve_to(
        touching(geometry="spheres", sliding="coulomb", friction=0.1), 1e-2, progress=lines.append
    )
    assert [line[:31] for line in lines] == [
        "4 elements per turn, 10 steps",
        "8 elements per turn, 5 steps; 0",
    ]
    assert path.options["elements_per_turn"] == 4


@pytest.mark.parametrize(
    ("sliding", "asked", "paths"), [("coulomb", 2e-3, 2), ("none", 1e-4, 2), ("coulomb", 1e-4, 4)]
)
def test_two_paths_in_different_substeps_with_friction_may_agree_by_chance(
    monkeypatch, sliding, asked, paths
):
    """Of a guided spring those in 5 and 10 steps differed by 5e-6, both were off by 1.6e-4."""
    lines = []
    differ(monkeypatch, lambda coarse, fine: 1e-9)
    friction = 0.1 if sliding == "coulomb" else None
    scene = touching(geometry="spheres", sliding=sliding, friction=friction)
    path = wirefe.solve_to(scene, asked, progress=lines.append)
    assert len(lines) == paths
    assert len(path.times) == 10


def test_the_third_path_may_tell_that_two_agreed_by_chance(monkeypatch):
    apart = {20: 1e-4}
    differ(monkeypatch, lambda coarse, fine: apart.get(fine.scene.load.steps, 1e-7))
    lines = []
    path = wirefe.solve_to(
        touching(geometry="spheres", sliding="coulomb", friction=0.1), 1e-4, progress=lines.append
    )
    assert [line.split(";")[0].split(", ")[1] for line in lines[2:6]] == [
        "10 steps",
        "20 steps",
        "40 steps",
        "80 steps",
    ]
    assert path.estimated_error <= 1e-4


def test_rows_of_a_finer_path():
    scene = touching()
    fine = wirefe.solve(scene, steps=40, element="curved", elements_per_turn=4)
    found = thinned(fine, scene, 4)
    coarse = wirefe.solve(scene, element="curved", elements_per_turn=4)
    assert found.times.tolist() == coarse.times.tolist()
    np.testing.assert_allclose(found.tips, coarse.tips, rtol=1e-7)
    assert found.iterations.tolist() == fine.iterations.reshape(-1, 4).sum(axis=1).tolist()
    assert found.histories.shape[0] == len(found.least_gaps) == len(found.times)


def test_what_friction_leaves_open_is_refused_with_what_can_be_reached(monkeypatch):
    differ(monkeypatch, lambda coarse, fine: 3e-4)
    with pytest.raises(
        InputError, match=r"must be at least 0\.0063 for this scene, got 0\.001: by the substeps of fric"
    ):
        wirefe.solve_to(touching(sliding="none"), 1e-3)


def test_a_spring_that_leans_on_its_plates_is_solved_as_accurately_as_asked():
    """Bearing at nodes of straight elements, meshes of 80 and 320 a turn differed by 6 %."""
    spring = Spring(0.834, (4.495, 6.202), 5.0, 6.571, ends="open", start_phase=0.548, hand="left")
    seated = Supports(("rotz",), seat="plate")
    scene = Scene("seated", spring, Load(displacement=(-1.438,), steps=5), supports=seated)
    scene = replace(scene, contact=Contact(stiffness=8e4), material=Material(nu=0.0))
    exact = wirefe.solve(scene, element="curved", elements_per_turn=96, pairs_per_turn=384)
    for accuracy in (1e-2, 1e-3):
        found = wirefe.solve_to(scene, accuracy)
        assert difference(found, exact) < found.estimated_error <= accuracy


def test_what_symmetry_leaves_at_zero_is_not_asked_for():
    """The wire's middle is on the X axis: UX is zero but for the mesh, 3e-7 mm of 5, and was refused."""
    spring, load = Spring(1.5, 10.0, active_coils=4.0, active_height=12.0), Load((0.0, -60.0), 10)
    scene = Scene("guided", spring, load, supports=Supports(("rotz",), seat="plate"), contact=Contact())
    path = wirefe.solve_to(scene, 1e-3)
    assert path.estimated_error <= 1e-3
    finer = wirefe.solve(scene, element="curved", elements_per_turn=64, pairs_per_turn=384)
    found = compare_paths(path, finer)
    assert list(found.component_max) == ["uy"]
    assert found.curve_max == difference(path, finer) < path.estimated_error
    assert 0.0 < np.abs(finer.tips[:, 0]).max() < 1e-5 * np.abs(finer.tips[:, 1]).max()


@pytest.mark.parametrize(("finest", "words"), [(8, ["at least"]), (16, ["at least about"])])
def test_what_no_mesh_reaches_is_refused_with_what_can_be_reached(finest, words, monkeypatch):
    """Beyond the finest mesh with what was found there, before it with what is predicted."""
    monkeypatch.setattr("wirefe.meshes.FINEST", finest)
    asked = 1e-5
    for said in words:
        with pytest.raises(InputError, match=rf"{said} \d.* got {asked:g}: with {finest} elem") as refused:
            wirefe.solve_to(touching(), asked)
        asked = float(re.search(r"(\S+) for this scene", str(refused.value)).group(1))
    assert wirefe.solve_to(touching(), asked).estimated_error <= asked


@pytest.mark.parametrize(("geometry", "order"), [("wires", 1), ("spheres", 2)])
def test_what_the_finest_mesh_is_predicted_to_reach(geometry, order):
    trials = trials_of(touching(geometry=geometry), (8, 98), (16, 194))
    assert trials.reached == pytest.approx(trials.estimate / 8.0**order)


def test_one_comparison_is_no_answer_where_wires_rub():
    lines = []
    scene = touching(sliding="coulomb", friction=0.1)
    wirefe.solve_to(scene, 1e-2, progress=lines.append)
    assert [line[:28] for line in lines] == ["4 elements per turn, 10 step", "6 elements per turn, 5 steps"]
    lines.clear()
    wirefe.solve_to(scene, 4e-3, progress=lines.append)
    assert len(lines) > 2


@pytest.mark.parametrize(("low", "high", "ratio"), [(8, 12, 2.4), (4, 8, 1.0), (4, 16, 0.2)])
def test_the_error_falls_with_the_square_of_the_level(low, high, ratio):
    """As two paths tell it; what they tell is taken three times."""
    trials = trials_of(touching(geometry="spheres"), (low, 16), (high, 16))
    assert trials.estimate == pytest.approx(ratio * difference(*(trial.path for trial in trials.found)))


def test_a_mesh_is_as_fine_as_its_elements_or_its_stations():
    trials = trials_of(touching(), (4, 16), (8, 34), (8, 98))
    fine = [2.0, 4.0, 8.0]  # stations alone would make them 1.3 and 2.8: half of their level at least
    assert [trials.resolution(trial) for trial in trials.found] == fine
    a, b, c = (trial.path for trial in trials.found)
    shares = [1.0 / ((8.0 / each) ** 2 - 1.0) for each in fine[:2]]
    told = max(0.5 * shares[0] * difference(a, c), shares[1] * difference(b, c))
    assert trials.estimate == pytest.approx(10.0 * told)
    spheres = trials_of(touching(geometry="spheres"), (4, 16), (8, 16))
    assert [spheres.resolution(trial) for trial in spheres.found] == [4, 8]


def constant(trials, differences, monkeypatch):
    """What trials tell when their last path differs so much from those before."""
    values = iter(differences)
    differ(monkeypatch, lambda coarse, fine: next(values))
    trials.take(*trials.found)
    return trials.constant


def test_two_paths_that_agree_by_chance_are_not_believed(monkeypatch):
    """Half of what a path before has told is left; one that is farther off tells more."""
    trials = trials_of(touching(geometry="spheres"), (4, 16), (8, 16), (16, 16))
    first, second = 1 / 16 - 1 / 256, 1 / 64 - 1 / 256
    assert constant(trials, (1e-3, 0.0), monkeypatch) == pytest.approx(0.5e-3 / first)
    assert constant(trials, (1e-3, 7e-3), monkeypatch) == pytest.approx(7e-3 / second)


def test_two_that_tell_the_same_are_believed_more(monkeypatch):
    assert trials_of(touching(), (4, 16), (8, 98), (12, 146)).safety == 10.0  # of stations by chance
    trials = trials_of(touching(geometry="spheres"), (8, 16), (12, 16), (16, 16))
    first, second = 1 / 64 - 1 / 256, 1 / 144 - 1 / 256
    for other, safety in ((1.4, 2.0), (0.7, 2.0), (1.6, 3.0), (0.6, 3.0)):
        constant(trials, (first, other * second), monkeypatch)
        assert trials.safety == safety


def test_the_time_at_which_wires_overlap_is_believed_less():
    """It is looked for between points of the wires: errors of it fall unevenly."""
    trials = trials_of(touching(geometry="spheres"), (8, 16), (16, 16))
    before = trials.safety
    last = trials.found[-1]
    trials.found[-1] = replace(last, path=replace(last.path, outcome="interpenetration"))
    assert (before, trials.safety) == (3.0, 10.0)


@pytest.mark.parametrize(("geometry", "needed"), [("wires", 3), ("spheres", 2)])
def test_how_many_meshes_share_a_critical_point_or_a_change_of_ends(geometry, needed, monkeypatch):
    trials = trials_of(touching(geometry=geometry), (4, 16), (8, 98), (12, 146), (16, 194))
    assert math.isfinite(constant(trials, (math.inf, 1e-3, 1e-3), monkeypatch))
    assert constant(trials, (math.inf, math.inf, 1e-3), monkeypatch) == math.inf
    assert constant(trials, (1e-3, 1e-3, math.inf), monkeypatch) == math.inf
    *before, last = trials.found
    ended = replace(last, path=replace(last.path, critical_time=0.9))
    trials.found = [*before, ended]
    for known in (1, 2, 3):
        told = constant(trials, (*[math.inf] * (3 - known), *[1e-3] * known), monkeypatch)
        assert math.isfinite(told) == (known >= needed)


def test_what_no_level_before_has_seen_touch_is_no_estimate():
    assert trials_of(touching(), (4, 16), (8, 16)).estimate == np.inf


def test_meshes_that_end_otherwise_are_no_answer(monkeypatch):
    monkeypatch.setattr("wirefe.meshes.FINEST", 8)
    differ(monkeypatch, lambda coarse, fine: np.inf)
    with pytest.raises(InputError, match="with 8 elements per turn too few meshes tell"):
        wirefe.solve_to(touching(), 1e-2)


def test_a_path_that_ends_early_has_all_rows():
    scene = replace(spring_b(), contact=Contact(geometry="spheres"), load=Load((0.0, -200.0), 10))
    trials = Trials(Levels.of(scene, None), 1e-2, 10)
    trials.add(4, few(10), 16)
    path = trials.found[0].path
    assert path.outcome == "limit_point"
    assert path.scene.load.steps == 10


def test_an_early_end_is_found_on_two_meshes_and_counts():
    scene = replace(spring_b(), contact=Contact(geometry="spheres"), load=Load((0.0, -200.0), 10))
    with pytest.raises(EquilibriumNotFound) as ended:
        wirefe.solve_to(scene, 1e-3)
    path = ended.value.path
    assert path.outcome == "limit_point"
    finest = partial_path(wirefe.solve, scene, element="curved", elements_per_turn=32)
    assert abs(path.critical_time / finest.critical_time - 1.0) <= path.estimated_error <= 1e-3
    assert difference(replace(path, outcome="bifurcation"), path) == np.inf


def test_meshes_end_where_the_spring_does():
    scene = replace(SHORT, spring=replace(SHORT.spring, active_coils=4.3))
    assert Levels.of(scene, None).at_least(4) == 20  # a tenth of a coil, and 4 spheres a turn
    assert Levels.of(replace(scene, contact=Contact()), None).at_least(4) == 10
    longer = replace(scene.spring, end_turns=1.25)
    plates = replace(scene, spring=longer, supports=replace(scene.supports, seat="plate"))
    assert Levels.of(replace(plates, contact=Contact()), None).at_least(4) == 20


@pytest.mark.parametrize(("seat", "multiple"), [("rigid", 1), ("plate", 3)])
def test_end_turns_take_a_mesh_where_they_are_elastic(seat, multiple):
    """Rigid ones of 1.37 turns took 100 elements a turn."""
    spring = replace(SHORT.spring, end_turns=4 / 3)
    supports, load = replace(SHORT.supports, seat=seat), Load((0.0, -8.0), 5)
    scene = replace(SHORT, spring=spring, contact=Contact(), supports=supports, load=load)
    assert Levels.of(scene, None).multiple == multiple


def test_what_takes_too_many_elements_is_named():
    """Coils of thirds take three, end turns of 0.777 a thousand: the coils were blamed."""
    spring = Spring(1.5, 10.0, 16 / 3, 20.0, end_turns=0.777)
    load, seat = Load((0.0, -120.0), 3), Supports(("ux", "rotz"), seat="plate")
    scene = Scene("ends", spring, load, supports=seat, contact=Contact())
    with pytest.raises(InputError, match=r"spring\.end_turns must fit .*, got 0\.777: they take 3000"):
        wirefe.solve_to(scene, 1e-2)


def test_too_few_meshes_are_not_said_to_do_better_than_asked():
    """Meshes of 1000 and 2000 elements a turn alone: "at least 3.7e-06, got 0.001" was the refusal."""
    with pytest.raises(InputError, match=r"cannot be met .* got 0\.001: .* too few meshes") as refused:
        raise refusal(1e-3, 3.7e-6, "with 2000 elements per turn")
    assert math.isinf(refused.value.reached)


SECTIONS = (CoilSection(2.3333, (2.0, 2.0), (10.0, 10.0)), CoilSection(2.5, (3.0, 3.0), (10.0, 10.0)))


@pytest.mark.parametrize(
    ("spring", "seat", "what", "turns", "fraction"),
    [
        (replace(SHORT.spring, active_coils=4.3333), "rigid", "active_coils", "4.3333", "13/3"),
        (Spring.of_sections(1.5, SECTIONS), "rigid", "sections[0]: its end", "2.3333", "7/3"),
        (replace(SHORT.spring, end_turns=1.3333), "plate", "end_turns", "1.3333", "4/3"),
    ],
)
def test_turns_that_fit_no_mesh_are_refused_with_those_that_do(
    spring, seat, what, turns, fraction, tmp_path, capsys
):
    """An option was named that was not given, and a rule that does not hold: a multiple of 1/4."""
    supports, load, file = replace(SHORT.supports, seat=seat), Load((0.0, -8.0), 5), tmp_path / "own.toml"
    text = scene_text(replace(SHORT, spring=spring, load=load, supports=supports))
    file.write_text(text, encoding="utf-8")
    call = ["solve", str(file), "--accuracy", "1e-2", "--out", str(tmp_path)]
    assert main(call) == 2
    nearest = f"{float(Fraction(fraction)):.12g}"
    assert capsys.readouterr().err == (
        f"coilcheck: {file}: spring.{what} must be a multiple of 1/n turns, n an integer in [1, 1000], "
        f"for accuracy, got {turns}; the nearest is {fraction}, {nearest}\n"
    )
    file.write_text(text.replace(turns, nearest), encoding="utf-8")
    assert main(call) == 0  # it can be copied from there


def test_stations_grow_where_elements_need_not():
    """A spring of 4.005 coils takes 200 elements a turn at least."""
    scene = touching()
    scene = replace(scene, spring=replace(SHORT.spring, active_coils=4.005))
    levels = Levels.of(scene, None)
    meshes = [levels.options(level) for level in (4, 8, 12)]
    assert [mesh["elements_per_turn"] for mesh in meshes] == [200, 200, 200]
    assert [mesh["pairs_per_turn"] for mesh in meshes] == [48, 96, 144]
    assert levels.finest == 4 * 200  # without stations a few meshes have to differ
    path = wirefe.solve_to(scene, 1e-3)
    assert path.options["pairs_per_turn"] < 200


def test_elements_too_many_for_a_mesh_are_refused():
    scene = touching(geometry="spheres")
    with pytest.raises(InputError, match=r"active_coils must fit a mesh of 2000 elements .*: they take 3000"):
        wirefe.solve_to(
            replace(scene, spring=replace(SHORT.spring, active_coils=4.001)), 1e-3, pairs_per_turn=3
        )


def test_coils_that_touch_where_a_path_of_one_step_ends_count():
    scene = replace(spring_a(), contact=Contact(), load=Load((0.0, -60.0), 1))
    with pytest.raises(EquilibriumNotFound) as ended:
        wirefe.solve_to(scene, 1e-2)
    path = ended.value.path
    assert len(path.times) == 0
    assert path.options["pairs_per_turn"] > 16


def test_coils_that_touch_on_a_finer_mesh_alone_begin_again(monkeypatch):
    monkeypatch.setattr(Trials, "touching", property(lambda trials: trials.found[-1:] == [] or trials.seen()))
    monkeypatch.setattr(Trials, "seen", lambda trials: trials.found[-1].level >= 12, raising=False)
    trials = Trials(Levels.of(touching(), None), 1e-3, 10)
    for level in (4, 8, 12, 16):
        trials.add(level, 1)
    assert [(trial.level, trial.stations) for trial in trials.found] == [(12, 144), (16, 193)]


def test_coarse_paths_have_few_rows_of_the_fine_ones():
    assert [few(steps) for steps in (1, 5, 7, 10, 12, 50, 100)] == [1, 5, 7, 5, 6, 5, 5]


def test_stations_of_two_levels_stand_elsewhere():
    trials = Trials(Levels.of(touching(), None), 1e-3, 10)
    for level in (4, 6, 8, 12):
        trials.add(level, 1)
    stations = [trial.path.options["pairs_per_turn"] for trial in trials.found]
    assert stations == [48, 73, 97, 145]
    assert {math.gcd(*pair) for pair in combinations(stations, 2)} == {1}


def test_a_corner_pressed_by_the_same_station_of_two_paths_tells_no_error():
    """Where its sections meet the wire has a corner, pressed on a hundredth of a turn: 16 and 62 stations,
    both with one there, gave forces alike, and errors of 2 and 1.6 % that were estimated at 0.8 %."""
    sections = [
        CoilSection(0.5, (pitch, pitch), diameters)
        for pitch, diameters in ((3.614, (6.64, 6.64)), (1.757, (6.64, 6.47)), (1.781, (6.47, 6.53)))
    ]
    spring = Spring.of_sections(1.4808, sections, end_turns=1.25, ends="open", wire_rigidity="solid")
    load, contact = Load((0.0, -94.0), 1), Contact(stiffness=277e3)
    scene = Scene("corner", spring, load, supports=Supports(("ux",)), contact=contact)
    shared = trials_of(scene, (4, 16), (6, 62))
    assert [trial.corner for trial in shared.found] == [Fraction(1, 2)] * 2
    assert shared.estimate == math.inf
    assert trials_of(scene, (4, 16), (6, 63)).estimate < math.inf
    path = wirefe.solve_to(scene, 1e-2)
    exact = wirefe.solve(scene, element="curved", elements_per_turn=48, pairs_per_turn=1538)
    assert difference(path, exact) <= path.estimated_error <= 1e-2


def test_progress_says_what_is_solved_and_the_estimate_so_far():
    lines = []
    path = wirefe.solve_to(touching(), 3e-5, progress=lines.append)
    assert lines[0] == f"4 elements per turn, {path.scene.load.steps} steps"
    assert lines[1].startswith("8 elements per turn,")
    assert lines[1].endswith(" s CPU")  # one path tells no error
    assert "s CPU, estimated error " in lines[2]


def test_the_estimate_is_kept_with_the_path(tmp_path):
    path = wirefe.solve_to(touching(geometry="spheres"), 1e-2)
    path.save(tmp_path / "path.npz")
    assert load_path(tmp_path / "path.npz").estimated_error == path.estimated_error


def test_command(tmp_path, capsys):
    assert main(["solve", "spring-a", "--accuracy", "1e-3", "--steps", "5", "--out", str(tmp_path)]) == 0
    found = json.loads((tmp_path / "summary.json").read_text())
    assert found["accuracy"] == 1e-3
    assert 0.0 < found["estimated_error"] <= 1e-3
    said = capsys.readouterr().out
    assert "4 curved elements per turn, 4 spheres per turn; estimated error" in said
    beam = ["--law", "helix", "--tangent", "exact"]  # whose law no accuracy chooses here
    call = ["compare", "spring-a", "--accuracy", "1e-3", "--steps", "5", *beam, "--out", str(tmp_path)]
    assert main(call) == 0
    assert json.loads((tmp_path / "equivbeam/summary.json").read_text())["options"]["law"] == "helix"
    assert json.loads((tmp_path / "compare.json").read_text())["accuracy"] == 1e-3
    assert json.loads((tmp_path / "wirefe/summary.json").read_text())["options"]["element"] == "curved"


@pytest.mark.parametrize(
    ("line", "said"),
    [
        ("solve spring-a --accuracy 1e-6", "--accuracy must be a finite number in [1e-05, 0.01], got 1e-06"),
        ("solve spring-a --accuracy few", "--accuracy must be a number in [1e-05, 0.01], got 'few'"),
        ("solve spring-a --accuracy 1e-3 --model wirefe", "--model"),
        ("solve spring-a --accuracy 1e-3 --law helix", "--law cannot stand beside --accuracy, which chooses"),
        ("solve spring-a --accuracy 1e-3 --element curved", "leave out --element; or leave out --accuracy"),
        (
            "compare spring-a --accuracy 1e-3 --elements-per-turn 8",
            "--elements-per-turn cannot stand beside --accuracy, which chooses the mesh: leave out",
        ),
        ("solve spring-a --accuracy 1e-3 --tangent exact", "--tangent belongs to --model equivbeam"),
        (
            "solve spring-a --accuracy 1e-3 --geometry wires --pairs-per-turn 8",
            "--pairs-per-turn goes with accuracy for",
        ),
        ("sweep spring-a --vary load.steps=1,2 --accuracy 1 ", "--accuracy must be a finite number"),
        ("sweep spring-a --vary load.steps=1,2 --accuracy 1e-2 --sliding scene", "--sliding cannot stand"),
    ],
)
def test_what_is_refused(line, said, capsys, tmp_path):
    assert main([*line.split(), "--out", str(tmp_path / "out")]) == 2
    error = capsys.readouterr().err
    assert said in error
    assert error.count("\n") == 1
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize(("asked", "model"), [(1e-2, "equivbeam"), (1e-4, "wirefe")])
def test_a_sweep_takes_the_cheapest_that_a_sample_supports(asked, model, tmp_path):
    table = scene_table(spring_a().overridden(steps=5))
    varied = read_varied(["load.force.1=-2:-4:3"], table)
    grid = list(points(table, varied))
    found = choice.choose(grid, varied, asked, lambda text: None)
    assert "on 3 scenes of the grid" in found.line
    assert found.candidate(grid[0].scene).model == model
    assert choice.MARGIN * found.error <= asked
    for point in grid:  # also those not in the sample
        fine = wirefe.solve(point.scene, element="curved", elements_per_turn=16)
        assert difference(found.candidate(point.scene)(point.scene), fine) <= asked
    table = scene_table(spring_a())
    rows = run.sweep(tmp_path, table, varied, list(points(table, varied)), found.candidate, workers=0)
    assert [row["outcome"] for row in rows] == ["completed"] * 3


def chosen_of(asked, last, monkeypatch):
    """What is chosen for a grid whose references have 16 elements a turn at most, and what is solved."""
    monkeypatch.setattr("wirefe.meshes.FINEST", 16)
    table = scene_table(touching())
    varied = read_varied([f"load.force.1=-6:{last}:2"], table)
    solved, solve = [], trials.solve

    def counted(scene, **options):
        solved.append((scene.load.force, *options.items()))
        return solve(scene, **options)

    monkeypatch.setattr(trials, "solve", counted)
    try:
        return choice.choose(list(points(table, varied)), varied, asked, lambda text: None), solved
    except InputError as refused:
        return str(refused), solved


@pytest.mark.parametrize(("asked", "last", "half_is_reached"), [(1.7e-4, -8.0, True), (3.5e-4, -8.5, False)])
def test_a_reference_is_as_exact_as_can_be_reached(asked, last, half_is_reached, monkeypatch):
    """A quarter of the accuracy is out of reach; on the way there a half was met, though not by itself."""
    found, solved = chosen_of(asked, last, monkeypatch)
    assert choice.MARGIN * found.error <= asked
    assert len(solved) == len(set(solved)) > 5
    scene = replace(touching(), load=Load((-4.0, last), 10))
    with pytest.raises(InputError, match="accuracy must be at least"):
        wirefe.solve_to(scene, asked / 4.0)
    if half_is_reached:
        assert wirefe.solve_to(scene, asked / 2.0).estimated_error < found.error
    else:
        with pytest.raises(InputError, match="accuracy must be at least"):
            wirefe.solve_to(scene, asked / 2.0)


def test_a_scene_without_a_mesh_leaves_the_others_of_its_grid(tmp_path, capsys):
    """It stopped the sweep."""
    vary = ["spring-a", "--vary", "spring.active_coils=14,5.3333,14.5", "--steps", "2", "--workers", "0"]
    assert main(["sweep", *vary, "--accuracy", "1e-2", "--out", str(tmp_path)]) == 3
    found = pd.read_csv(tmp_path / run.FILE)
    assert found.outcome.tolist() == ["completed", "refused", "completed"]
    assert found.message[1].startswith("spring.active_coils must be a multiple of 1/n")
    assert "on 2 scenes of the grid" in capsys.readouterr().out


def test_where_there_is_no_reference_the_scene_is_said_and_what_was_asked_for(monkeypatch):
    found, solved = chosen_of(1e-4, -8.5, monkeypatch)
    least, error = re.fullmatch(
        r"accuracy must be at least (\S+) on this grid, got 0\.0001: for the scene with load\.force\.1 = "
        r"-8\.5 the error of the reference, solved by the wire model, is (\S+) or more \(with 16 elements "
        r"per turn\); the accuracy must be at least 2 times that error",
        found,
    ).groups()
    assert float(least) == pytest.approx(2.0 * float(error), rel=0.1)
    assert len(solved) == len(set(solved))


def test_sample_of_a_grid():
    table = scene_table(spring_a())
    varied = read_varied(["load.force.0=1:2:6", "load.force.1=-1:-2:6", "contact.stiffness=1e3,1e4"], table)
    grid = list(points(table, varied))
    found = choice.sample(grid, varied)
    corners = {(x, y) for x in (1.0, 2.0) for y in (-1.0, -2.0)}
    assert corners <= {point.scene.load.force for point in found}
    assert 8 <= len(found) <= 12
    assert found == choice.sample(grid, varied)


def test_a_sample_has_the_scenes_that_a_grid_has():
    """Corners and random places may all be without one."""
    table, varied = scene_table(spring_a()), [Varied("contact.exponent", (*np.arange(6.0, 60.0), 2.0, 90.0))]
    (point,) = choice.sample(list(points(table, varied)), varied)
    assert point.scene.contact.exponent == 2.0


def test_small_study(tmp_path, monkeypatch):
    monkeypatch.setattr(requestedruns, "COILS", 3.5)
    found = list(requestedruns.springs(1))
    monkeypatch.setattr(requested, "springs", lambda each, seed: [found[0], found[4]])
    table = requested.study(tmp_path, 1)
    assert len(table) == 2 * 3
    assert (table.seed == requestedruns.SEED).all()
    assert (table.true <= table.asked).all()
    assert (table.outcome != requestedruns.REFUSED).all()
    again = requested.study(tmp_path, 1)
    pd.testing.assert_frame_equal(table, again)  # nothing is solved again
    figures = summary(prepared(table), "kind")
    assert figures[figures.kind == "all"].failures.tolist() == [0, 0, 0]
    assert figures[figures.kind == "all"].bound.iloc[0] == pytest.approx(1.0 - 0.05 ** (1 / 2))


@pytest.mark.parametrize("seat", ["rigid", "plate"])
def test_no_two_paths_have_the_same_elements(seat):
    """Coils of which 1/16 is a fraction: meshes fit at multiples of 16 elements. Levels between two of these
    gave the same one twice: on plates the estimate was of the stations alone, less than half of the error."""
    load = Load((0.0, -40.0) if seat == "plate" else (3.0, -80.0), 10)
    spring = Spring(2.0, 18.0, active_coils=4.3125, active_height=20.0)
    scene = Scene("sixteenths", spring, load, supports=Supports(("ux", "rotz"), seat=seat))
    lines = []
    path = wirefe.solve_to(scene, 1e-3, progress=lines.append)
    meshes = [int(line.split()[0]) for line in lines]
    assert len(meshes) > 1
    assert meshes == sorted(set(meshes))
    finer = wirefe.solve(
        scene,
        element=path.options["element"],
        elements_per_turn=3 * path.options["elements_per_turn"],
        pairs_per_turn=3 * path.options["pairs_per_turn"],
    )
    assert difference(path, finer) < path.estimated_error < 1e-3
