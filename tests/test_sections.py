"""Springs of several sections: exact geometry, and what both models make of it."""

from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
from scipy.integrate import quad

import equivbeam
import wirefe
from coilspring import CoilSection, Contact, InputError, Load, Material, Scene, Spring, Supports, load_scene
from coilspring.compiling.packing import pack
from coilspring.contact.law import PAIR_HISTORY
from coilspring.scene.wire import round_section
from equivbeam import kernels, model
from equivbeam.options import BeamOptions
from wirefe.contact.stations import turned_rows as turned
from wirefe.results.linear import tip_flexibility

BARREL = load_scene(Path(__file__).parents[1] / "examples" / "barrel.toml")
PLAIN = Spring(1.5, 10.0, 6.5, 19.5)
CONE = Spring(1.5, (12.0, 7.2), 6.0, 18.0, end_turns=0.5)
PROGRESSIVE = Spring.of_sections(
    2.0, [CoilSection(2.0, 2.8, 18.0), CoilSection(2.0, (2.8, 6.0), 18.0), CoilSection(2.0, 6.0, 18.0)]
)
LOWER = CoilSection(1.5, (4.0, 3.0), (14.0, 10.0))
UPPER = CoilSection(2.5, (3.0, 3.6), (10.0, 13.0))
HOURGLASS = Spring.of_sections(1.5, [LOWER, UPPER])


def axial(spring, force, **contact):
    return Scene(
        "axial",
        spring,
        Load((0.0, -force), steps=10),
        supports=Supports(top_held=("ux", "rotz")),
        contact=Contact(geometry="spheres", **contact),
    )


def cut(spring, *coils):
    """A spring of constant pitch and taper, cut into sections of so many coils."""
    ends = 2.0 * spring.radius(np.concatenate(([0.0], np.cumsum(coils))) * 2.0 * np.pi)
    sections = [CoilSection(n, spring.pitch, tuple(ends[i : i + 2])) for i, n in enumerate(coils)]
    return Spring.of_sections(spring.wire_diameter, sections, end_turns=spring.end_turns)


def upside_down(spring):
    sections = [CoilSection(s.coils, s.pitch[::-1], s.mean_diameter[::-1]) for s in spring.sections[::-1]]
    return Spring.of_sections(spring.wire_diameter, sections, end_turns=spring.end_turns)


@pytest.mark.parametrize(("spring", "coils"), [(PLAIN, (2.0, 2.25, 2.25)), (CONE, (1.0, 3.5, 1.5))])
def test_equal_sections_are_the_plain_spring(spring, coils):
    sectioned = cut(spring, *coils)
    phases = np.linspace(*spring.phase_range, 301)
    np.testing.assert_allclose(sectioned.points(phases), spring.points(phases), atol=1e-13)
    active = np.linspace(0.0, spring.phase_end, 301)
    for found, exact in zip(sectioned.derivatives(active), spring.derivatives(active), strict=True):
        np.testing.assert_allclose(found, exact, atol=1e-13)


@pytest.mark.parametrize(("spring", "coils"), [(PLAIN, (2.0, 2.25, 2.25)), (CONE, (1.0, 3.5, 1.5))])
@pytest.mark.parametrize(
    ("solve", "options", "tolerance"),
    [
        (equivbeam.solve, {"law": "haringx"}, 1e-9),
        (equivbeam.solve, {"law": "helix"}, 1e-9),
        (wirefe.solve, {"elements_per_turn": 20}, 1e-9),
        (wirefe.solve, {"element": "curved", "elements_per_turn": 4}, 1e-9),
    ],
)
def test_equal_sections_deform_as_the_plain_spring(spring, coils, solve, options, tolerance):
    plain, same = (solve(axial(each, 85.0), **options) for each in (spring, cut(spring, *coils)))
    assert plain.active_contacts[-1] > 0
    np.testing.assert_allclose(same.tips, plain.tips, atol=tolerance)
    np.testing.assert_allclose(same.contact_forces, plain.contact_forces, atol=1e3 * tolerance)


