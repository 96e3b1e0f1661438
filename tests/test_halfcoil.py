"""The half-coil element: equations (1)-(9) and the matrix of section 2.3."""

import numpy as np
import pytest

from coilspring import Material, spring_a
from equivbeam.element import gradient, hessian, measures, paper_matrix
from equivbeam.laws.haringx import haringx_response, haringx_stiffness

KAX, KSH, KFL, L0 = 7.0, 18.0, 95.0, 1.3


ROWS = np.array([[KAX, KSH, KFL, L0]])


def element(p):
    c, s, l, v, dth = measures(*p)  # noqa: E741
    r = haringx_response(ROWS, 0, l, v, dth)
    g, K = np.empty(6), np.empty((6, 6))
    gradient(r, c, s, l, v, g)
    hessian(r, c, s, l, v, K)
    return r.U, g, K


REST = np.array([0.0, 0.0, 0.0, 0.0, L0, 0.0])


def test_stiffness_of_spring_a_by_hand():
    # G = 79230.77, d^4 = 5.0625, D^3 = 1000, tan p = 1.972414 / (10 pi)
    kax, ksh, kfl = haringx_stiffness(spring_a().spring, Material())[0]
    cos_p = np.cos(np.arctan(1.9724137931 / (10 * np.pi)))
    G = 206000 / 2.6
    assert kax == pytest.approx(2 * G * 5.0625 / 8000 * cos_p)
    assert ksh == pytest.approx(2 * 206000 * 5.0625 / 8000 * cos_p)
    assert kfl == pytest.approx(8 * 206000 * G * 5.0625 / (640 * (2 * G + 206000)) * cos_p)


@pytest.mark.parametrize("seed", range(3))
def test_gradient_and_hessian(check_derivatives, seed):
    state = REST + np.random.default_rng(seed).normal(scale=0.7, size=6)
    check_derivatives(lambda step: element(state + step), 6)


def test_forces_are_the_papers():
    state = REST + np.random.default_rng(4).normal(scale=0.5, size=6)
    _, g, _ = element(state)
    thb = 0.5 * (state[2] + state[5])
    t, n = np.array([np.cos(thb), np.sin(thb)]), np.array([-np.sin(thb), np.cos(thb)])
    a = state[3:5] - state[:2]
    length, v = a @ n, a @ t
    N2, T2 = KAX * (length - L0), KSH * v
    M = KFL * (state[5] - state[2])
    np.testing.assert_allclose(g[3:5], N2 * n + T2 * t)
    assert g[5] == pytest.approx(M - N2 * v / 2 + T2 * length / 2)  # (9)
    assert g[2] + g[5] + N2 * v - T2 * length == pytest.approx(0.0, abs=1e-12)  # (6), lever signs as in (9)


def test_rigid_motion_strains_nothing():
    c, s = np.cos(0.8), np.sin(0.8)
    moved = np.array([3.0, -2.0, 0.8, 3.0 - s * L0, -2.0 + c * L0, 0.8])
    energy, g, _ = element(moved)
    assert energy < 1e-28
    np.testing.assert_allclose(g, 0.0, atol=1e-13)


def tip_flexibility(K):
    return np.linalg.inv(K[3:, 3:])[0, 0]


def test_papers_matrix_needs_the_12():
    """Lateral tip flexibility of one clamped element: L^2 / (3 Kfl) + 1 / Ksh."""
    K = np.empty((6, 6))
    paper_matrix(1.0, 0.0, KAX, KSH, KFL, L0, 12.0, K)
    assert tip_flexibility(K) == pytest.approx(L0**2 / (3 * KFL) + 1 / KSH)
    paper_matrix(1.0, 0.0, KAX, KSH, KFL, L0, 1.0, K)
    assert tip_flexibility(K) == pytest.approx(L0**2 / (3 * KFL) + 1 / (12 * KSH))  # as printed


def test_papers_matrix_is_not_the_tangent_even_at_rest():
    """Its lateral stiffness is 1 / (1/Ksh + L^2 / (12 Kfl)) where the force law has Ksh."""
    K = np.empty((6, 6))
    paper_matrix(1.0, 0.0, KAX, KSH, KFL, L0, 12.0, K)
    _, _, H = element(REST)
    assert K[3, 3] == pytest.approx(1 / (1 / KSH + L0**2 / (12 * KFL)))
    assert H[3, 3] == pytest.approx(KSH)
    assert K[4, 4] == H[4, 4] == pytest.approx(KAX)


@pytest.mark.parametrize("thb", [0.0, 0.7])
def test_papers_matrix_feels_no_rigid_motion(thb):
    K = np.empty((6, 6))
    paper_matrix(np.cos(thb), np.sin(thb), KAX, KSH, KFL, L0, 12.0, K)
    n = np.array([-np.sin(thb), np.cos(thb)])
    turn = np.array([0.0, 0.0, 1.0, -L0 * n[1], L0 * n[0], 1.0])
    for rigid in (np.eye(3)[[0, 1, 2, 0, 1, 2]][:, 0], np.eye(3)[[0, 1, 2, 0, 1, 2]][:, 1], turn):
        np.testing.assert_allclose(K @ rigid, 0.0, atol=1e-10)
    np.testing.assert_allclose(K, K.T)
