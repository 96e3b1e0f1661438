"""End turns and supports that scenes beyond the paper's have."""

from dataclasses import replace

import numpy as np
import pytest

import equivbeam
import wirefe
from coilspring import CoilSection, Contact, Load, Scene, Spring, Supports

COLUMN = Spring(1.5, 10.0, 8.0, 30.0)
CONE = Spring(1.5, (12.0, 8.0), 6.0, 24.0, ends="open")


def lateral(force, *held):
    free = Contact(enabled=False)
    return Scene("lateral", COLUMN, Load((-force, 0.0), steps=2), supports=Supports(held), contact=free)


@pytest.mark.parametrize("held", [("uy",), ("uy", "rotz")])
def test_a_top_of_constant_height_moves_across_as_the_lateral_stiffness_says(held):
    found = equivbeam.solve(lateral(1e-3, *held)).tips[-1]
    stiffness = equivbeam.lateral_stiffness(lateral(1.0, *held[1:]), 1e-6)
    assert found[0] == pytest.approx(-1e-3 / stiffness, rel=1e-5)
    assert found[1] == 0.0


@pytest.mark.parametrize("held", [("uy",), ("uy", "rotz")])
def test_both_models_hold_the_height(held):
    wire = wirefe.solve(lateral(8.0, *held)).tips
    for law, tolerance in (("haringx", 5e-3), ("helix", 4e-3)):  # 0.4 % and 0.3 % found
        beam = equivbeam.solve(lateral(8.0, *held), law=law).tips
        np.testing.assert_allclose(beam, wire, rtol=tolerance, atol=1e-12)
    assert not wire[:, 1].any()
    unheld = equivbeam.solve(lateral(8.0)).tips
    assert abs(unheld[-1, 0]) > 1.2 * abs(wire[-1, 0])  # it pulls itself straight


def test_open_ends_keep_the_pitch():
    last = 2.0 * np.pi * 7.0
    heights = CONE.height(np.array([-2.0 * np.pi, 0.0, 6.0 * np.pi, 12.0 * np.pi, last]))
    np.testing.assert_allclose(heights, [-4.0, 0.0, 12.0, 24.0, 28.0])
    np.testing.assert_allclose(replace(CONE, ends="closed").height(np.array([-np.pi, last])), [-0.75, 25.5])
    uneven = Spring.of_sections(
        1.5, [CoilSection(2.0, 2.0, 10.0), CoilSection(3.0, (2.0, 5.0), 10.0)], ends="open"
    )
    ends = uneven.height(np.array([-2.0 * np.pi, 12.0 * np.pi]))
    np.testing.assert_allclose(ends, [-2.0, uneven.active_height + 5.0])


@pytest.mark.parametrize("solve", [equivbeam.solve, wirefe.solve])
def test_open_end_turns_touch_later_than_closed_ones(solve):
    scene = Scene("cone", CONE, Load((0.0, -138.0), steps=80), supports=Supports(("ux", "rotz")))
    closed = replace(scene, spring=replace(CONE, ends="closed"))
    open_path, closed_path = solve(scene), solve(closed)
    bare = [solve(each.without_contact()).tips for each in (scene, closed)]
    np.testing.assert_allclose(bare[0], bare[1], rtol=1e-8, atol=1e-12)
    first, second = (np.flatnonzero(path.active_contacts)[0] for path in (open_path, closed_path))
    assert first > second
    assert 0 < open_path.active_contacts[-1] < closed_path.active_contacts[-1]


@pytest.mark.parametrize("solve", [equivbeam.solve, wirefe.solve])
def test_with_a_prescribed_displacement_the_load_is_all_that_holds_the_top(solve):
    """What a guide holds was left out, 0 in path.csv: up to a quarter of the axial force."""
    options = {"law": "helix"} if solve is equivbeam.solve else {"element": "curved", "elements_per_turn": 8}
    spring = Spring(3.9, (20.1, 21.7), 3.0, 24.0, start_phase=0.7)
    scene = Scene("guided", spring, Load(displacement=(-4.0,), steps=2), supports=Supports(("ux", "rotz")))
    pressed = solve(scene, **options)
    (x, y), tip = pressed.loads[-1], pressed.tips[-1]
    assert abs(x) > 3e-3 * abs(y)
    freed = replace(scene, load=Load((x, y), steps=2), supports=Supports(("rotz",)))
    np.testing.assert_allclose(solve(freed, **options).tips[-1], tip, atol=1e-6)
    across = solve(replace(scene, supports=Supports(("rotz",))), **options)
    assert not across.loads[:, 0].any()
    assert abs(across.loads[-1, 1] - y) > 1e-5 * abs(y)
