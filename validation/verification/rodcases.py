"""Verification cases of the wire model on rods that are not springs."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

import wirefe
from coilspring import EquilibriumNotFound
from coilspring.scene.wire import Section
from validation.verification.case import Check, observed_order


@dataclass(frozen=True)
class Arc:
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


def checks() -> Iterator[Check]:
    """G1 to G5, G10 and G11, solved."""
    yield from bends()
    yield rolling_up()
    yield unrolling()
    yield shear_flexible()
    yield from elasticas()
    yield lees_frame()
    yield arch()


def tip(rod: wirefe.Rod, steps: int = 2) -> tuple[float, ...]:
    """Displacement of the last node at full load."""
    return tuple(wirefe.solve_rod(rod, steps=steps).displacements(-1)[-1].tolist())


def critical_load(rod: wirefe.Rod, load: float) -> float:
    """Load at the first critical point; the rod carries `load` at time 1."""
    try:
        wirefe.solve_rod(rod, steps=5)
    except EquilibriumNotFound as found:
        return load * (found.critical_time or np.nan)
    return float("nan")


def bends() -> Iterator[Check]:
    """G1."""
    section = Section(EA=1e7, GA=5e6 * 5 / 6, GJ=5e6 / 6, EI=1e7 / 12)
    arc = Arc(100.0, (-1.0, 0.0, 0.0), (0.0, 1.0, 0.0))

    def bend(elements: int, force: float) -> tuple[float, ...]:
        rod = wirefe.curved_rod(arc, np.linspace(0.0, np.pi / 4, elements + 1), section).holding(0)
        return tip(rod.loaded(-1, force=(0.0, 0.0, force)), steps=4)

    for force, target in (
        (300.0, (-7.04464, -11.93178, 40.19239)),
        (450.0, (-10.78126, -18.47242, 48.50349)),
        (600.0, (-13.60463, -23.56058, 53.47548)),
    ):
        fine = np.array(bend(64, force))
        errors = [np.abs(bend(n, force) - fine).max() for n in (4, 8, 16)]
        yield Check(
            "G1, 45 degree bend", f"P = {force:g}, 8 curved elements", target, "own (shooting), GJ = G 2I",
            1e-4, bend(8, force), "published tips differ by 1 % with the torsion constant used",
            observed_order(errors),
        )  # fmt: skip


def rolling_up() -> Check:
    """G2."""
    rod = wirefe.straight_rod(line(10.0, 8), Section(1e4, 1e4, 100.0, 100.0)).holding(0).in_plane()
    result = tip(rod.loaded(-1, moment=(0.0, 0.0, 20 * np.pi)))
    limits = "pure bending: nothing of shear and stretch"
    data = "M = 2 pi EI/L, 8 straight elements"
    return Check("G2, roll-up", data, (-10.0, 0.0, 0.0), "exact", 1e-8, result, limits)


def unrolling() -> Check:
    """G3."""
    section = Section(EA=1200.0, GA=500.0, GJ=100.0, EI=100.0)
    arc = Arc(10.0 / (2 * np.pi), (0.0, -1.0, 0.0), (1.0, 0.0, 0.0))
    rod = wirefe.curved_rod(arc, np.linspace(0.0, 2 * np.pi, 5), section).holding(0).in_plane()
    result = tip(rod.loaded(-1, moment=(0.0, 0.0, -20 * np.pi)))
    data = "M = 2 pi EI/L, 4 curved elements"
    return Check("G3, unrolling a circle", data, (10.0, 0.0, 0.0), "exact", 1e-8, result, "pure bending")


def shear_flexible() -> Check:
    """G4."""
    h, b, nu, young = 0.5, 0.1, 0.3, 2.07e11
    shear = young / (2 * (1 + nu)) * h * b * 10 * (1 + nu) / (12 + 11 * nu)
    section = Section(young * h * b, shear, 1e8, young * b * h**3 / 12)
    target = (-0.15097114, -0.71056860)

    def bent(elements: int) -> tuple[float, ...]:
        rod = wirefe.straight_rod(line(2.0, elements), section).holding(0).in_plane()
        return tip(rod.loaded(-1, force=(0.0, -5e8 * h**3, 0.0)))[:2]

    errors = [abs(bent(n)[0] - target[0]) for n in (8, 16, 32)]
    return Check(
        "G4, shear-flexible cantilever", "F = 5e8 h^3, 64 straight elements", target,
        "published (Nachbagauer 2011)", 1e-5, bent(64), "in a plane", observed_order(errors),
    )  # fmt: skip


def elasticas() -> Iterator[Check]:
    """G5."""

    def bent(elements: int, load: float) -> tuple[float, ...]:
        rod = wirefe.straight_rod(line(1.0, elements), Section(1e8, 1e8, 1.0, 1.0)).holding(0).in_plane()
        return tip(rod.loaded(-1, force=(0.0, load, 0.0)))[:2]

    for load, u, w in (
        (1.0, 0.05643324, 0.30172077),
        (2.0, 0.16064172, 0.49345748),
        (5.0, 0.38762836, 0.71379152),
        (10.0, 0.55499560, 0.81060902),
    ):
        errors = [abs(bent(n, load)[0] + u) for n in (4, 8, 16)]
        yield Check(
            "G5, elastica", f"P L^2/EI = {load:g}, 64 straight elements", (-u, w),
            "own (agrees with Mattiasson 1981)", 1e-6, bent(64, load), "in a plane, inextensible",
            observed_order(errors),
        )  # fmt: skip


def lees_frame() -> Check:
    """G10."""
    n, young, area, inertia = 40, 720.0, 6.0, 2.0
    column = line(120.0, n)[:, [1, 0, 2]]
    beam = line(120.0, n) + np.array([0.0, 120.0, 0.0])
    section = Section(young * area, young / 2.6 * area * 5 / 6, 1e3, young * inertia)
    rod = wirefe.straight_rod(np.concatenate((column, beam[1:])), section).in_plane()
    rod = rod.holding(0, "ux", "uy").holding(2 * n, "ux", "uy")
    found = critical_load(rod.loaded(n + n // 5, force=(0.0, -3.0, 0.0)), 3.0)
    return Check(
        "G10, Lee's frame", "first limit load, 80 straight elements", (1.85445,), "own (shooting)",
        1e-5, (found,), "the path beyond the limit point",
    )  # fmt: skip


def arch() -> Check:
    """G11."""
    half = np.radians(215.0) / 2
    arc = Arc(100.0, (0.0, 1.0, 0.0), (1.0, 0.0, 0.0))
    rod = wirefe.curved_rod(arc, np.linspace(-half, half, 21), Section(1e8, 1e8, 1e6, 1e6)).in_plane()
    rod = rod.holding(0).holding(20, "ux", "uy").loaded(10, force=(0.0, -1000.0, 0.0))
    return Check(
        "G11, hinged-clamped arch of 215 degrees", "critical load, 20 curved elements", (897.3,),
        "published (20 curved 3-node elements)", 1e-3, (critical_load(rod, 1000.0),),
        "the notes print 145 degrees; 215 is usual and fits",
    )  # fmt: skip
