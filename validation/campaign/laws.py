"""The laws of a half coil in plain numpy, for the verifier: N, T, M from l, v, dtheta, real or complex.

Haringx: (B2), (B3). Helix: (B5)-(B13), not solved as the solver does: derivatives of its coefficients in the
length are central differences.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from coilspring import Scene
from validation.campaign.wireparts import rigidities

Law = Callable[[np.ndarray, np.ndarray, np.ndarray], tuple[np.ndarray, np.ndarray, np.ndarray]]

NODES, WEIGHTS = np.polynomial.legendre.leggauss(8)
MOST_STEPS = 20  # of Newton's method on the length
NUDGE = 1e-6  # of the length of wire, with which differences are taken
LEAST_COSINE, LEAST_ROOT, SHRINK = 0.2, 0.5, 0.05  # how far the helix law reaches: see `Helices.ends`


def haringx_law(scene: Scene) -> Law:
    """Constant stiffnesses of all half coils, (B3)."""
    spring, E, G = scene.spring, scene.material.E, scene.material.G
    d, (bottom, top) = spring.wire_diameter, spring.mean_diameter
    count = round(2 * spring.active_coils)
    D = bottom + (top - bottom) * (np.arange(count) + 0.5) / count
    pitch = spring.active_height / spring.active_coils
    cosine = 1.0 / np.sqrt(1.0 + (pitch / (math.pi * D)) ** 2)
    axial = G * d**4 * cosine / (4.0 * D**3)
    shear = E * d**4 * cosine / (4.0 * D**3)
    bending = E * G * d**4 * cosine / (8.0 * D * (2.0 * G + E))

    def law(l, v, turn):  # noqa: E741
        return axial * (l - 0.5 * pitch), shear * v, bending * turn

    return law


def helix_law(scene: Scene) -> Law:
    """The helix law of all half coils with all its refinements."""
    phases = np.arange(round(2 * scene.spring.active_coils) + 1) * math.pi
    bottom, top = scene.spring.mean_diameter
    at = phases[:-1, None] + 0.5 * np.diff(phases)[:, None] * (1.0 + NODES)  # Gauss's points
    radius = 0.5 * (bottom + (top - bottom) * at / phases[-1])
    helices = Helices.of(scene, phases, radius)
    plane, (length_rate, force_rate) = -scene.spring.start_phase, helices.rate(helices.u0)
    # the sine u follows the length by less than 1/s, as shear and stretch do their part
    share = helices.s / length_rate
    # factors of chi in (B12), of rho - rho0 and of chi l in (B13)
    mean = helices.L * np.sqrt(1.0 - helices.u0**2)
    turns = (radius / mean[:, None]) ** 2 * np.cos(at - plane)
    tilt = -share * (turns @ WEIGHTS) * np.diff(phases) / 2.0
    sine, swell = np.sin(phases - plane), np.diff(np.cos(phases - plane))
    tip = -0.5 * share * (sine[1:] + sine[:-1])

    def coefficients(l: np.ndarray) -> np.ndarray:  # noqa: E741
        """Flexibilities (B10), (B11) and offsets v0, dtheta0 (B13), (B12)."""
        chi, rho = helices.wound(l)
        return np.stack((*helices.flexibilities(l), swell * rho + tip * chi * l, tilt * chi))

    def slopes(l: np.ndarray) -> np.ndarray:  # noqa: E741
        step = NUDGE * helices.s
        return (coefficients(l + step) - coefficients(l - step)) / (2.0 * step)

    l0 = helices.u0 * helices.s
    # the offsets' own flexibility, at most half of that of the wire
    own = length_rate / force_rate * slopes(l0)[2:] ** 2
    less = np.minimum(own, 0.5 * np.stack(helices.flexibilities(l0)))

    def law(l, v, turn):  # noqa: E741
        csh, cfl, v0, turn0 = coefficients(l)
        csh1, cfl1, v1, turn1 = slopes(l)
        T, M = (v - v0) / (csh - less[0]), (turn - turn0) / (cfl - less[1])
        N = helices.axial(l) - 0.5 * (csh1 * T * T + cfl1 * M * M) - T * v1 - M * turn1
        return N, T, M

    return law


@dataclass(frozen=True)
class Helices:
    """Half coils as helices: length of wire s and of wire a radian L, sine u0 at rest, rigidities."""

    s: np.ndarray
    L: np.ndarray
    u0: np.ndarray
    GJ: float
    EI: float
    GA: float
    EA: float

    @classmethod
    def of(cls, scene: Scene, phases: np.ndarray, radius: np.ndarray) -> Helices:
        """Helices between the phases, from the radii at Gauss's points."""
        spring, (EA, GA, GJ, EI) = scene.spring, rigidities(scene)
        r = np.cbrt((radius**3) @ WEIGHTS / 2.0)  # by the axial flexibility of the taper
        rise = spring.active_height / spring.active_coils / (2.0 * math.pi)
        L = np.sqrt(r * r + rise * rise)
        return cls(np.diff(phases) * L, L, rise / L, GJ, EI, GA, EA)

    def section(self, u: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Length and axial force at the sine u, ends held, and the root of (B7)."""
        c, c0 = np.sqrt(1.0 - u * u), np.sqrt(1.0 - self.u0**2)
        # derivative of the energy a length of wire, (B6)
        slope = (self.GJ * (u - self.u0) - self.EI * (c - c0) * u / c) / self.L**2
        f = (1.0 - u * u) / self.GA + u * u / self.EA
        root = np.sqrt(1.0 + 4.0 * u * (1.0 / self.EA - 1.0 / self.GA) * slope)
        F = 2.0 * slope / (1.0 + root)
        return self.s * (u + F * f), F, root

    def rate(self, u: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Derivatives of length and force in u."""
        length, F, _ = self.section(u + 1e-30j)
        return length.imag / 1e-30, F.imag / 1e-30

    @cached_property
    def ends(self) -> tuple[np.ndarray, np.ndarray]:
        """Sines (2, half coils) between which the law holds, and the lengths there.

        By its definition that is with a cosine of at least 0.2 (or half that at rest), and where (B7) has a
        root well clear of its end, length and force rising.
        """
        cosine = np.minimum(LEAST_COSINE, 0.5 * np.sqrt(1.0 - self.u0**2))
        u = np.outer((-1.0, 1.0), np.sqrt(1.0 - cosine**2))
        good = np.zeros(u.shape, dtype=bool)
        while not good.all():
            with np.errstate(invalid="ignore"):
                length, _, root = self.section(u)
                slope, stiffness = self.rate(u)
                good = (root >= LEAST_ROOT) & (stiffness > 0) & (slope > 0) & (abs(length) < self.s)
            u = np.where(good, u, u + SHRINK * (self.u0 - u))
        return u, self.section(u)[0]

    def split(self, l: np.ndarray) -> tuple[np.ndarray, np.ndarray]:  # noqa: E741
        """The length up to the end of the range, and what goes beyond; one of them takes a complex step."""
        end = np.clip(l.real, *self.ends[1])
        beyond = np.where(end == l.real, 0.0, l - end)
        return l - beyond, beyond

    def axial(self, l: np.ndarray) -> np.ndarray:  # noqa: E741
        """Force at the length l; beyond the range a straight line."""
        end = np.clip(l.real, *self.ends[1])
        u = self._sine(end)
        slope, stiffness = self.rate(u)
        return self.section(u)[1] + stiffness / slope * (l - end)

    def _sine(self, length: np.ndarray) -> np.ndarray:
        """Solve (B8) for the sine u by Newton's method."""
        u = np.clip(length / self.s, *self.ends[0])
        for _ in range(MOST_STEPS):
            step = (self.section(u)[0] - length) / self.rate(u)[0]
            u = np.clip(u - step, *self.ends[0])
            if np.abs(step).max() < 1e-9:  # whose square is below rounding
                break
        return u

    def wound(self, l: np.ndarray) -> tuple[np.ndarray, np.ndarray]:  # noqa: E741
        """chi and rho - rho0 at the length l; beyond the range straight lines."""
        inside, beyond = self.split(l)
        y = inside / self.s
        cosine, cosine0 = np.sqrt(1.0 - y * y), np.sqrt(1.0 - self.u0**2)
        further = beyond / (self.s * cosine)
        return np.arcsin(y) - np.arcsin(self.u0) + further, self.L * (cosine - cosine0 - y * further)

    def flexibilities(self, l: np.ndarray) -> tuple[np.ndarray, np.ndarray]:  # noqa: E741
        """(B10), (B11), with x = (l/s)^2; beyond the range x tends to 1 (or 0) exponentially."""
        inside, beyond = self.split(l)
        x = (inside / self.s) ** 2
        far = np.where(inside.real * beyond.real > 0.0, 1.0, 0.0)
        rate = 2.0 * inside / self.s**2 / np.where(far == x, 1.0, far - x)
        x = far - (far - x) * np.exp(-rate * beyond)
        J, I, G, A = 1.0 / self.GJ, 1.0 / self.EI, 1.0 / self.GA, 1.0 / self.EA  # noqa: E741
        cfl = self.s * ((1.0 - x) * J + (1.0 + x) * I) / 2.0
        wire = 0.5 * self.L**2 * (1.0 - x) * (x * J + (1.0 - x) * I)
        section = 0.5 * ((1.0 - x) * A + (1.0 + x) * G)
        return self.s * (wire + section) + self.s**2 * x * cfl / 12.0, cfl
