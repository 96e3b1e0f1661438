"""How gaps and tangential lengths of pairs change with a motion: exactly, in both models."""

from dataclasses import replace

import numpy as np
import pytest

import equivbeam
import wirefe
from coilspring import spring_b
from coilspring.compiling.packing import pack
from coilspring.contact.law import PAIR_HISTORY, rate_by_bound, tangential_law
from coilspring.contact.rates import GAP_RATE, LENGTH_RATE
from coilspring.solver.tangential.complementarity import eliminated
from equivbeam.solve import KERNELS as BEAM
from validation.study.partialsolve import partial_path
from wirefe.solve import KERNELS as WIRE

CASES = [(BEAM, "circles"), (WIRE, "spheres"), (WIRE, "wires")]
HELD = [("coulomb", 0.2), ("none", None)]


def held(kernels, geometry, sliding, friction):
    """Packed data, last state and history of Spring B with pairs that are held, and its shape."""
    scene = spring_b()
    where = "wires" if geometry == "wires" else "spheres"
    contact = replace(scene.contact, geometry=where, sliding=sliding, friction=friction)
    scene = replace(scene, contact=contact)
    if kernels is BEAM:
        path = partial_path(equivbeam.solve, scene, steps=4, sliding="scene")
    else:
        path = partial_path(wirefe.solve, scene, steps=4, element="curved", elements_per_turn=4)
    history = path.histories[-1].copy()
    assert history["closed"].sum() >= 4
    return pack(path.shape.data), path.states[-1].copy(), history, path.shape


def lengths(kernels, data, state, history, size):
    """Tangential lengths of all pairs, 0 of those that are not held, and their gradients."""
    out, gradients = np.zeros(len(history)), np.zeros((len(history), size))
    for m in np.flatnonzero(history["closed"]):
        out[m] = kernels.length_gradient(*data, state, history, m, gradients[m])
    return out, gradients


@pytest.mark.parametrize(("kernels", "geometry"), CASES, ids=[name for _, name in CASES])
@pytest.mark.parametrize(("sliding", "friction"), HELD)
def test_rates_are_those_of_small_motions(kernels, geometry, sliding, friction):
    data, state, history, shape = held(kernels, geometry, sliding, friction)
    size = len(state) - 3 if kernels is BEAM else 6 * (len(state) // 7)
    motion = np.random.default_rng(3).normal(size=size)
    if kernels is BEAM:
        motion[-3:] *= 1.0 - shape.data.fixed
    else:
        motion[shape.data.held.dof] = 0.0
    rates, closed = np.zeros((len(history), 2)), history["closed"]
    kernels.pair_rates(*data, state, motion, history, rates)
    ends = []
    for way in (1e-8, -1e-8):
        moved = state.copy()
        kernels.retract(*data, state, motion, way, state, 0.0, moved)
        ends.append((shape.pair_gaps(moved[None])[0], lengths(kernels, data, moved, history, size)[0]))
    gaps, ways = ((ahead - back) / 2e-8 for ahead, back in zip(*ends, strict=True))
    np.testing.assert_allclose(rates[closed, GAP_RATE], gaps[closed], atol=1e-6 * np.abs(gaps).max())
    np.testing.assert_allclose(rates[closed, LENGTH_RATE], ways[closed], atol=1e-5 * np.abs(ways).max())
    _, gradients = lengths(kernels, data, state, history, size)
    np.testing.assert_allclose(
        gradients @ motion, rates[:, LENGTH_RATE] * closed, atol=1e-12 * np.abs(ways).max()
    )


@pytest.mark.parametrize("rise", [0.0, 0.3, -0.2])
def test_the_force_of_a_pair_that_slides_changes_with_its_bound(rise):
    row = np.zeros(1, PAIR_HISTORY).view(np.recarray)[0]
    row.stiffness, row.bound, row.rise = 50.0, 2.0, rise

    def force(bound):
        row.bound = bound
        return tangential_law(0.3, row)[1]

    differences = (force(2.0 + 1e-6) - force(2.0 - 1e-6)) / 2e-6
    row.bound = 2.0
    assert rate_by_bound(0.3, row) == pytest.approx(differences, rel=1e-8)


@pytest.mark.parametrize("n", [1, 2, 7, 40])
def test_a_system_is_eliminated_with_the_sign_of_its_determinant(n):
    draw = np.random.default_rng(n)
    for _ in range(10):
        A, b = draw.normal(size=(n, n)), draw.normal(size=n)
        M = np.column_stack((A, b))
        assert eliminated(M) == np.linalg.slogdet(A)[0]
        np.testing.assert_allclose(M[:, n], np.linalg.solve(A, b), rtol=1e-8, atol=1e-10)
    M = np.zeros((n, n + 1))
    assert eliminated(M) == 0
