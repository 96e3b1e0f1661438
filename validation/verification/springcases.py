"""Verification cases of the wire model on springs."""

import math
from collections.abc import Iterator
from dataclasses import replace
from functools import partial
from typing import Any, NamedTuple

import numpy as np

import wirefe
from coilspring import Contact, Load, Material, Scene, Spring, load_scene, spring_a, spring_b
from coilspring.scene.wire import Section, round_section
from validation.study.cases import EXACT_ROD
from validation.verification.case import VerificationCase
from wirefe.results.linear import tip_flexibility

ROUND = round_section(1.5, Material())
HELIX = replace(spring_a().spring, end_turns=0.0)
TURN = np.hypot(10.0 * np.pi, HELIX.pitch)  # length of a turn of Spring A's wire
WRENCH_LOAD = (0.0, -19.998380153, 0.254541242), (0.42943653, 1.27390492, 100.08607929)  # force, moment
SLOPE = math.radians(8.5744)
PEARSON = Scene(  # Pearson (1982), Mottershead (1980) and others: d 1, R 5, n 7.6, rho 7900
    "pearson",
    Spring(1.0, (10.0, 10.0), 7.6, 7.6 * 10.0 * math.pi * math.tan(SLOPE), end_turns=0.0),
    Load((0.0, -1e-6), 1),
    Material.from_moduli(206000.0, 79300.0, 7900.0),
    contact=Contact(enabled=False),
)
PEARSON_HZ = (393.5, 396.1, 462.8, 525.5, 863.9)
# Elements a turn with tolerances: straight elements from 0.75 % at 40, falling with the square; coarser ones
# do not, yet.
MESHES = {
    "straight": {n: 7.5e-3 * (40 / n) ** 2 for n in (16, 40, 80, 160)},
    "curved": {4: 1e-3, 16: 1e-5, 40: 3e-6, 80: 1e-6, 160: 1e-6},
}
TARGET_DIGITS = 1e-6  # errors below say nothing of an order


def wrench(elements: int) -> np.ndarray:
    """Tip of 3 turns of Spring A's wire under a wrench that leaves it a uniform helix."""
    rod = wirefe.curved_rod(HELIX, np.linspace(0.0, 6 * np.pi, 3 * elements + 1), ROUND).holding(0)
    return wirefe.solve_rod(rod.loaded(-1, *WRENCH_LOAD), steps=2).displacements(-1)[-1]


def spring_tip(elements: int, name: str, element: str) -> np.ndarray:
    """Tip of a spring of the catalogue at full load."""
    return wirefe.solve(load_scene(name), steps=5, element=element, elements_per_turn=elements).tips[-1]


def exact_rods() -> Iterator[dict[str, Any]]:
    """G13, solved: the order is computed from mesh to mesh."""
    for name, tips in EXACT_ROD.items():
        for element, meshes in MESHES.items():
            coarse, error = 0, 0.0
            for count, tolerance in meshes.items():
                found = VerificationCase(
                    f"G13, {name}", f"{count} {element} elements per turn; UX, UY, ROTZ", tips[1.0],
                    "own (shooting)", tolerance, "contact; the assumed material",
                    partial(spring_tip, name=name, element=element), mesh=count,
                ).checked()  # fmt: skip
                if coarse and found["error"] > TARGET_DIGITS:
                    found["order"] = np.log(error / found["error"]) / np.log(count / coarse)
                yield found
                coarse, error = count, found["error"]


class LoveHelix(NamedTuple):
    """Spring A's wire, inextensible, as a helix of another height: 3 of 14.5 turns, the first end clamped.

    All turns are alike, and 3 do not buckle.
    """

    force: float  # at the last point along the axis, N
    moment: np.ndarray  # (3,) there, N mm
    axis: np.ndarray  # (3,) of the deformed helix
    radius: float  # mm
    chord: np.ndarray  # (3,) from the first point to the last, mm


def love(elements: int, height: float) -> tuple[float]:
    """Height of 14.5 turns, ends held, under the exact wrench for a height."""
    exact = love_helix(height)
    return (float(love_chord(elements, exact) @ exact.axis) * 14.5 / 3.0,)


def love_chord(elements: int, exact: LoveHelix) -> np.ndarray:
    """From the first point of the wire to the last, under the wrench of an exact helix."""
    phases, section = np.linspace(0.0, 6.0 * np.pi, 3 * elements + 1), Section(1e9, 1e9, ROUND.GJ, ROUND.EI)
    rod = wirefe.curved_rod(HELIX, phases, section).holding(0)
    path = wirefe.solve_rod(rod.loaded(-1, tuple(exact.force * exact.axis), tuple(exact.moment)), steps=2)
    return path.positions[-1, -1] - rod.points[0]


