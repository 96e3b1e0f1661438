"""What both models' kernels promise the path follower: the softest mode, and how far a state moved."""

from dataclasses import replace

import numpy as np
import pytest

import equivbeam
import wirefe
from coilspring import (
    Contact,
    EquilibriumNotFound,
    Load,
    Scene,
    Spring,
    Supports,
    spring_a,
    spring_b,
)
from coilspring.compiling.packing import pack
from coilspring.solver.body import body_of, softest
from coilspring.solver.outcome import SOFT
from equivbeam.model import beam_problem, build_model, load_vector
from equivbeam.solve import KERNELS as BEAM_KERNELS
from validation.campaign.scenes import in_units, make_case
from validation.campaign.verdict import reached
from wirefe.solve import KERNELS as WIRE_KERNELS
from wirefe.solve import scene_problem

MODELS = ("equivbeam", "wirefe")


def kernels_of(model, scene):
    if model == "wirefe":
        return WIRE_KERNELS, scene_problem(scene, "straight", 8, 4)[0]
    data = build_model(scene)
    return BEAM_KERNELS, beam_problem(data, load_vector(data, scene))


@pytest.mark.parametrize("scene", [spring_a(), replace(spring_a(), contact=Contact())])
@pytest.mark.parametrize("solve", [equivbeam.solve, wirefe.solve])
def test_the_least_gaps_that_a_path_keeps_are_those_of_its_states(solve, scene):
    path = solve(scene)
    assert path.least_gaps[0] > 0.0 > path.least_gaps[-1]
    np.testing.assert_allclose(path.least_gaps, path.gaps.min(axis=1), rtol=0.0, atol=1e-12)


@pytest.mark.parametrize("held", [("ux", "rotz"), ()])
@pytest.mark.parametrize("model", MODELS)
def test_the_softest_mode_at_rest_is_as_stiff_as_at_rest(model, held):
    """A stiff short spring: the unit rows of held dofs would be softer than any of its modes."""
    scene = replace(
        spring_b(),
        spring=Spring(10.0, 40.0, 3.0, 45.0),
        supports=Supports(held),
        contact=Contact(geometry="spheres", enabled=False),
    )
    kernels, problem = kernels_of(model, scene)
    body = body_of(problem, kernels)
    share, _, _ = softest(body, problem.start, problem.history, problem.start, problem.load)
    assert share == pytest.approx(1.0, rel=1e-5)


def test_the_softest_mode_has_no_units():
    """Its stiffness over that at rest, at a limit point where hard coils touch: the same in mm and in m."""
    case, shares = make_case("b000327", 713), []
    for length, force in ((1.0, 1.0), (1e-3, 1e-6)):
        path = reached(case, in_units(case.scene, length, force))
        assert path.outcome == "limit_point"
        kernels, problem = kernels_of("equivbeam", path.scene)
        body = body_of(problem, kernels)
        shares.append(softest(body, path.last_state, problem.history, problem.start, problem.load)[0])
    assert shares[1] == pytest.approx(shares[0], rel=0.01)
    assert abs(shares[0]) < 0.01 * SOFT


@pytest.mark.parametrize(
    ("held", "displacement", "outcome"), [((), -16.9, "limit_point"), (("ux", "rotz"), -8.0, "bifurcation")]
)
def test_what_ends_a_prescribed_displacement_has_no_units(held, displacement, outcome):
    """A limit point of a spring four times as large, or of harder coils, was called a bifurcation."""
    free = Spring(3.0, 33.4, 3.5, 20.4, end_turns=0.0, ends="open", wire_rigidity="solid")
    column = Spring(0.5, 3.0, 15.0, 20.0)
    scene = Scene(
        "end",
        column if held else free,
        Load(displacement=(displacement,), steps=1),
        supports=Supports(held),
        contact=Contact(stiffness=3e4),
    )
    ends = []
    for changed in (
        scene,
        *(in_units(scene, size, size**2) for size in (1 / 64, 64.0)),
        scene.with_penalty(3e6),
    ):
        with pytest.raises(EquilibriumNotFound) as found:
            equivbeam.solve(changed)
        ends.append((found.value.path.outcome, found.value.path.critical_time))
    assert [name for name, _ in ends] == [outcome] * 4
    np.testing.assert_allclose([time for _, time in ends], ends[0][1], rtol=1e-4)


@pytest.mark.parametrize("model", MODELS)
def test_pairs_are_looked_at_where_anything_moved_enough(model):
    """Spring A from half its load to the whole: coils close on the way."""
    solve = {"equivbeam": equivbeam.solve, "wirefe": wirefe.solve}[model]
    options = {"elements_per_turn": 8} if model == "wirefe" else {}
    path = solve(spring_a(), steps=2, penalty=100.0, **options)
    kernels, problem = kernels_of(model, spring_a())
    data, d = pack(problem.data), path.scene.spring.wire_diameter
    first, last = path.states
    way, pair, free = kernels.displacement_bound(*data, first, last, 0.0)
    assert kernels.displacement_bound(*data, first, last, np.inf) == (way, 0.0, 1.0)
    assert kernels.displacement_bound(*data, first, last, way) == (way, 0.0, 1.0)
    assert kernels.displacement_bound(*data, first, first, -1.0) == (0.0, 0.0, 1.0)
    assert 0.0 < pair * d <= 2.0 * way
    assert 0.0 < free < 1.0
    closing = (path.gaps[0] >= 0.0) & (path.gaps[1] < -0.003 * d)
    # were centres to move straight, the first pair would be that deep after this share of the way
    shares = (path.gaps[0] / (path.gaps[0] - path.gaps[1]))[closing]
    assert free == pytest.approx(shares.min(), abs=0.1)
