"""The search for spheres that touch elsewhere than one turn apart."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial import cKDTree

import wirefe
from coilspring import CoilSection, Contact, Load, Scene, Spring, Supports, spring_a, spring_b
from coilspring.compiling.packing import pack
from coilspring.contact.law import PAIR_HISTORY
from validation.study.partialsolve import partial_path
from wirefe import kernels, model, tracing
from wirefe.contact.points import near_pairs
from wirestates import centres

FREE_B = replace(spring_b(), contact=Contact(geometry="spheres"))


def unlisted(contact, state, reach=1.0):
    """Pairs of spheres nearer than `reach` diameters that are no pair of the model; by another search."""
    found = cKDTree(centres(contact, state)).query_pairs(reach * contact.d, output_type="ndarray")
    listed = {tuple(pair) for pair in contact.pairs}
    return [
        (a, b)
        for a, b in found.tolist()
        if b - a > contact.near and contact.attached[a] != contact.attached[b] and (a, b) not in listed
    ]


def built(scene, pairs_per_turn=4, elements_per_turn=8):
    data, mesh, rod = model.build_model(scene, elements_per_turn, pairs_per_turn, "curved")
    return data, model.rest_state(rod, mesh.arm)


def committed(data, state):
    history = np.zeros(len(data.contact.pairs), PAIR_HISTORY)
    return kernels.update_history(*pack(data), state, history)


def thrown(state, seed, size):
    """The state with its nodes moved at random, but for the ends."""
    moved = state.reshape(-1, model.ROW).copy()
    moved[1:-1, :3] += size * np.random.default_rng(seed).normal(size=(len(moved) - 2, 3))
    return moved.ravel()


@pytest.mark.parametrize("pairs_per_turn", [4, 8])
def test_commit_finds_what_another_search_finds(pairs_per_turn):
    data, rest = built(spring_a(), pairs_per_turn)
    verdicts = []
    for seed in range(60):
        state = thrown(rest, seed, 0.2 * (seed % 20))
        verdicts.append(committed(data, state) == -np.inf)
        assert verdicts[-1] == bool(unlisted(data.contact, state))
    assert 10 < sum(verdicts) < 50


def test_strays_are_those_of_another_search():
    data, rest = built(spring_a(), 8)
    contact, state = data.contact, thrown(rest, 1, 0.6)
    pairs, distance = near_pairs(centres(contact, state), contact.attached, contact.pairs, contact.near, 4.5)
    assert sorted(map(tuple, pairs.tolist())) == sorted(unlisted(contact, state, reach=3.0))
    assert len(pairs) > 20
    way = centres(contact, state)[pairs]
    np.testing.assert_allclose(distance, np.linalg.norm(way[:, 1] - way[:, 0], axis=1))


def brought_together(data, rest):
    """The state at rest with the node of a sphere moved onto one two turns away."""
    contact, state = data.contact, rest.copy()
    A, B = 20, 28
    way = np.subtract(*centres(contact, rest)[[B, A]])
    state.reshape(-1, model.ROW)[contact.attached[A], :3] += way - [0.5, 0.0, 0.0]
    assert (A, B) in unlisted(contact, state)
    return state


def test_points_beyond_the_reach_along_the_axis_are_passed_over_but_no_nearer_ones():
    """A node moved to one two turns away is found, be the rest spread out, flat or upside down."""
    data, rest = built(spring_a())
    assert np.isfinite(committed(data, rest))
    for spread in (1.0, 3.0, -1.0, 0.0):
        state = rest.copy()
        state.reshape(-1, model.ROW)[:, 1] *= spread
        assert (committed(data, state) == -np.inf) == bool(unlisted(data.contact, state))
        assert committed(data, brought_together(data, state)) == -np.inf


def test_nothing_is_searched_where_contact_is_off():
    scene = spring_a().without_contact()
    data, rest = built(scene)
    assert committed(data, thrown(rest, 0, 2.0)) == np.inf


def test_tracing_finds_pairs_past_the_limit_point():
    """Frictionless B: spheres slide off each other and on to others; by 160 points on 7 such pairs."""
    path = wirefe.trace(FREE_B, points=160, element="curved", elements_per_turn=4)
    assert path.options["pairs_found"] > 0
    assert path.gaps.shape[1] == 33 + path.options["pairs_found"]
    assert [pair for state in path.states for pair in unlisted(path.shape.data.contact, state)] == []
    first = wirefe.trace(FREE_B, points=70, element="curved", elements_per_turn=4)
    assert first.options["pairs_found"] == 0


def test_a_traced_path_costs_what_all_its_runs_took(monkeypatch):
    """It begins anew where a pair is found."""
    costs, run = [], tracing._run

    def counted(*given):
        found, cost = run(*given)
        costs.append(cost)
        return found, cost

    monkeypatch.setattr(tracing, "_run", counted)
    path = wirefe.trace(FREE_B, points=160, element="curved", elements_per_turn=4)
    assert len(costs) > 1
    assert min(map(min, costs)) > 0.0
    assert path.total_iterations > path.iterations.sum()
    for name in tracing.Cost._fields:
        assert getattr(path, name) == pytest.approx(sum(getattr(cost, name) for cost in costs), rel=1e-12)


@pytest.mark.parametrize(
    ("scene", "penalty", "pairs_per_turn"),
    [(spring_a(), 30.0, 40), (spring_b(), 100.0, 40), (spring_b(), 30.0, 20), (FREE_B, 300.0, 40)],
    ids=["A", "B", "B until its limit point", "B frictionless"],
)
def test_a_path_goes_on_with_the_pairs_that_are_found(scene, penalty, pairs_per_turn):
    """Wires so soft that diagonal neighbours overlap; no stored state holds an overlap unknown to it, and
    nothing is solved twice."""
    path = solved(scene, penalty, pairs_per_turn)
    assert path.options["pairs_found"] > 10
    if path.outcome == "completed":
        assert path.total_iterations == path.iterations.sum()
    contact = path.shape.data.contact
    assert len(contact.pairs) == len({tuple(pair) for pair in contact.pairs})
    assert (contact.pairs[:, 0] + contact.near < contact.pairs[:, 1]).all()
    assert [pair for state in path.states for pair in unlisted(contact, state)] == []
    turns = np.abs(np.subtract(*contact.pairs.T)) / pairs_per_turn
    forces = path.contact_forces[-1]
    assert (forces[turns != 1.0] > 0.0).any()


def solved(scene, penalty, pairs_per_turn):
    options = {"element": "curved", "elements_per_turn": pairs_per_turn, "pairs_per_turn": pairs_per_turn}
    return partial_path(wirefe.solve, scene, steps=10, penalty=penalty, **options)


def test_the_last_state_is_searched_too():
    """The first unlisted overlap appears at full load."""
    scene = replace(spring_a(), load=Load((-7.65, -3.4)))
    path = solved(scene, 30.0, 40)
    assert unlisted(path.shape.data.contact, path.states[-1]) == []


def test_no_pair_is_added_where_coils_touch_one_turn_apart():
    for scene in (spring_a(), spring_b()):
        path = wirefe.solve(scene, steps=5, element="curved", elements_per_turn=8)
        assert path.options["pairs_found"] == 0
        assert path.total_iterations >= path.iterations.sum()


def test_touching_wires_of_a_short_spring_are_no_strays():
    """End turns lie on their neighbours at rest: rigid ends touch nothing of themselves."""
    short = replace(spring_a().spring, active_coils=2.5, active_height=8.0)
    scene = replace(spring_a(), spring=short, load=Load((0.0, -1.0), steps=2))
    path = wirefe.solve(scene, element="curved", elements_per_turn=8)
    assert path.options["pairs_found"] == 0


@pytest.mark.parametrize("steps", [1, 4, 10, 100])
def test_with_which_stations_of_another_coil_wires_are_paired_is_no_matter_of_steps(steps):
    """Coils that pass inside one another: stations were paired with those nearest when any pair was found,
    and tips differed by 0.6 %."""
    spring = Spring.of_sections(
        1.5,
        (
            CoilSection(1.0, 4.771196830239829, 10.219195007911274),
            CoilSection(1.0, (5.6865320302590305, 4.1175266770458485), (10.219195007911274, 6.75)),
            CoilSection(1.0, 2.8560716857143476, (6.75, 8.868726706106399)),
        ),
        end_turns=0.0,
        start_phase=-0.08892380252844179,
        hand="right",
    )
    load = Load((0.0, -323.8522216288093), steps)
    scene = Scene("nested", spring, load, supports=Supports(("ux", "rotz")), contact=Contact(stiffness=1e5))
    path = wirefe.solve(scene, element="curved", elements_per_turn=8)
    assert path.options["pairs_found"] > 0
    assert path.tips[-1, 1] == pytest.approx(-9.628058, abs=1e-5)
