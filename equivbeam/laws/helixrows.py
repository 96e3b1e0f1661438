"""Parameters of the helix law from a spring and its material, and the law's refinements."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from coilspring.errors import InputError, shown
from coilspring.scene.material import Material
from coilspring.scene.solidwire import coil_section
from coilspring.scene.spring import Spring
from equivbeam.laws.haringx import KAX, haringx_stiffness
from equivbeam.laws.helix import (
    B0,
    B1,
    COLUMNS,
    EI,
    FREE,
    G1,
    GJ,
    H0,
    H1,
    H2,
    IEA,
    IGA,
    KAPPA0,
    L0,
    OMEGA,
    PER_S,
    RATE,
    SWELL,
    TAU0,
    TILT,
    TIP,
    U0,
    S,
    axial,
    set_range,
    winding,
)
from equivbeam.stations import Stations, half_coils

STRAIGHT = 0.05  # cosine of the angle of a helix of 87 degrees
POINTS = 16  # of Gauss's rule for (B12)
MOST_TAKEN = 0.5  # share of a flexibility, at most, that the length contributes and that is subtracted


@dataclass(frozen=True)
class Refinements:
    """What the helix law has beyond Haringx's: each can be left out, to see what it is worth.

    Attributes
    ----------
    large : axial law of a helix in large deformation, else Haringx's constant stiffness; `held`, `taper`
        and `ends` refine this law.
    held : the ends of a half coil do not turn about the axis, as the scenes have it; else they are free.
    shear, stretch : transverse shear and stretch of the wire.
    taper : radius of a half coil of a cone by its axial flexibility, else that in its middle.
    lateral : lateral and bending flexibility by wire theory, else Haringx's; `spread` and `current`
        refine it.
    spread : bending acts all along the half coil, else in its middle.
    current : lateral and bending flexibility at the current angle of the helix, else at rest.
    ends : the axial force turns and sets off the axis where the wire is held, and in the half coils of a
        cone: (B12) and (B13); goes with `held`.
    """

    large: bool = True
    held: bool = True
    shear: bool = True
    stretch: bool = True
    taper: bool = True
    lateral: bool = True
    spread: bool = True
    current: bool = True
    ends: bool = True

    def __post_init__(self) -> None:
        for name, value in vars(self).items():
            if not isinstance(value, bool):
                raise InputError(f"refinements.{name} must be true or false, got {shown(value)}")


def helix_rows(spring: Spring, material: Material, refinements: Refinements) -> np.ndarray:
    """Parameters of every half coil, shape (2 n, `COLUMNS`)."""
    on, at = refinements, half_coils(spring)
    rows = _wound_rows(spring, material, on, at)
    stiffness = haringx_stiffness(spring, material)
    rows[:, RATE] = 0.0 if on.large else stiffness[:, KAX]
    if not on.lateral:
        rows[:, H0], rows[:, B0] = 1.0 / stiffness[:, 1], 1.0 / stiffness[:, 2]
    set_range(rows)
    if on.ends and on.large and on.held:
        _set_ends(rows, spring, at)
    return rows


def _set_ends(rows: np.ndarray, spring: Spring, at: Stations) -> None:
    """Set the factors in (B12) and (B13); subtract from the flexibilities what the length contributes."""
    x, weight = np.polynomial.legendre.leggauss(POINTS)
    phi = at.middles[:, None] + 0.5 * math.pi * x
    square = (spring.radius(phi) / radii(spring, at, taper=True)[:, None]) ** 2
    m = 0.5 * math.pi * ((square * np.cos(phi - at.plane)) @ weight)
    psi = at.phases - at.plane
    rows[:, SWELL] = np.diff(np.cos(psi))
    # the wire's shear and stretch, which leave its angle as it is, are in the length
    rows[:, TILT], rows[:, TIP] = rows[:, G1] * m, -0.5 * rows[:, G1] * (np.sin(psi[:-1]) + np.sin(psi[1:]))
    for i, row in enumerate(rows):
        length, x = row[L0], row[U0] ** 2
        _, turn, _, _, growth, _ = winding(rows, i, length)
        coupling = row[SWELL] * growth + row[TIP] * length * turn
        soft = 1.0 / axial(rows, i, length)[2]
        shear, bending = row[H0] + x * (row[H1] + x * row[H2]), row[B0] + x * row[B1]
        row[H0] -= min(coupling**2 * soft, MOST_TAKEN * shear)
        row[B0] -= min((row[TILT] * turn) ** 2 * soft, MOST_TAKEN * bending)


def _wound_rows(spring: Spring, material: Material, on: Refinements, at: Stations) -> np.ndarray:
    """Parameters of the half coils by wire theory; the range is not set."""
    radius = radii(spring, at, on.taper)
    c = at.lengths / math.pi
    slant = np.hypot(radius, c)  # L, wire length per radian
    wire = coil_section(spring, material, radius / slant**2)
    _refuse_straight_wire(spring, float((radius / slant).min()))
    rows = np.zeros((radius.size, COLUMNS))
    rows[:, S], rows[:, PER_S], rows[:, L0] = math.pi * slant, 1.0 / (math.pi * slant), at.lengths
    rows[:, GJ], rows[:, EI] = wire.GJ, wire.EI
    rows[:, IGA], rows[:, IEA] = on.shear / wire.GA, on.stretch / wire.EA
    rows[:, OMEGA], rows[:, TAU0], rows[:, KAPPA0] = 1.0 / slant, c / slant**2, radius / slant**2
    rows[:, FREE], rows[:, U0] = not on.held, c / slant
    if on.lateral:
        _set_lateral(rows, slant, on)
    return rows


def _refuse_straight_wire(spring: Spring, cosine: float) -> None:
    """Refuse a wire that is all but straight at rest: the law is one of coils."""
    if cosine < STRAIGHT:
        least = min(min(section.mean_diameter) for section in spring.coils)
        most = math.pi * least * spring.active_coils / STRAIGHT
        raise InputError(
            f"spring.active_height must be below about {most:.3g} with law helix, so that the wire is "
            f"coiled, got {spring.active_height!r}"
        )


def radii(spring: Spring, at: Stations, taper: bool) -> np.ndarray:
    """Radius of the wire between stations: in the middle, or the one whose cube is the mean of r^3.

    The mean is Simpson's, exact unless two sections meet there.
    """
    middle = spring.radius(at.middles)
    if not taper:
        return middle
    cubes = spring.radius(at.phases) ** 3
    return np.cbrt((cubes[:-1] + 4.0 * middle**3 + cubes[1:]) / 6.0)


def _set_lateral(rows: np.ndarray, slant: np.ndarray, on: Refinements) -> None:
    """Coefficients of (B10) and (B11); at rest, where they do not follow the angle, constants."""
    s, x = rows[:, S], rows[:, U0] ** 2
    J, I, G, A = 1.0 / rows[:, GJ], 1.0 / rows[:, EI], rows[:, IGA], rows[:, IEA]  # noqa: E741
    h, q = 0.5 * slant**2, on.spread * s**2 / 12.0
    rows[:, B0], rows[:, B1] = 0.5 * s * (J + I), 0.5 * s * (I - J)
    rows[:, H0] = s * (h * I + 0.5 * (A + G))
    rows[:, H1] = s * (h * (J - 2.0 * I) + 0.5 * (G - A) + 0.5 * q * (J + I))
    rows[:, H2] = s * (I - J) * (h + 0.5 * q)
    if not on.current:
        rows[:, B0] += x * rows[:, B1]
        rows[:, H0] += x * (rows[:, H1] + x * rows[:, H2])
        rows[:, [B1, H1, H2]] = 0.0