def love_helix(height: float, radius: float | None = None) -> LoveHelix:
    """Helix of a height of 14.5 turns, by Love; without a radius the ends do not turn about the axis."""
    sine0, sine = HELIX.pitch / TURN, height / 14.5 / TURN
    cosine0, cosine = np.sqrt(1.0 - sine0**2), np.sqrt(1.0 - sine**2)
    radius = 5.0 * cosine / cosine0 if radius is None else radius
    kappa, tau = cosine**2 / radius, sine * cosine / radius
    twist = ROUND.GJ * (tau - sine0 * cosine0 / 5.0)
    bend = ROUND.EI * (kappa - cosine0**2 / 5.0)
    force, couple = (twist * cosine - bend * sine) / radius, twist * sine + bend * cosine
    first, second = (vectors[0] for vectors in HELIX.derivatives(np.zeros(1)))
    t, b = first / np.linalg.norm(first), np.cross(first, second)
    b /= np.linalg.norm(b)
    axis = (tau * t - kappa * b) / np.hypot(tau, kappa)  # left-handed: negative torsion
    angle, start = -np.hypot(tau, kappa) * 3.0 * TURN, -radius * np.cross(b, t)
    arm = start * np.cos(angle) + np.cross(axis, start) * np.sin(angle)
    moment = -couple * axis - np.cross(arm, force * axis)
    return LoveHelix(force, moment, axis, radius, arm - start + 3.0 * height / 14.5 * axis)


def rates(elements: int) -> tuple[float, float]:
    """Axial rates of the linear helix, free to twist and held, N/mm."""
    phases = np.linspace(0.0, HELIX.phase_end, round(HELIX.active_coils * elements) + 1)
    c = axial_flexibility(wirefe.curved_rod(HELIX, phases, ROUND))
    return 1.0 / c[0, 0], 1.0 / (c[0, 0] - c[0, 1] ** 2 / c[1, 1])


def axial_flexibility(rod: wirefe.Rod) -> np.ndarray:
    """Linear flexibility (2, 2) of a helix to a force and a moment along its axis, the first end clamped."""
    return tip_flexibility(rod, rod.points[-1] * [0.0, 1.0, 0.0])[1::3, 1::3]


def frequencies(elements: int) -> np.ndarray:
    """Natural frequencies of a clamped spring, Hz."""
    return wirefe.frequencies(wirefe.solve(PEARSON, element="curved", elements_per_turn=elements), count=5)


def shortening_of_b(elements: int) -> tuple[float]:
    """Shortening of Spring B at 200 N, mm."""
    path = wirefe.solve(spring_b(), element="curved", elements_per_turn=elements)
    return (-float(path.tips[-1, 1]),)


WRENCH = VerificationCase(
    "G9, uniform helix under a wrench", "Spring A's wire, 3 turns, 16 curved elements per turn",
    (-4.6060339e-5, -1.2155943661, -0.0813165661), "exact, with shear and stretch", 3e-7,
    "uniform strains only", wrench, mesh=16, meshes=(4, 8),
)  # fmt: skip
OTHERS = (
    *(
        VerificationCase(
            "Love/Thwaites, large axial deflection", "Spring A's wire, ends held, "
            f"F = {love_helix(height).force:.6f} N; 3 turns of 16 curved elements; height of 14.5 turns",
            (height,), "exact (Love 1927), inextensible", 1e-6, "uniform strains only",
            partial(love, height=height), mesh=16,
        )
        for height in (25.6, 21.75)
    ),
    VerificationCase(
        "spring rate with pitch and shear", "Spring A's wire, free to twist and held; N/mm",
        (3.411569, 3.412482), "exact (classical rod theory)", 2.5e-7,
        "the curvature of the wire: see the end of this page", rates, mesh=16,
    ),
    VerificationCase(
        "natural frequencies", "clamped, 7.6 turns, 10 curved elements per turn; Hz",
        PEARSON_HZ, "literature (Pearson 1982; Yildirim), not verified here", 1e-3,
        "frequencies of a loaded spring, of coils that touch", frequencies, mesh=10, meshes=(10, 20),
        fine=80, components=5,
    ),
    VerificationCase(
        "Rodriguez-Paredes-Sartor, conical spring", "Spring B at 200 N, no sliding; mm", (15.245118,),
        "closed form (authors named, 2006), not verified here", 0.03,
        "the formula leaves out pitch, direct shear and discrete contact", shortening_of_b, mesh=16,
    ),
)  # fmt: skip
