"""Flexibility of a coiled round wire by three-dimensional elasticity, from a fit to finite elements.

A curved wire is not a straight one: its flexibility per length is twice the strain energy of a unit wrench
(N_t, N_n, N_b, M_t, M_n, M_b) in Frenet's axes. Its thirteen entries are polynomials in curvature,
torsion and Poisson's ratio, fitted by ``python -m validation.solid.table``. Derivation: docs/theory.md.
"""

import math
import tomllib
from collections.abc import Callable
from pathlib import Path

import numpy as np

from coilspring.scene.material import Material
from coilspring.scene.spring import Spring
from coilspring.scene.wire import Section, round_section

TABLE = Path(__file__).with_name("solidtable.toml")
FLEXIBILITY, STRESS = map(np.array, tomllib.loads(TABLE.read_text(encoding="utf-8")).values())
SOLID_POISSON = (0.0, 0.5)  # Poisson's ratios that are taken; beyond 0.49 the fit is extrapolated
POWERS = ((0, 0), (0, 1), (0, 2), (1, 0), (1, 1), (2, 0))  # of curvature^2 and torsion^2, a column each
# Entries that do not vanish, and the powers of curvature and torsion that they are multiples of.
ENTRIES = {
    **{(i, i): (0, 0) for i in range(6)},
    **dict.fromkeys([(0, 5), (2, 3)], (1, 0)),
    **dict.fromkeys([(0, 2), (0, 3), (2, 5), (3, 5), (1, 4)], (1, 1)),
}


def monomials(curvature: np.ndarray, torsion: np.ndarray) -> np.ndarray:
    """`POWERS` of curvature and torsion times the wire's diameter, (..., 6)."""
    return np.stack([curvature ** (2 * a) * torsion ** (2 * b) for a, b in POWERS], axis=-1)


def flexibility(
    curvature: np.ndarray, torsion: np.ndarray, diameter: float, material: Material
) -> np.ndarray:
    """Flexibility of the wire per length, (n, 6, 6), 1/N, 1/(N mm), 1/(N mm^2).

    `curvature` and `torsion` of the centreline (n,), 1/mm; of a left-handed helix the torsion is negative.
    """
    k, t, nu = curvature * diameter, torsion * diameter, material.nu
    values = monomials(k, t) @ FLEXIBILITY @ nu ** np.arange(FLEXIBILITY.shape[-1]) / (1.0 + nu)
    found = np.zeros((*k.shape, 6, 6))
    for (i, j), (bent, twisted), value in zip(ENTRIES, ENTRIES.values(), values, strict=True):
        found[..., i, j] = found[..., j, i] = k**bent * t**twisted * value
    unit = diameter ** -np.array([1.0, 1.0, 1.0, 2.0, 2.0, 2.0])
    return found * unit[:, None] * unit / material.E


def wire_flexibility(spring: Spring, material: Material) -> Callable[[np.ndarray], np.ndarray]:
    """Flexibility of a spring's wire at phases, (n, 6, 6), as `Spring.wire_rigidity` says.

    Each is that in a helix of the radius and the pitch there.
    """
    wire = round_section(spring.wire_diameter, material)
    straight = np.diag([1.0 / x for x in (wire.EA, wire.GA, wire.GA, wire.GJ, wire.EI, wire.EI)])

    def at(phases: np.ndarray) -> np.ndarray:
        if spring.wire_rigidity == "beam":
            return np.broadcast_to(straight, (len(phases), 6, 6))
        radius, rise = spring.radius(phases), spring.rise(phases)
        square = radius**2 + rise**2
        turn = rise / square * (1.0 if spring.hand == "right" else -1.0)
        return flexibility(radius / square, turn, spring.wire_diameter, material)

    return at


def coil_section(spring: Spring, material: Material, curvature: np.ndarray) -> Section:
    """Stiffnesses with which a rod has the flexibility of the spring's wire in whole coils, each (n,).

    As `Spring.wire_rigidity` says: of a straight wire, or those four that meet the flexibilities of a closed
    ring of the curvature under an axial force and couple and under a lateral force and couple.
    """
    if spring.wire_rigidity == "beam":
        return round_section(spring.wire_diameter, material)
    F, R = flexibility(curvature, np.zeros_like(curvature), spring.wire_diameter, material), 1.0 / curvature
    bend = F[..., 5, 5]
    twist = F[..., 3, 3] + F[..., 4, 4] - bend
    shear = F[..., 2, 2] + 2.0 * R * F[..., 2, 3] + R**2 * (bend - F[..., 4, 4])
    stretch = F[..., 0, 0] + F[..., 1, 1] - 2.0 * R * F[..., 0, 5] - shear
    return Section(EA=1.0 / stretch, GA=1.0 / shear, GJ=1.0 / twist, EI=1.0 / bend)


def half_ring(section: Section, radius: np.ndarray) -> np.ndarray:
    """Axial, shearing and bending stiffness of half a ring of wire, (n, 3): N/mm, N/mm, N mm."""
    axial = radius**2 / section.GJ + 1.0 / section.GA
    shear = 0.5 * (radius**2 / section.EI + 1.0 / section.EA + 1.0 / section.GA)
    bending = 0.5 * (1.0 / section.GJ + 1.0 / section.EI)
    return 1.0 / (math.pi * radius[:, None] * np.stack(np.broadcast_arrays(axial, shear, bending), axis=-1))


def inner_stress_factor(index: float) -> float:
    """Shear stress at the inside of a closely coiled spring over 8 F D / (pi d^3), whatever nu is."""
    return 1.0 + float((2.0 / index) ** np.arange(1, len(STRESS) + 1) @ STRESS)
