"""G8 of the verification cases: a straight rod coiled to a helix by a moment that turns with its end.

Such a moment has no potential, so that the path follower, which follows minima of an energy, is not for it.
Here the wire model's kernels are driven by plain Newton with the exact, unsymmetric tangent.
"""

from __future__ import annotations

from functools import partial

import numpy as np

import wirefe
from coilspring.compiling.packing import pack
from coilspring.scene.wire import Section
from coilspring.solver.solve import Problem
from validation.verification.case import Case
from wirefe import kernels
from wirefe.solve import rod_problem
from wirefe.stations import turned_rows as turned

RADIUS, HEIGHT, COILS = 10.0, 50.0, 2
FIRST_STEP, LEAST_STEP = 1e-3, 1e-9
MOST_ITERATIONS = 12
CONVERGED = 1e-9  # of the helix radius


def helix_rod(slenderness: float, elements: int) -> tuple[wirefe.Rod, np.ndarray]:
    """Straight rod along X, clamped, and the body moment that coils it (Herrmann & Harsch 2025).

    E = 1 and G = 1/2; a circular section whose diameter is the length over the slenderness.
    """
    angle = 2.0 * np.pi * COILS
    c = HEIGHT / (angle * RADIUS)
    length = RADIUS * np.sqrt(1.0 + c * c) * angle
    d = length / slenderness
    area, inertia = np.pi * d**2 / 4, np.pi * d**4 / 64
    section = Section(EA=area, GA=0.5 * area, GJ=0.5 * 2 * inertia, EI=inertia)
    x = np.linspace(0.0, length, elements + 1)
    points = np.stack((x, 0.0 * x, 0.0 * x), axis=-1)
    moment = RADIUS * angle**2 / length**2 * np.array([c * section.GJ, 0.0, section.EI])
    rod = wirefe.straight_rod(points, section).holding(0)
    return rod.loaded(elements, moment=tuple(moment)), moment


def coiled(problem: Problem, moment: np.ndarray) -> np.ndarray:
    """State, shape (nodes, 7), at full moment; by plain Newton, in steps as long as it bears."""
    state, time, step = problem.start, 0.0, FIRST_STEP
    while time < 1.0:
        found = newton(problem, state, min(time + step, 1.0) * moment)
        if found is None:
            step *= 0.5
            if step < LEAST_STEP:
                raise ArithmeticError(f"no equilibrium beyond {time:g} of the moment")
        else:
            state, time, step = found, min(time + step, 1.0), 1.5 * step
    return state.reshape(-1, 7)


def newton(problem: Problem, start: np.ndarray, moment: np.ndarray) -> np.ndarray | None:
    """Equilibrium under a body moment at the last node, or None where the iteration does not converge."""
    reals, ints = pack(problem.data)
    size = len(problem.load)
    state, trial = start.copy(), start.copy()
    g, H = np.empty(size), np.empty(problem.matrix_size)
    columns = np.zeros((3, size))
    columns[:, -3:] = np.eye(3)
    for _ in range(MOST_ITERATIONS):
        kernels.assemble(reals, ints, state, 0.0, problem.history, state, g, H)
        inner, outer = g[-3:].copy(), turned(state[-4:], moment)
        g[-3:] -= outer
        kernels.factor(reals, ints, H)
        solved = np.concatenate((-g[None], columns))
        for b in solved:
            kernels.solve(reals, ints, H, b)
        # the matrix is symmetric along the exponential map: the end's own moment lacks half of its turning,
        # the load all of it; both are put in by Woodbury's formula
        extra = np.cross(outer - 0.5 * inner, np.eye(3), axisa=0, axisb=0, axisc=0)
        response = solved[1:, -3:].T
        share = np.linalg.solve(np.eye(3) + extra @ response, extra @ solved[0, -3:])
        step = solved[0] - share @ solved[1:]
        kernels.retract(reals, ints, state, step, 1.0, state, 0.0, trial)
        state[:] = trial
        if np.abs(step).max() < CONVERGED * RADIUS:
            return state
    return None


def coiled_to(elements: int, slenderness: float) -> tuple[float, float]:
    """Radius and height of the helix."""
    rod, moment = helix_rod(slenderness, elements)
    return measured(coiled(rod_problem(rod), moment)[:, :3])


def measured(points: np.ndarray) -> tuple[float, float]:
    """Radius and height of a helix from points at equal distances along it."""
    # second differences of a helix point to its axis
    inward = points[2:] - 2 * points[1:-1] + points[:-2]
    axis = np.cross(inward[0], inward[1])
    axis /= np.linalg.norm(axis)
    height = abs(float((points[-1] - points[0]) @ axis))
    flat = points - np.outer(points @ axis, axis)
    # circle through three of them
    a, b = flat[1] - flat[0], flat[2] - flat[0]
    doubled = np.linalg.norm(np.cross(a, b))
    return float(np.linalg.norm(a) * np.linalg.norm(b) * np.linalg.norm(a - b) / (2.0 * doubled)), height


CASES = tuple(
    Case(
        "G8, straight rod to helix", f"slenderness {slenderness:g}, 16 straight elements; radius, height",
        (RADIUS, HEIGHT), "exact (Herrmann & Harsch 2025)", 1e-8,
        "end moment alone; plain Newton with the unsymmetric tangent, not the path follower",
        partial(coiled_to, slenderness=slenderness), mesh=16,
    )
    for slenderness in (1e1, 1e2, 1e3, 1e4)
)  # fmt: skip
