"""Verification cases of the wire model on rods that are not springs: G1 to G5, G8, G10 and G11.

The moment that coils the rod of G8 turns with its end. It has no potential, while the path follower follows
minima of an energy: here plain Newton drives the kernels, with the exact, unsymmetric tangent.
"""

from functools import partial
from typing import NamedTuple

import numpy as np

import wirefe
from coilspring import EquilibriumNotFound
from coilspring.compiling.packing import pack
from coilspring.scene.wire import Section
from coilspring.solver.problem import Problem
from validation.verification.case import VerificationCase
from wirefe import kernels
from wirefe.contact.stations import turned_rows as turned
from wirefe.solve import rod_problem

RADIUS, HEIGHT, COILS = 10.0, 50.0, 2  # of the helix of G8
FIRST_STEP, LEAST_STEP = 1e-3, 1e-9  # of its moment
MOST_ITERATIONS = 12
CONVERGED = 1e-9  # of the helix radius
LEE, ARCH = 3.0, 1000.0  # loads of Lee's frame and of the arch


class CircularArc(NamedTuple):
    """Circular arc in a plane: `radius` times (cos, sin) of the angle, along two axes."""

    radius: float
    first: tuple[float, float, float]
    second: tuple[float, float, float]

    def points(self, phi: np.ndarray) -> np.ndarray:
        """Points at the angles `phi`."""
        c, s = np.cos(phi)[:, None], np.sin(phi)[:, None]
        return self.radius * (c * np.array(self.first) + s * np.array(self.second))

    def derivatives(self, phi: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """First and second derivative."""
        return self.points(phi + 0.5 * np.pi), -self.points(phi)


def line(length: float, elements: int) -> np.ndarray:
    """Points along X."""
    x = np.linspace(0.0, length, elements + 1)
    return np.stack((x, 0.0 * x, 0.0 * x), axis=-1)


def tip(rod: wirefe.Rod, steps: int = 2) -> np.ndarray:
    """Displacement of the last node at full load."""
    return wirefe.solve_rod(rod, steps=steps).displacements(-1)[-1]


def critical_load(rod: wirefe.Rod, load: float) -> float:
    """Load at the first critical point; the rod carries `load` at time 1."""
    try:
        wirefe.solve_rod(rod, steps=5)
    except EquilibriumNotFound as found:
        return load * (found.critical_time or np.nan)
    return float("nan")


def bend(elements: int, force: float) -> np.ndarray:
    """Tip of a 45 degree bend under a force out of its plane."""
    section = Section(1e7, 5e6 * 5 / 6, 5e6 / 6, 1e7 / 12)
    arc = CircularArc(100.0, (-1.0, 0.0, 0.0), (0.0, 1.0, 0.0))
    rod = wirefe.curved_rod(arc, np.linspace(0.0, np.pi / 4, elements + 1), section).holding(0)
    return tip(rod.loaded(-1, force=(0.0, 0.0, force)), steps=4)


def rolling(elements: int) -> wirefe.Rod:
    """Straight rod that a moment closes to a circle."""
    rod = wirefe.straight_rod(line(10.0, elements), Section(1e4, 1e4, 100.0, 100.0)).holding(0).in_plane()
    return rod.loaded(-1, moment=(0.0, 0.0, 20 * np.pi))


def unrolling(elements: int) -> wirefe.Rod:
    """Circle that a moment straightens."""
    arc = CircularArc(10.0 / (2 * np.pi), (0.0, -1.0, 0.0), (1.0, 0.0, 0.0))
    phases, section = np.linspace(0.0, 2 * np.pi, elements + 1), Section(1200.0, 500.0, 100.0, 100.0)
    rod = wirefe.curved_rod(arc, phases, section).holding(0).in_plane()
    return rod.loaded(-1, moment=(0.0, 0.0, -20 * np.pi))


def cantilever(elements: int, length: float, section: Section, force: float) -> np.ndarray:
    """Tip (UX, UY) of a straight cantilever under a lateral force."""
    rod = wirefe.straight_rod(line(length, elements), section).holding(0).in_plane()
    return tip(rod.loaded(-1, force=(0.0, force, 0.0)))[:2]


def shear_flexible(elements: int, force: float = 5e8) -> np.ndarray:
    """Tip of a thick cantilever under a force times the cube of its height."""
    h, b, nu, young = 0.5, 0.1, 0.3, 2.07e11
    shear = young / (2 * (1 + nu)) * h * b * 10 * (1 + nu) / (12 + 11 * nu)
    section = Section(young * h * b, shear, 1e8, young * b * h**3 / 12)
    return cantilever(elements, 2.0, section, -force * h**3)


def lees_frame(elements: int) -> wirefe.Rod:
    """Lee's frame under more than its first limit load."""
    n, young, area, inertia = elements // 2, 720.0, 6.0, 2.0
    column = line(120.0, n)[:, [1, 0, 2]]
    beam = line(120.0, n) + np.array([0.0, 120.0, 0.0])
    section = Section(young * area, young / 2.6 * area * 5 / 6, 1e3, young * inertia)
    rod = wirefe.straight_rod(np.concatenate((column, beam[1:])), section).in_plane()
    rod = rod.holding(0, "ux", "uy").holding(2 * n, "ux", "uy")
    return rod.loaded(n + n // 5, force=(0.0, -LEE, 0.0))


def arch(elements: int) -> wirefe.Rod:
    """Arch under more than its critical load, clamped at one end and hinged at the other.

    Its angle is the one that fits the published load: with 145 degrees there is no critical load.
    """
    half, arc = np.radians(215.0) / 2, CircularArc(100.0, (0.0, 1.0, 0.0), (1.0, 0.0, 0.0))
    phases = np.linspace(-half, half, elements + 1)
    rod = wirefe.curved_rod(arc, phases, Section(1e8, 1e8, 1e6, 1e6)).in_plane()
    rod = rod.holding(0).holding(elements, "ux", "uy")
    return rod.loaded(elements // 2, force=(0.0, -ARCH, 0.0))


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
    moment = RADIUS * angle**2 / length**2 * np.array([c * section.GJ, 0.0, section.EI])
    rod = wirefe.straight_rod(line(length, elements), section).holding(0)
    return rod.loaded(elements, moment=tuple(moment)), moment


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
    """Radius and height of the helix at full moment; by plain Newton, in steps as long as it bears."""
    rod, moment = helix_rod(slenderness, elements)
    problem = rod_problem(rod)
    state, time, step = problem.start, 0.0, FIRST_STEP
    while time < 1.0:
        found = newton(problem, state, min(time + step, 1.0) * moment)
        if found is not None:
            state, time, step = found, min(time + step, 1.0), 1.5 * step
            continue
        step *= 0.5
        if step < LEAST_STEP:
            raise ArithmeticError(f"no equilibrium beyond {time:g} of the moment")
    points = state.reshape(-1, 7)[:, :3]
    inward = np.diff(points, 2, axis=0)  # to the axis
    axis = np.cross(inward[0], inward[1])
    axis /= np.linalg.norm(axis)
    chord = points[1] - points[0]
    # the square of the chord of the circle over the second difference
    radius = (chord @ chord - (chord @ axis) ** 2) / np.linalg.norm(inward[0])
    return float(radius), abs(float((points[-1] - points[0]) @ axis))


BENDS = {
    300.0: (-7.04464, -11.93178, 40.19239),
    450.0: (-10.78126, -18.47242, 48.50349),
    600.0: (-13.60463, -23.56058, 53.47548),
}
ELASTICAS = {
    1.0: (-0.05643324, 0.30172077),
    2.0: (-0.16064172, 0.49345748),
    5.0: (-0.38762836, 0.71379152),
    10.0: (-0.55499560, 0.81060902),
}
CASES = (
    *(
        VerificationCase(
            "G1, 45 degree bend", f"P = {force:g}, 8 curved elements", target, "own (shooting), GJ = G 2I",
            3e-5, "published tips differ by 1 % with the torsion constant used", partial(bend, force=force),
            mesh=8, meshes=(4, 8, 16), fine=64,
        )
        for force, target in BENDS.items()
    ),
    VerificationCase(
        "G2, roll-up", "M = 2 pi EI/L, 8 straight elements", (-10.0, 0.0, 0.0), "exact", 1e-9,
        "pure bending: nothing of shear and stretch", lambda count: tip(rolling(count)), mesh=8,
    ),
    VerificationCase(
        "G3, unrolling a circle", "M = 2 pi EI/L, 4 curved elements", (10.0, 0.0, 0.0), "exact", 1e-9,
        "pure bending", lambda count: tip(unrolling(count)), mesh=4,
    ),
    VerificationCase(
        "G4, shear-flexible cantilever", "F = 5e8 h^3, 64 straight elements", (-0.15097114, -0.71056860),
        "published (Nachbagauer 2011)", 2e-6, "in a plane", shear_flexible, mesh=64, meshes=(8, 16, 32),
        components=1,
    ),
    *(
        VerificationCase(
            "G5, elastica", f"P L^2/EI = {load:g}, 64 straight elements", target,
            "exact (elliptic integrals; Mattiasson 1981)", 1.5e-7, "in a plane, inextensible",
            partial(cantilever, length=1.0, section=Section(1e8, 1e8, 1.0, 1.0), force=load), mesh=64,
            meshes=(4, 8, 16), components=1,
        )
        for load, target in ELASTICAS.items()
    ),
    VerificationCase(
        "G10, Lee's frame", "first limit load, 80 straight elements", (1.85445,), "own (shooting)", 1e-5,
        "the path beyond the limit point", lambda count: (critical_load(lees_frame(count), LEE),), mesh=80,
    ),
    VerificationCase(
        "G11, hinged-clamped arch of 215 degrees", "critical load, 20 curved elements", (897.3,),
        "literature (20 curved 3-node elements), not verified here", 1e-3,
        "the angle, which is the one that fits this load", lambda count: (critical_load(arch(count), ARCH),),
        mesh=20,
    ),
    *(
        VerificationCase(
            "G8, straight rod to helix", f"slenderness {slenderness:g}, 16 straight elements; radius, height",
            (RADIUS, HEIGHT), "exact (Herrmann & Harsch 2025)", 1e-8,
            "end moment alone; plain Newton with the unsymmetric tangent, not the path follower",
            partial(coiled_to, slenderness=slenderness), mesh=16,
        )
        for slenderness in (1e1, 1e2, 1e3, 1e4)
    ),
)  # fmt: skip
