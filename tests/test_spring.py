"""The helix at rest, against hand-computed geometry."""

from dataclasses import replace

import numpy as np
import pytest

from coilspring import InputError, Load, Spring, spring_a, spring_b
from coilspring.scene import Factors
from coilspring.scene.profile import CoilSection


def test_catalogue_holds_table_1():
    a, b = spring_a(), spring_b()
    assert (a.spring.wire_diameter, a.spring.mean_diameter, a.spring.active_coils) == (1.5, (10, 10), 14.5)
    assert (b.spring.wire_diameter, b.spring.mean_diameter, b.spring.active_coils) == (1.5, (12, 6), 7.5)
    for scene in (a, b):
        first, last = scene.spring.phase_range
        assert scene.spring.height(last) - scene.spring.height(first) == pytest.approx(31.6)  # total height
    assert a.load.force == (-9, -4)
    assert b.load.force == (0, -200)
    assert (a.supports.top_held, b.supports.top_held) == ((), ("ux", "rotz"))
    assert (a.contact.sliding, b.contact.sliding) == ("free", "none")


def test_cone_is_linear_and_its_end_turns_are_cylinders():
    spring = spring_b().spring
    phases = np.array([-2.0 * np.pi, 0.0, 7.5 * np.pi, 15.0 * np.pi, 17.0 * np.pi])
    np.testing.assert_allclose(spring.radius(phases), [6.0, 6.0, 4.5, 3.0, 3.0])
    np.testing.assert_allclose(spring.height(phases), [-1.5, 0.0, 14.3, 28.6, 30.1])


@pytest.mark.parametrize(("hand", "sign"), [("left", -1.0), ("right", 1.0)])
def test_hand_is_the_sign_of_the_torsion(hand, sign):
    spring = Spring(1.5, 10.0, 14.5, 28.6, hand=hand)
    h = 1e-2
    p = spring.points(5.0 + h * np.arange(-2, 3))
    d1 = (p[3] - p[1]) / (2 * h)
    d2 = (p[3] - 2 * p[2] + p[1]) / h**2
    d3 = (p[4] - 2 * p[3] + 2 * p[1] - p[0]) / (2 * h**3)
    assert np.sign(np.linalg.det([d1, d2, d3])) == sign


def test_wire_crosses_the_working_plane_on_alternating_sides():
    spring = spring_a().spring
    points = spring.points(spring.circle_phases())
    assert len(points) == 34  # 29 half coils, two more at each end, fence posts
    np.testing.assert_allclose(points[:, 2], 0.0, atol=1e-12)
    np.testing.assert_allclose(points[:, 0], 5.0 * (-1.0) ** np.arange(34))


def test_start_phase_turns_the_helix():
    turned = Spring(1.5, 10.0, 14.5, 28.6, start_phase=0.5 * np.pi)
    np.testing.assert_allclose(turned.points(np.zeros(1)), [[0.0, 0.0, 5.0]], atol=1e-12)
    np.testing.assert_allclose(turned.points(turned.circle_phases())[:, 2], 0.0, atol=1e-12)


@pytest.mark.parametrize("ends", ["closed", "open"])
def test_tangents_are_exact(ends):
    """Differences of points, 1e-5 rad apart, were off by 1e-10: a gap of two hard wires by 1e-13 mm."""
    spring = Spring(1.5, (12.0, 6.0), 7.5, 28.6, end_turns=1.0, ends=ends, start_phase=0.3)
    phases, h = np.array([-3.0, 0.5, 20.0, 46.0, 49.0]), 1e-3
    p = [spring.points(phases + step * h) for step in (-2, -1, 1, 2)]
    np.testing.assert_allclose(
        spring.tangents(phases), (8 * (p[2] - p[1]) - (p[3] - p[0])) / (12 * h), atol=1e-10
    )
    inner = phases[1:4]
    np.testing.assert_allclose(spring.tangents(inner), spring.derivatives(inner)[0], rtol=1e-13, atol=1e-14)


def test_the_tangent_where_end_turns_begin_is_the_mean_of_both_sides():
    spring = Spring(1.5, (12.0, 6.0), 7.5, 28.6, end_turns=1.0)
    end = spring.phase_end
    for phase in (0.0, end):
        beside = spring.tangents(np.array([phase - 1e-6, phase + 1e-6]))
        np.testing.assert_allclose(spring.tangents(np.array([phase]))[0], beside.mean(axis=0), atol=1e-10)


@pytest.mark.parametrize(
    ("part", "given"),
    [
        ("load", (0.0, -5.0)),
        ("supports", ("ux", "rotz")),
        ("contact", "none"),
        ("material", 2e5),
        ("spring", None),
    ],
)
def test_parts_of_a_scene_are_of_their_kind(part, given):
    with pytest.raises(InputError, match=f"{part} must be a {part.capitalize()}, got "):
        replace(spring_a(), **{part: given})


def test_diameters_and_pitches_may_be_arrays():
    ends = np.array([18.0, 14.0])
    assert Spring(2.0, ends, 6.0, 30.0) == Spring(2.0, (18.0, 14.0), 6.0, 30.0)
    assert Spring(2.0, np.array(18.0), 6.0, 30.0) == Spring(2.0, 18.0, 6.0, 30.0)
    others = {"active_coils": 6.0, "active_height": 30.0}
    assert Spring.of_diameter(2.0, outer_diameter=ends + 2.0, **others) == Spring(2.0, ends, **others)
    section = CoilSection(6.0, np.array([4.0, 6.0]), ends)
    assert Spring.of_sections(2.0, [section]).coils == (CoilSection(6.0, (4.0, 6.0), (18.0, 14.0)),)
    with pytest.raises(InputError, match=r"mean_diameter must be one number or two .* \[18.0, 14.0, 9"):
        Spring(2.0, np.array([18.0, 14.0, 9.0]), 6.0, 30.0)
    with pytest.raises(InputError, match=r"spring.mean_diameter must be a number in .*, got \[18.0, 14.0\]"):
        Spring(2.0, np.array([ends, ends]), 6.0, 30.0)


def test_loads_may_be_arrays():
    stages = np.array([[0.0, -5.0], [0.0, -1.0]])
    assert Load(stages=stages) == Load(stages=((0.0, -5.0), (0.0, -1.0)))
    assert Load(displacement=np.array([-1.0, -2.0])) == Load(displacement=(-1.0, -2.0))
    assert Load(np.array([1.0, -5.0])) == Load((1.0, -5.0))


def test_factors_may_be_an_array():
    assert Factors.of(np.array([1.0, 0.9, 1.1])) == Factors(1.0, 0.9, 1.1)
