"""Springs as uniform helices: Love's large axial deflection, and the linear flexibilities."""

import numpy as np
import pytest

import wirefe
from validation.verification.springcases import HELIX, ROUND, TURN, axial_flexibility, love_chord, love_helix


def free_radius(height):
    """Radius without a couple: GJ (tau - tau0) sin a + EI (kappa - kappa0) cos a = 0, linear in 1/r."""
    GJ, EI = ROUND.GJ, ROUND.EI
    sine0, sine = HELIX.pitch / TURN, height / 14.5 / TURN
    cosine0, cosine = np.sqrt(1.0 - sine0**2), np.sqrt(1.0 - sine**2)
    kappa0, tau0 = cosine0**2 / 5.0, sine0 * cosine0 / 5.0
    return (GJ * sine**2 * cosine + EI * cosine**3) / (GJ * tau0 * sine + EI * kappa0 * cosine)


@pytest.mark.parametrize(("height", "twisting", "force", "radius"), [
    (25.6, "held", -10.357185, 5.001959),
    (25.6, "free", -10.353258, 5.002493),
    (21.75, "held", -23.627298, None),
    (21.75, "free", -23.614489, None),
])  # fmt: skip
def test_large_axial_deflection(height, twisting, force, radius):
    """Love/Thwaites, exact: the wrench gives the height and the radius. Measured 2e-6 of the deflection."""
    exact = love_helix(height, None if twisting == "held" else free_radius(height))
    assert exact.force == pytest.approx(force, abs=1e-6)
    assert radius is None or exact.radius == pytest.approx(radius, abs=1e-6)
    assert np.abs(love_chord(16, exact) - exact.chord).max() <= 3e-6 * (28.6 - height)


def test_flexibility_with_pitch_and_shear():
    """c11, c12, c22 of rod theory (classical) for all of Spring A's wire."""
    c = axial_flexibility(wirefe.curved_rod(HELIX, np.linspace(0.0, HELIX.phase_end, 233), ROUND))
    length, R, a, w = 14.5 * TURN, 5.0, np.arcsin(HELIX.pitch / TURN), ROUND
    cos, sin = np.cos(a), np.sin(a)
    c11 = length * R**2 * (cos**2 / w.GJ + sin**2 / w.EI) + length * (cos**2 / w.GA + sin**2 / w.EA)
    c12 = length * R * sin * cos * (1.0 / w.GJ - 1.0 / w.EI)
    c22 = length * (sin**2 / w.GJ + cos**2 / w.EI)
    np.testing.assert_allclose(np.abs(c), [[c11, c12], [c12, c22]], rtol=1e-7)
