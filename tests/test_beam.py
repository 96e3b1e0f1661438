"""The wire's beam element: derivatives, objectivity, exactness for small loads."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from coilspring import Material
from coilspring.scene.wire import round_section
from wirefe.element.beam import beams, deformations
from wirefe.element.rotations import exponential, stretch_functions, times
from wirefe.rod import straight_stiffness

UNIT = np.array([1.0, 0.0, 0.0, 0.0])


def spun(spin, q):
    return np.array(times(exponential(spin), q))


def nodes(x1, q1, x2, q2):
    return np.concatenate((x1, q1, x2, q2))


def one(x1, q1, x2, q2, triads, e0, K, Q=None):
    g, H = np.empty((1, 12)), np.empty((1, 12, 12))
    second = np.zeros((0, 6, 36)) if Q is None else Q.reshape(1, 6, 36)
    energy = beams(nodes(x1, q1, x2, q2), np.zeros(3), triads[None], e0[None], K[None], second, g, H)
    return energy, g[0], H[0]


def random_element(angle, seed=7):
    """Random placed element with relative rotation `angle`, a full stiffness, a curved rest shape."""
    rng = np.random.default_rng(seed)
    x1, q1 = rng.normal(size=3), spun(rng.normal(size=3), UNIT)
    axis = rng.normal(size=3)
    q2 = spun(angle * axis / np.linalg.norm(axis), q1)
    triads = np.array([spun(rng.normal(size=3), UNIT)] * 2)
    A = rng.normal(size=(6, 6))
    return x1, q1, x1 + rng.normal(size=3), q2, triads, 0.3 * rng.normal(size=6), A @ A.T


def random_second(seed=3):
    """Random second derivatives of a deformation, symmetric."""
    Q = np.random.default_rng(seed).normal(size=(6, 6, 6))
    return 0.3 * (Q + Q.swapaxes(1, 2))


@pytest.mark.parametrize("angle", [0.0, 1e-6, 0.05, 0.49, 0.51, 1.5, 2.5])
@pytest.mark.parametrize("Q", [None, random_second()], ids=["straight", "curved"])
def test_gradient_and_hessian(check_derivatives, angle, Q):
    x1, q1, x2, q2, triads, e0, K = random_element(angle)

    def energy(d):
        return one(x1 + d[:3], spun(d[3:6], q1), x2 + d[6:9], spun(d[9:], q2), triads, e0, K, Q)

    check_derivatives(energy, 12, h=1e-3)


@pytest.mark.parametrize("count", [1, 5, 8, 11])
@pytest.mark.parametrize("curved", [False, True])
def test_elements_side_by_side_are_as_each_alone(count, curved):
    """Hessians of eight are evaluated together, whatever their number."""
    rng = np.random.default_rng(count)
    state = np.concatenate([(*rng.normal(size=3), *spun(rng.normal(size=3), UNIT)) for _ in range(count + 1)])
    _, _, _, _, triads, e0, K = zip(*(random_element(1.0, seed) for seed in range(count)), strict=True)
    Q = np.stack([random_second(seed).reshape(6, 36) for seed in range(count)])[: count * curved]
    g, H = np.empty((count, 12)), np.empty((count, 12, 12))
    energy = beams(state, np.zeros(3), np.stack(triads), np.stack(e0), np.stack(K), Q, g, H)
    rows = state.reshape(-1, 7)
    alone = [
        one(*np.split(rows[n : n + 2].ravel(), (3, 7, 10)), triads[n], e0[n], K[n], Q[n] if curved else None)
        for n in range(count)
    ]
    assert energy == pytest.approx(sum(part[0] for part in alone), rel=1e-12)
    np.testing.assert_allclose(g, [part[1] for part in alone], rtol=1e-12, atol=1e-12)
    np.testing.assert_allclose(H, [part[2] for part in alone], rtol=1e-10, atol=1e-10)


@pytest.mark.parametrize("q", [0.2499999, 0.2500001])
def test_series_meets_closed_form(q):
    """Both sides of the switch agree with the neighbouring value to the slope between them."""
    a = 0.5 * np.sqrt(q)
    values = np.array(stretch_functions(q, a, np.sin(a), np.cos(a)))
    exact_c = (a / np.sin(a) - 1.0) / q
    exact_tau = np.tan(a / 2) / (2 * a)
    np.testing.assert_allclose(values[[0, 3]], [exact_c, exact_tau], rtol=1e-13)
    h = 1e-3
    for k in (0, 1, 3):
        sides = [
            stretch_functions(p, 0.5 * np.sqrt(p), np.sin(0.5 * np.sqrt(p)), np.cos(0.5 * np.sqrt(p)))[k]
            for p in (q - h, q + h)
        ]
        assert (sides[1] - sides[0]) / (2 * h) == pytest.approx(values[k + 1], rel=1e-5)


def test_rigid_motion_strains_nothing():
    x1, q1, x2, q2, triads, _, K = random_element(0.8)
    e = np.empty((1, 6))
    deformations(nodes(x1, q1, x2, q2), np.zeros(3), triads[None], e)
    spin, shift = np.array([0.3, -2.0, 0.9]), np.array([3.0, 1.0, -7.0])
    R = Rotation.from_rotvec(spin)
    moved = one(R.apply(x1) + shift, spun(spin, q1), R.apply(x2) + shift, spun(spin, q2), triads, e[0], K)
    assert moved[0] < 1e-25
    np.testing.assert_allclose(moved[1], 0.0, atol=1e-12)


def test_sign_of_quaternions_does_not_matter():
    x1, q1, x2, q2, triads, e0, K = random_element(0.8)
    np.testing.assert_allclose(
        one(x1, q1, x2, -q2, triads, e0, K)[1], one(x1, q1, x2, q2, triads, e0, K)[1], rtol=1e-12
    )


def test_forces_balance():
    x1, q1, x2, q2, triads, e0, K = random_element(1.1)
    _, g, _ = one(x1, q1, x2, q2, triads, e0, K)
    np.testing.assert_allclose(g[:3] + g[6:9], 0.0, atol=1e-12)
    moment = g[3:6] + g[9:] + np.cross(x1, g[:3]) + np.cross(x2, g[6:9])
    np.testing.assert_allclose(moment, 0.0, atol=1e-11)


def test_straight_element_is_exact_for_small_end_loads():
    """Cantilever of one element: L^3/(3 EI) + L/GA sideways, L/EA along, L/GJ in twist."""
    section = round_section(1.5, Material())
    L = 4.0
    K = straight_stiffness(section, np.array([L]))[0]
    e0 = np.array([L, 0.0, 0.0, 0.0, 0.0, 0.0])
    _, _, H = one(np.zeros(3), UNIT, np.array([L, 0.0, 0.0]), UNIT, np.array([UNIT, UNIT]), e0, K)
    flexibility = np.linalg.inv(H[6:, 6:])
    sideways = L**3 / (3 * section.EI) + L / section.GA
    expected = [L / section.EA, sideways, sideways, L / section.GJ, L / section.EI, L / section.EI]
    np.testing.assert_allclose(np.diag(flexibility), expected, rtol=1e-10)
    assert flexibility[1, 5] == pytest.approx(L**2 / (2 * section.EI))
