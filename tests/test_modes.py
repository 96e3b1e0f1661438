"""Natural frequencies against closed forms and the literature."""

import numpy as np
import pytest

import wirefe
from coilspring import InputError, Material, Spring
from coilspring.scene.wire import round_section
from wirefe.results.linear import tip_flexibility
from wirefe.results.vibration import consistent_mass, natural_frequencies

STEEL = 7.9e-9  # t/mm^3


def bar(elements, diameter=2.0, length=100.0):
    x = np.linspace(0.0, length, elements + 1)
    points = np.stack((0.6 * x, 0.0 * x, 0.8 * x), axis=-1)
    return wirefe.straight_rod(points, round_section(diameter, Material()))


@pytest.mark.parametrize("element", ["straight", "curved"])
def test_clamped_helical_spring(element):
    """Literature (Pearson 1982; Yildirim), not verified here. Measured 0.09 % at most."""
    radius, turns, slope = 5.0, 7.6, np.radians(8.5744)
    height = turns * 2.0 * np.pi * radius * np.tan(slope)
    spring = Spring(1.0, 2.0 * radius, turns, height, end_turns=0.0)
    phases = np.linspace(0.0, spring.phase_end, 609)
    section = round_section(1.0, Material(206000.0, 0.3))
    if element == "curved":
        rod = wirefe.curved_rod(spring, phases, section)
    else:
        rod = wirefe.straight_rod(spring.points(phases), section)
    found = natural_frequencies(rod.holding(0).holding(-1), STEEL, 1.0, 5)
    np.testing.assert_allclose(found, [393.5, 396.1, 462.8, 525.5, 863.9], rtol=2e-3)


def test_cantilever_bends_twists_and_stretches():
    """Closed forms: 1.8751^2 sqrt(EI / rho A L^4), sqrt(G/rho)/4L, sqrt(E/rho)/4L. Second order."""
    material = Material()
    wave, twist = (np.sqrt(m / STEEL) / 400.0 for m in (material.E, material.G))
    bending = 1.8751040687**2 * np.sqrt(material.E / STEEL * 0.25) / 1e4 / (2.0 * np.pi)
    errors = []
    for elements in (20, 40):
        found = natural_frequencies(bar(elements).holding(0), STEEL, 2.0, 16)
        np.testing.assert_allclose(found[:2], bending, rtol=1e-2)
        errors.append([np.abs(found / exact - 1.0).min() for exact in (twist, wave)])
    np.testing.assert_allclose(np.log2(np.array(errors[0]) / errors[1]), 2.0, atol=0.1)


def test_mass_of_rigid_motions():
    """Weight in every direction, and the moment of inertia about the bar's own axis."""
    M, volume = consistent_mass(bar(7), STEEL, 2.0), np.pi * 100.0
    shift = np.tile(np.eye(6), (8, 1))
    total = shift.T @ (M @ shift)
    np.testing.assert_allclose(total[:3, :3], STEEL * volume * np.eye(3), rtol=1e-12, atol=1e-18)
    axis = np.array([0.6, 0.0, 0.8])
    assert axis @ total[3:, 3:] @ axis == pytest.approx(STEEL * 100.0 * np.pi / 32.0 * 2.0**4)


def test_stiffness_at_rest_of_a_cantilever():
    """Tip flexibility L^3/(3 EI) + L/GA, exact for any number of elements."""
    section = round_section(2.0, Material())
    rod = bar(3)
    tip = tip_flexibility(rod, rod.points[-1])[1, 1]
    assert tip == pytest.approx(1e6 / (3.0 * section.EI) + 100.0 / section.GA, rel=1e-9)


@pytest.mark.parametrize(
    ("held", "density", "count", "words"),
    [
        (("ux", "uy", "uz"), STEEL, 3, "held against every rigid motion"),
        ((), 0.0, 3, "density must be a finite number in"),
        ((), STEEL, 0, "count must be an integer in"),
    ],
)
def test_bad_input(held, density, count, words):
    with pytest.raises(InputError, match=words):
        natural_frequencies(bar(4).holding(0, *held), density, 2.0, count)
