"""Springs as uniform helices: Love's large axial deflection, and the linear flexibilities."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.sparse.linalg import spsolve

import wirefe
from coilspring import Material, spring_a
from coilspring.scene.wire import Section, round_section
from wirefe.results.vibration import linear_stiffness

SPRING = replace(spring_a().spring, end_turns=0.0)
ROUND = round_section(1.5, Material())
WIRE = np.hypot(2.0 * np.pi * 5.0 * 14.5, 28.6)  # length of Spring A's wire
TURNS = 3  # of the 14.5: a uniform helix is the same in each, and this one does not buckle


def love(height, twisting):
    """Axial force, couple, radius, curvature and torsion of Spring A's wire at a height, inextensible.

    `twisting`: "held", the ends do not turn about the axis; "free", no couple.
    """

    def strains(sine, cosine, radius):
        return cosine**2 / radius, sine * cosine / radius

    sine0, sine = 28.6 / WIRE, height / WIRE
    cosine0, cosine = np.sqrt(1.0 - sine0**2), np.sqrt(1.0 - sine**2)
    kappa0, tau0 = strains(sine0, cosine0, 5.0)
    if twisting == "held":
        radius = 5.0 * cosine / cosine0
    else:  # GJ (tau - tau0) sin a + EI (kappa - kappa0) cos a = 0 is linear in 1/r
        GJ, EI = ROUND.GJ, ROUND.EI
        radius = (GJ * sine**2 * cosine + EI * cosine**3) / (GJ * tau0 * sine + EI * kappa0 * cosine)
    kappa, tau = strains(sine, cosine, radius)
    twist, bend = ROUND.GJ * (tau - tau0), ROUND.EI * (kappa - kappa0)
    force = (twist * cosine - bend * sine) / radius
    return force, twist * sine + bend * cosine, radius, kappa, tau


@pytest.mark.parametrize(("height", "twisting", "force", "radius"), [
    (25.6, "held", -10.357185, 5.001959),
    (25.6, "free", -10.353258, 5.002493),
    (21.75, "held", -23.627298, None),
    (21.75, "free", -23.614489, None),
])  # fmt: skip
def test_large_axial_deflection(height, twisting, force, radius):
    """Love/Thwaites, exact: the wrench gives the height and the radius. Measured 2e-6 of the deflection.

    The wrench acts on the axis of the deformed helix, found from the clamped frame; EA and GA are large.
    """
    found, couple, r, kappa, tau = love(height, twisting)
    assert found == pytest.approx(force, abs=1e-6)
    assert radius is None or r == pytest.approx(radius, abs=1e-6)
    stiff = Section(EA=1e9, GA=1e9, GJ=ROUND.GJ, EI=ROUND.EI)
    rod = wirefe.curved_rod(SPRING, np.linspace(0.0, 2.0 * np.pi * TURNS, 16 * TURNS + 1), stiff)
    first, second = SPRING.derivatives(np.zeros(1))
    t, b = first[0] / np.linalg.norm(first), np.cross(first[0], second[0])
    b /= np.linalg.norm(b)
    n = np.cross(b, t)
    # the project's helix is left-handed: its torsion is negative in Frenet's frame
    axis = (tau * t - kappa * b) / np.hypot(tau, kappa)
    foot = rod.points[0] + r * n
    length = WIRE * TURNS / 14.5
    angle = -np.hypot(tau, kappa) * length
    arm = -r * n
    arm = arm * np.cos(angle) + np.cross(axis, arm) * np.sin(angle)
    tip = foot + arm + axis * height * TURNS / 14.5
    moment = -couple * axis - np.cross(arm, found * axis)
    path = wirefe.solve_rod(rod.holding(0).loaded(-1, tuple(found * axis), tuple(moment)), steps=2)
    reached = path.positions[-1, -1]
    assert np.abs(reached - tip).max() <= 3e-6 * (28.6 - height)


def flexibility():
    """Compliance (2, 2) of Spring A's wire, clamped below, to an axial force and couple on the axis."""
    rod = wirefe.curved_rod(SPRING, np.linspace(0.0, SPRING.phase_end, 233), ROUND)
    arm = np.array([0.0, 28.6, 0.0]) - rod.points[-1]
    wrenches = np.zeros((rod.held.size - 6, 2))
    up = np.array([0.0, 1.0, 0.0])
    wrenches[-6:, 0] = *up, *np.cross(arm, up)
    wrenches[-2, 1] = 1.0
    K = linear_stiffness(rod)[6:, 6:].tocsc()
    return wrenches.T @ spsolve(K, wrenches)


def test_rate_with_pitch_and_shear():
    """c11, c12, c22 of rod theory (classical), and the rates 3.411569 (free to twist), 3.412482 (held)."""
    c = flexibility()
    length, R, a, w = WIRE, 5.0, np.arcsin(28.6 / WIRE), ROUND
    cos, sin = np.cos(a), np.sin(a)
    c11 = length * R**2 * (cos**2 / w.GJ + sin**2 / w.EI) + length * (cos**2 / w.GA + sin**2 / w.EA)
    c12 = length * R * sin * cos * (1.0 / w.GJ - 1.0 / w.EI)
    c22 = length * (sin**2 / w.GJ + cos**2 / w.EI)
    np.testing.assert_allclose(np.abs(c), [[c11, c12], [c12, c22]], rtol=1e-7)
    assert 1.0 / c[0, 0] == pytest.approx(3.411569, abs=1e-6)
    assert 1.0 / (c[0, 0] - c[0, 1] ** 2 / c[1, 1]) == pytest.approx(3.412482, abs=1e-6)
