"""Circle contact of the equivalent beam: (10)-(13), by hand and by differences."""

import numpy as np
import pytest

from coilspring.contact.law import PairLaw, pair_potential, tangential_stiffness
from equivbeam.contact import circle_centre, pair_forces
from pairrecords import held, pair_records

D, KC = 1.5, 2.0e4
OFFSETS = np.array([[5.0, 0.0], [4.6, -0.75]])
FREE = pair_records()[0]
G0 = np.array([0.05, 1.40, 0.0])
STUCK, SLIDING = held(G0), held(G0, bound=300.0)


def pair(q, k=1.0, history=FREE, distance=D):
    xa, ya = circle_centre(*q[:3], *OFFSETS[0])
    xb, yb = circle_centre(*q[3:], *OFFSETS[1])
    w, f, H = np.array([xb - xa, yb - ya, 0.0]), np.empty(3), np.empty((3, 3))
    law = PairLaw(distance, KC, tangential_stiffness(KC, k, distance), k, np.inf)
    energy = pair_potential(w, np.linalg.norm(w), law, history, np.empty(3), f, H)
    g, K = np.empty(6), np.empty((6, 6))
    pair_forces(f, H, xa - q[0], ya - q[1], xb - q[3], yb - q[4], g, K)
    return energy, g, K


def state(gap):
    """Two nodes, a little turned, whose circles have the given gap."""
    q = np.array([0.1, 0.0, 0.05, 0.5, 0.0, -0.03])
    centres = np.array([circle_centre(*q[:3], *OFFSETS[0]), circle_centre(*q[3:], *OFFSETS[1])])
    want = centres[0] + (D + gap) * np.array([0.1, np.sqrt(0.99)])
    q[3:5] += want - centres[1]
    return q


def test_force_by_hand():
    """Nodes one above the other, not turned: 0.1 mm of penetration press with 2000 N along y."""
    q = np.array([0.0, 0.0, 0.0, 0.4, 2.15, 0.0])
    energy, g, K = pair(q)
    np.testing.assert_allclose(-g, [0.0, -2000.0, -2000.0 * 5.0, 0.0, 2000.0, 2000.0 * 4.6])
    assert energy == pytest.approx(0.5 * KC * 0.1**2)
    assert K[4, 4] == pytest.approx(KC)
    assert K[3, 3] == pytest.approx(-2000.0 / 1.4)  # the force turns with the line of centres


def test_moment_is_r_cross_f_as_in_the_papers_arms():
    """M1 of the paper, with the sign that the gradient gives: r x F at the point of contact."""
    q = state(-0.02)
    _, g, _ = pair(q)
    a = np.array(circle_centre(*q[:3], *OFFSETS[0]))
    b = np.array(circle_centre(*q[3:], *OFFSETS[1]))
    direction = (b - a) / np.linalg.norm(b - a)
    F = KC * 0.02
    touch = a + 0.5 * D * direction  # (13), mended
    r = touch - q[:2]
    assert -g[2] == pytest.approx(r[0] * -F * direction[1] - r[1] * -F * direction[0])


@pytest.mark.parametrize("k", [1.0, 1.5, 2.0])
@pytest.mark.parametrize("history", [FREE, STUCK, SLIDING], ids=["frictionless", "no-sliding", "friction"])
def test_derivatives_closed(check_derivatives, k, history):
    check_derivatives(lambda step: pair(state(-0.03) + step, k, history), 6, h=1e-4)


@pytest.mark.parametrize("gap", [1e-3, -1e-3])
def test_derivatives_either_side_of_touching(check_derivatives, gap):
    if gap > 0:
        energy, g, K = pair(state(gap))
        assert energy == 0.0
        assert not g.any()
        assert not K.any()
    else:
        check_derivatives(lambda step: pair(state(gap) + step), 6, h=1e-5)


def moment_about_origin(q, g):
    return q[0] * g[1] - q[1] * g[0] + g[2] + q[3] * g[4] - q[4] * g[3] + g[5]


def test_pair_sums_to_zero_force_and_moment():
    q = state(-0.03)
    _, g, _ = pair(q)
    np.testing.assert_allclose(g[:2] + g[3:5], 0.0, atol=1e-9)
    assert moment_about_origin(q, g) == pytest.approx(0.0, abs=1e-8)


def test_no_sliding_leaves_the_couple_of_its_definition():
    """The tangential force acts at the centres, |g| apart: forces cancel, the couple g x f_t stays."""
    q = state(-0.03)
    _, g, _ = pair(q, history=STUCK)
    _, normal, _ = pair(q)
    np.testing.assert_allclose(g[:2] + g[3:5], 0.0, atol=1e-9)
    tangential = g[3:5] - normal[3:5]
    w = np.array(circle_centre(*q[3:], *OFFSETS[1])) - np.array(circle_centre(*q[:3], *OFFSETS[0]))
    assert moment_about_origin(q, g) == pytest.approx(w[0] * tangential[1] - w[1] * tangential[0])


def test_touching_exactly_is_no_force():
    energy, g, _ = pair(np.array([0.0, 0.0, 0.0, 0.4, 2.25, 0.0]))
    assert energy == pytest.approx(0.0, abs=1e-20)
    np.testing.assert_allclose(g, 0.0, atol=1e-9)
