"""Energy balance along the path and equilibrium of the whole body."""

from dataclasses import replace

import numpy as np
import pytest

import wirefe
from coilspring import Contact, Load, load_scene, spring_a, spring_b
from wirefe.model import ROW
from wirestates import add, centres, elements

# Spring B slides off its coils at 130 N: what is balanced stays below.
SCENES = {
    "A": spring_a(),
    "A without contact": load_scene("spring-a-no-contact"),
    "B frictionless": replace(spring_b(), contact=Contact(geometry="spheres"), load=Load((0.0, -120.0))),
}


def stored_energy(path):
    contact = path.shape.data.contact
    strain = elements(path, -1)[1]
    return (
        strain
        + (path.shape.pair_stiffness * path.penetrations[-1] ** (contact.k + 1) / (contact.k + 1)).sum()
    )


def work_of_the_load(path):
    """Trapezoid over the steps."""
    loads, moves = (np.vstack((np.zeros(2), rows)) for rows in (path.loads, path.tips[:, :2]))
    return (0.5 * (loads[1:] + loads[:-1]) * np.diff(moves, axis=0)).sum()


def defect(scene, steps):
    path = wirefe.solve(scene, steps=steps, element="curved", elements_per_turn=8)
    return work_of_the_load(path) / stored_energy(path) - 1.0


@pytest.mark.parametrize("name", SCENES)
def test_work_is_stored(name):
    """The defect is the trapezoid's: it falls with the square of the step, closing contacts scatter it.

    Measured: orders 1.7 to 2.8 with contact, 2.000 without; 5e-8, after extrapolation 8e-9, at 1600 steps.
    """
    scene = SCENES[name]
    defects = np.array([defect(scene, steps) for steps in (25, 50, 100)])
    overall = 0.5 * np.log2(defects[0] / defects[2])
    assert overall == pytest.approx(2.0, abs=0.01 if name == "A without contact" else 0.5)
    coarse, fine = defect(scene, 800), defect(scene, 1600)
    assert abs(fine) <= 1e-6
    assert abs(4.0 * fine - coarse) / 3.0 <= 2e-8


@pytest.mark.parametrize("name", SCENES)
def test_whole_body_is_in_equilibrium(name):
    """Reactions of both rigid ends, from the end elements and from pairs that touch an end.

    All six components between the ends; at the top the loaded dofs carry the load.
    """
    path = wirefe.solve(SCENES[name], steps=10)
    data, rows = path.shape.data.contact, path.states[-1].reshape(-1, ROW)
    points, _, g = elements(path, -1)
    places = centres(data, path.states[-1])
    reactions = np.zeros((2, 6))
    for side, node, point, end in ((0, 0, points[0], g[0, :6]), (1, len(rows) - 1, points[-1], g[-1, 6:])):
        add(reactions[side], end[:3], point, end[3:])
        for (A, B), force in zip(data.pairs, path.contact_forces[-1], strict=True):
            way = places[B] - places[A]
            push = force * way / np.linalg.norm(way)
            if data.attached[A] == node:
                add(reactions[side], push, places[A])
            if data.attached[B] == node:
                add(reactions[side], -push, places[B])
    force = np.array([*path.loads[-1], 0.0])
    scale = np.linalg.norm(force) * np.array([1.0] * 3 + [10.0] * 3)
    assert (np.abs(reactions.sum(axis=0)) <= 1e-8 * scale).all()
    top = np.zeros(6)
    add(top, force, rows[-1, :3])
    carried = np.abs(reactions[1] - top) <= 1e-8 * scale
    assert carried[1]
    assert carried[[0, 5]].all() or "ux" in path.scene.supports.top_held
