"""What messages say of rows that are none of a spring, of springs that buckled, and of what no row shows."""

import re
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

import equivbeam
import wirefe
from coilspring import Contact, Factors, Load, Scene, Spring, Supports, spring_b
from coilspring.curves import compare_paths
from validation.campaign.scenes import case_id, make_case
from validation.campaign.verdict import reached
from validation.cli.terminal import deviation
from validation.study.partialsolve import partial_path

SLENDER = Spring(wire_diameter=1.0, mean_diameter=8.0, active_coils=24.0, active_height=96.0)
BUCKLED = "as far as at the initial rate: the spring has buckled"
WIRE = {"element": "curved", "elements_per_turn": 8}


def slender(load):
    return Scene("slender", SLENDER, load, supports=Supports(top_held=("ux",)))


@pytest.mark.parametrize(
    ("load", "times"),
    [
        (Load((0.0, -3.3), 4), 5.1),
        (Load(displacement=(-20.8,), steps=4), 5.0),
        (Load((0.0, -3.0), 4), 0.0),
        (Load(stages=((0.0, -3.3), (0.0, 30.0)), steps=8), 5.1),
        (Load(displacement=(-20.8, 25.0), steps=8), 5.0),
    ],
    ids=["force", "displacement", "below", "and drawn out by a force", "and drawn out"],
)
def test_a_wire_that_leans_and_goes_on_is_said_to_buckle(load, times):
    """Its coils make the bifurcation of the column imperfect: there is no critical point."""
    path = partial_path(wirefe.solve, slender(load), **WIRE)
    assert path.outcome == "completed"
    assert (f" the top has moved {times:.2g} times {BUCKLED}" in path.message) == bool(times)
    assert (BUCKLED in path.message) == bool(times)


def test_what_happens_behind_the_last_row_is_said():
    """Row by row the spring seems to shorten by 3.8 mm under 3 N; it ends at ten times that way."""
    path = partial_path(wirefe.solve, slender(Load((0.0, -30.0), 10)), **WIRE)
    assert path.outcome == "limit_point"
    moved = np.hypot(*(path.shape.tips(path.last_state[None])[0] - path.tips[-1])[:2])
    assert moved > 8.0 * np.hypot(*path.tips[-1, :2])
    assert f"; from its last row, at time 0.1, to its end the top moves by {moved:.3g} mm" in path.message
    assert "; but there coils reach" in path.message
    said = re.search(rf"; there the top has moved ([\d.]+) times {BUCKLED}", path.message)
    assert said
    assert float(said[1]) == pytest.approx(9.7, abs=0.2)


def test_what_is_sudden_is_so_by_the_load():
    """In stages time is none: the last row is unloaded, and from there on it is loaded more than before."""
    load = Load(stages=((0.0, -2.0), (0.0, 0.0), (0.0, -30.0)), steps=1)
    path = partial_path(equivbeam.solve, slender(load))
    assert (path.outcome, len(path.times)) == ("bifurcation", 2)
    assert "from its last row" not in path.message


@pytest.mark.parametrize("sliding", ["free", "none"])
@pytest.mark.parametrize("model", [equivbeam, wirefe])
def test_a_spring_that_comes_back_has_not_buckled(model, sliding):
    """Rounding, or what sticks, leaves the top where it is without a force."""
    contact = Contact(sliding=sliding)
    for load in (Load(stages=((0.0, -120.0), (0.0, 0.0)), steps=2), Load(displacement=(-12.0, 0.0), steps=2)):
        path = model.solve(replace(spring_b(), load=load, contact=contact))
        assert abs(path.tips[1, 1]) > 10.0 > 1e-9 > abs(path.tips[-1, 1])
        assert BUCKLED not in path.message


def test_factors_of_the_beam_do_not_matter_to_the_wire():
    scene = slender(Load((0.0, -3.3), 1))
    soft = replace(scene, factors=Factors(0.25, 1.0, 1.0))
    messages = {wirefe.solve(each, **WIRE).message for each in (scene, soft)}
    assert len(messages) == 1
    assert BUCKLED in messages.pop()


def test_a_row_near_the_end_shows_what_happens():
    path = partial_path(equivbeam.solve, slender(Load((0.0, -3.3), 20)))
    assert path.outcome == "bifurcation"
    assert path.message.endswith("the branch loses its stability")


def test_a_peak_beyond_what_was_compared_is_named():
    """The beam ends at 0.94 of the load, where the wire leans to six times as far."""
    beam, wire = (
        partial_path(model.solve, slender(Load((0.0, -3.3), 20)), **options)
        for model, options in ((equivbeam, {}), (wirefe, WIRE))
    )
    said = deviation(compare_paths(beam, wire), wire)
    assert said[1].endswith(f"{-wire.tips[-1, 1]:.3g} mm at time 1, beyond these steps")
    assert "beyond" not in "".join(deviation(compare_paths(wire, wire), wire))


@pytest.mark.parametrize(("letter", "count", "buckled"), [("b", 400, 6), ("w", 24, 1)])
def test_springs_that_are_said_to_buckle_lean(letter, count, buckled):
    """Of random springs on which no force acts sideways; and those that lean far are said to."""
    cases = [make_case(case_id(letter, number), 3006) for number in range(count)]
    paths = [reached(case) for case in cases if not case.scene.load.force[0]]
    assert sum(BUCKLED in path.message for path in paths) == buckled
    for path in paths:
        ends = path.states[:0] if path.last_state is None else path.last_state[None]
        leaning = np.abs(path.shape.tips(np.concatenate((path.states, ends)))[:, 2]).max(initial=0.0)
        assert (BUCKLED in path.message) <= (leaning > 0.1)
        assert (BUCKLED in path.message) >= (leaning > 0.7)


def test_a_soft_law_of_ones_own_does_not_buckle():
    """The rate at rest is the law's own: half of the textbook's."""
    space = {}
    exec(compile((Path(__file__).parents[1] / "examples/law_paper.py").read_text(), "<test>", "exec"), space)

    def parameters(coil):
        axial, *others = space["parameters"](coil)
        return 0.5 * axial, *others

    law = SimpleNamespace(parameters=parameters, energy=space["energy"])
    scene = replace(slender(Load((0.0, -1.0), 1)), supports=Supports(top_held=("ux", "rotz")))
    soft, paper = (equivbeam.solve(scene, **options) for options in ({"law": law}, {}))
    assert soft.tips[-1, 1] == pytest.approx(2.0 * paper.tips[-1, 1], rel=1e-6)
    assert "buckled" not in soft.message


def test_a_short_spring_on_plates_has_not_buckled():
    """By the formula, which is not of half a coil, it moved twice as far as at its initial rate."""
    spring = Spring(1.5, 10.0, 0.5, 3.0, end_turns=0.5)
    seat = Supports(("ux", "rotz"), seat="plate")
    scene = Scene("short", spring, Load((0.0, -10.0), 2), supports=seat, contact=Contact())
    path = wirefe.solve(scene, element="curved", elements_per_turn=4)
    assert path.message == "the load path was followed to time 1"
