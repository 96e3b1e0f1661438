"""Curved elements to second order: their derivatives by a chain of short pieces, exact helices, the order."""

from dataclasses import replace

import numpy as np
import pytest

import wirefe
from coilspring import Contact, Load, Spring, spring_a, spring_b
from coilspring.scene import Supports
from validation.campaign.wire import WireForces
from validation.verification.springcases import love
from wirefe.element.curved import POINTS, UPTO, WEIGHTS
from wirefe.model import build_model

CONE = replace(spring_b(), spring=Spring(2.0, (24.0, 14.0), 5.0, 40.0))


@pytest.mark.parametrize("scene", [spring_a(), spring_b(), CONE], ids=["A", "B", "cone"])
@pytest.mark.parametrize("count", [4, 16])
def test_second_derivatives_are_those_of_a_chain_of_short_pieces(scene, count):
    """As the verifier finds them: it moves the end by one small twist after the other. Measured 2e-6."""
    elements = build_model(scene, count, 4, "curved")[0].elements
    known = WireForces(scene, "curved", count, 4)
    size = np.sqrt(np.einsum("eii->ei", elements.stiffness))  # of each deformation, by its energy
    off = elements.stiffness - np.moveaxis(known.stiffness, -1, 0)
    assert np.abs(off / (size[:, :, None] * size[:, None])).max() < 1e-9
    scale = size[:, :, None, None] / (size[:, None, :, None] * size[:, None, None, :])
    found, expected = elements.second.reshape(-1, 6, 6, 6), np.moveaxis(known.second, -1, 0)
    np.testing.assert_array_equal(found, found.swapaxes(2, 3))
    assert np.abs((found - expected) * scale).max() < 1e-5 * np.abs(expected * scale).max()


@pytest.mark.parametrize("power", range(8))
def test_integrals_up_to_each_point(power):
    np.testing.assert_allclose(
        UPTO @ (WEIGHTS * POINTS**power), POINTS ** (power + 1) / (power + 1), atol=1e-15
    )


def test_straight_elements_are_of_the_first_order():
    assert build_model(spring_a(), 40, 4)[0].elements.second.shape == (0, 6, 36)


def test_an_inextensible_helix_that_stays_one_is_exact_with_four_elements_a_turn():
    """Its strains are constant. With elements of the first order 4 a turn were 1e-7 off those of 64."""
    assert love(4, 25.6) == pytest.approx(love(64, 25.6), rel=1e-9)


@pytest.mark.parametrize("supports", [Supports(("ux",)), Supports(())], ids=["pinned", "free"])
def test_the_order_is_more_than_the_third_on_coarse_meshes(supports):
    """With elements of the first order 4 a turn erred by 1.5e-2 where the top is pinned."""
    spring = replace(spring_b().spring, active_coils=5.0, active_height=40.0)
    scene = replace(
        spring_b(),
        spring=spring,
        supports=supports,
        load=Load((0.0, -60.0), 1),
        contact=Contact(enabled=False),
    )
    tips = [
        wirefe.solve(scene, element="curved", elements_per_turn=count).tips[-1, 2] for count in (4, 8, 64)
    ]
    coarse, finer = (abs(tip / tips[-1] - 1.0) for tip in tips[:2])
    assert coarse < 1e-3
    assert np.log2(coarse / finer) > 3.0


def test_relative_errors_fall_with_the_square_of_the_load():
    """With elements of the first order they fell in proportion to it."""
    spring = replace(spring_b().spring, active_coils=5.0, active_height=40.0)
    errors = []
    for force in (-3.0, -9.0):
        load, off = Load((0.0, force), 1), Contact(enabled=False)
        scene = replace(spring_b(), spring=spring, supports=Supports(("ux",)), load=load, contact=off)
        coarse, fine = (
            wirefe.solve(scene, element="curved", elements_per_turn=count).tips[-1, 2] for count in (4, 64)
        )
        errors.append(abs(coarse / fine - 1.0))
    assert np.log(errors[1] / errors[0]) / np.log(3.0) == pytest.approx(2.0, abs=0.2)