@pytest.mark.parametrize("spring", [BARREL.spring, PROGRESSIVE, HOURGLASS])
def test_height_is_the_integral_of_the_pitch(spring):
    low = 0.0
    for section, top in zip(spring.sections, np.cumsum([s.coils for s in spring.sections]), strict=True):
        for share in (0.3, 1.0):
            turns = share * section.coils
            rise = quad(lambda t, s=section: np.interp(t, [0.0, s.coils], s.pitch), 0.0, turns)[0]
            phase = 2.0 * np.pi * (top - section.coils + turns)
            assert spring.height(np.array([phase]))[0] == pytest.approx(low + rise, rel=1e-13)
        low += rise
    assert spring.active_height == pytest.approx(low, rel=1e-13)


@pytest.mark.parametrize("spring", [BARREL.spring, PROGRESSIVE, HOURGLASS, CONE])
def test_derivatives_are_those_of_the_points(spring):
    knots, h = spring.profile.knots, 1e-3
    inside = (knots[:-1, None] + np.diff(knots)[:, None] * np.array([0.2, 0.5, 0.9])).ravel()
    behind, here, ahead = (spring.points(inside + step) for step in (-h, 0.0, h))
    first, second = spring.derivatives(inside)
    np.testing.assert_allclose(first, (ahead - behind) / (2.0 * h), atol=1e-5)
    np.testing.assert_allclose(second, (ahead - 2.0 * here + behind) / h**2, atol=1e-5)


def test_the_mesh_is_as_long_as_the_wire():
    spring = BARREL.spring

    def speed(phase):
        return np.linalg.norm(spring.derivatives(np.array([phase]))[0])

    length = sum(quad(speed, *ends, epsabs=1e-10)[0] for ends in pairwise(spring.profile.knots))
    chords = [
        np.linalg.norm(np.diff(wirefe.mesh.mesh_wire(spring, count).points, axis=0), axis=1).sum()
        for count in (40, 80)
    ]
    errors = length - np.array(chords)
    assert errors[1] < 1e-3 * length
    assert errors[0] / errors[1] == pytest.approx(4.0, rel=1e-3)  # chords of a curve: second order


def flexibility(spring):
    """Axial flexibility under a force on the axis, the top free, by the linear wire model."""
    phases = np.linspace(0.0, spring.phase_end, round(8 * spring.active_coils) + 1)
    rod = wirefe.curved_rod(spring, phases, round_section(spring.wire_diameter, Material()))
    return tip_flexibility(rod, np.array([0.0, spring.active_height, 0.0]))[1, 1]


def test_sections_are_springs_in_series():
    """Castigliano: under an axial force the flexibilities of the pieces add, in both models."""
    parts = [Spring.of_sections(1.5, [section], end_turns=0.0) for section in HOURGLASS.sections]
    whole = Spring.of_sections(1.5, HOURGLASS.sections, end_turns=0.0)
    assert flexibility(whole) == pytest.approx(sum(map(flexibility, parts)), rel=1e-10)
    # what held ends do to the axis is not held where two pieces meet
    for law, options in (("haringx", {}), ("helix", {"refinements": equivbeam.Refinements(ends=False)})):
        small = [
            equivbeam.solve(axial(each, 1e-6, enabled=False), law=law, **options).tips[-1, 1]
            for each in (whole, *parts)
        ]
        assert small[0] == pytest.approx(small[1] + small[2], rel=1e-7)


def test_the_models_rates_agree_on_a_barrel():
    helix = equivbeam.solve(axial(BARREL.spring, 0.1, enabled=False), law="helix").tips[-1, 1]
    wire = wirefe.solve(axial(BARREL.spring, 0.1, enabled=False), element="curved", elements_per_turn=8).tips[
        -1, 1
    ]
    assert helix == pytest.approx(wire, rel=2e-3)  # 0.065 % found


@pytest.mark.parametrize(("solve", "pairs_per_turn"), [(equivbeam.solve, 2), (wirefe.solve, 4)])
def test_coils_of_small_pitch_close_first(solve, pairs_per_turn):
    path = solve(axial(PROGRESSIVE, 70.0, sliding="none"))
    closed = path.contact_forces > 0.0
    first = np.where(closed.any(axis=0), closed.argmax(axis=0), len(closed))
    active = first[pairs_per_turn:-pairs_per_turn]  # without the pairs of the end turns
    assert (np.diff(active) >= 0).all()
    assert active[0] <= 3
    assert active[-1] == 10  # never
    stiffness = np.diff(path.loads[:, 1]) / np.diff(path.tips[:, 1])
    assert stiffness[-1] > 1.5 * stiffness[0]


@pytest.mark.parametrize(
    ("solve", "options"),
    [(equivbeam.solve, {"law": "haringx"}), (equivbeam.solve, {"law": "helix"}), (wirefe.solve, {})],
)
def test_a_spring_turned_over_behaves_the_same(solve, options):
    up, down = (solve(axial(each, 70.0), **options) for each in (HOURGLASS, upside_down(HOURGLASS)))
    assert up.active_contacts[-1] > 0
    np.testing.assert_allclose(down.tips[:, 1], up.tips[:, 1], rtol=1e-7)
    np.testing.assert_allclose(down.contact_forces[:, ::-1], up.contact_forces, atol=1e-5)


@pytest.mark.parametrize("law", ["haringx", "helix"])
def test_the_equivalent_beam_rests(law):
    data = model.build_model(BARREL, BeamOptions(law))
    state = model.rest_state(data)
    np.testing.assert_allclose(state[1::3], BARREL.spring.height(np.arange(14) * np.pi), atol=1e-13)
    g, H = np.empty(state.size - 3), np.empty(model.matrix_size(data))
    kernels.assemble(*pack(data), state, 0.0, np.zeros(len(data.pairs), PAIR_HISTORY), state, g, H)
    assert np.abs(g).max() < 1e-11


def test_straight_and_curved_elements_meet_on_a_barrel():
    scene = axial(BARREL.spring, 20.0, enabled=False)
    fine = wirefe.solve(scene, element="curved", elements_per_turn=32).tips[-1, 1]
    errors = [wirefe.solve(scene, elements_per_turn=n).tips[-1, 1] / fine - 1.0 for n in (40, 80)]
    assert abs(errors[1]) < 2e-3
    assert errors[0] / errors[1] == pytest.approx(4.0, rel=0.05)


@pytest.mark.parametrize("solve", [equivbeam.solve, wirefe.solve])
def test_the_drawn_wire_begins_as_the_spring_at_rest(solve):
    phases = np.linspace(*BARREL.spring.phase_range, 97)
    path = solve(axial(BARREL.spring, 1e-6))
    drawn = path.shape.centreline(path.states[0], phases)
    np.testing.assert_allclose(drawn, BARREL.spring.points(phases), atol=1e-6)


def test_elements_see_their_own_side_of_a_kink():
    """At a knot of the pitch the wire has two tangents."""
    spring = Spring.of_sections(1.5, [CoilSection(1.0, 2.0, 10.0), CoilSection(1.0, 5.0, 10.0)])
    phases = np.linspace(0.0, spring.phase_end, 9)
    triads = wirefe.curved_rod(spring, phases, round_section(1.5, Material())).triads
    up = np.array([turned(triads[e, end], np.array([1.0, 0.0, 0.0]))[1] for e, end in ((3, 1), (4, 0))])
    np.testing.assert_allclose(up, [p / np.hypot(p, 10.0 * np.pi) for p in (2.0, 5.0)], rtol=1e-9)
    first, _ = spring.derivatives(np.array([2.0 * np.pi]))
    assert first[0, 1] == pytest.approx(5.0 / (2.0 * np.pi))


def test_what_only_plain_springs_have_is_refused():
    with pytest.raises(InputError, match="tangent must be exact where the spring has sections"):
        equivbeam.solve(BARREL, tangent="paper")
    thirds = Spring.of_sections(1.5, [CoilSection(1.3, 3.0, 10.0), CoilSection(2.7, 4.0, 10.0)])
    with pytest.raises(InputError, match=r"spring\.sections\[0\] must end at a multiple of 1/4 coils.*1\.3"):
        wirefe.solve(axial(thirds, 1.0), element="curved", elements_per_turn=4)
    assert wirefe.solve(axial(thirds, 1.0), elements_per_turn=20).outcome == "completed"
