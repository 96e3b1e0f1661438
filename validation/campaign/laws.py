"""The laws of a half coil in plain numpy, for the verifier: energy and forces, real or complex.

Haringx: (B2), (B3). Helix: (B5)-(B13), not solved as the solver does: the sine u is found by a
bracketed search on the length, and one Newton step in the complex plane carries the derivative along.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from coilspring import Scene

Pair = tuple[np.ndarray, np.ndarray]

SHEAR_FACTOR = 0.9  # of a round section
NODES, WEIGHTS = np.polynomial.legendre.leggauss(8)
BISECTIONS, POLISHES = 1, 12
LEAST_COSINE, LEAST_ROOT, SHRINK = 0.2, 0.5, 0.05  # how far the helix law reaches: see `_range`


def haringx_law(scene: Scene) -> Callable:
    """Constant stiffnesses of all half coils, (B3)."""
    spring, E, G = scene.spring, scene.material.E, scene.material.G
    d, (bottom, top) = spring.wire_diameter, spring.mean_diameter
    count = round(2 * spring.active_coils)
    share = (np.arange(count) + 0.5) / count
    D = bottom + (top - bottom) * share
    pitch = spring.active_height / spring.active_coils
    cosine = 1.0 / np.sqrt(1.0 + (pitch / (math.pi * D)) ** 2)
    axial = G * d**4 * cosine / (4.0 * D**3)
    shear = E * d**4 * cosine / (4.0 * D**3)
    bending = E * G * d**4 * cosine / (8.0 * D * (2.0 * G + E))

    def law(l, v, turn):  # noqa: E741
        x = l - 0.5 * pitch
        N, T, M = axial * x, shear * v, bending * turn
        return 0.5 * (N * x + T * v + M * turn), N, T, M

    return law


@dataclass(frozen=True)
class Helices:
    """Half coils as helices: length of wire s and of wire a radian L, rigidities, tau0, kappa0."""

    s: np.ndarray
    L: np.ndarray
    u0: np.ndarray
    GJ: float
    EI: float
    GA: float
    EA: float

    def wound(self, u: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """(B6), ends held: energy a length of wire and its derivative in u."""
        c, c0 = np.sqrt(1.0 - u * u), np.sqrt(1.0 - self.u0**2)
        twist, bend = (u - self.u0) / self.L, (c - c0) / self.L
        energy = 0.5 * (self.GJ * twist**2 + self.EI * bend**2)
        return energy, (self.GJ * twist - self.EI * bend * u / c) / self.L

    def section(self, u: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
        """Length, energy and force at the sine u, and the root of (B7)."""
        e, e1 = self.wound(u)
        f = (1.0 - u * u) / self.GA + u * u / self.EA
        slope = 2.0 * u * (1.0 / self.EA - 1.0 / self.GA)
        root = np.sqrt(1.0 + 2.0 * slope * e1)
        F = 2.0 * e1 / (1.0 + root)
        return self.s * (u + F * f), self.s * (e + 0.5 * F * F * f), F, root

    def rate(self, u: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Derivatives of length and force in u."""
        length, _, F, _ = self.section(u + 1e-30j)
        return length.imag / 1e-30, F.imag / 1e-30


def half_coils(scene: Scene) -> np.ndarray:
    """Phases between half coils."""
    return np.arange(round(2 * scene.spring.active_coils) + 1) * math.pi


def helix_law(scene: Scene) -> Callable:
    """The helix law of all half coils with all its refinements."""
    phases, plane = half_coils(scene), -scene.spring.start_phase
    helices = helices_of(scene, phases)
    low, high, ends = reach(helices)
    own, l0 = _own_offsets(helices, ends, *_ends(scene, helices, phases, plane)), helices.u0 * helices.s
    soft = np.divide(*helices.rate(helices.u0))
    _, offset, _, tilt = own(l0)
    csh, _, cfl, _ = _flexibilities(helices, helices.u0**2)
    less = np.minimum(soft * offset**2, 0.5 * csh), np.minimum(soft * tilt**2, 0.5 * cfl)

    def law(l, v, turn):  # noqa: E741
        E, N = _axial(helices, low, high, ends, l)
        x, x1 = _square(helices.s, ends, l)
        csh, csh1, cfl, cfl1 = _flexibilities(helices, x)
        v0, v1, turn0, turn1 = own(l)
        T, M = (v - v0) / (csh - less[0]), (turn - turn0) / (cfl - less[1])
        N = N - 0.5 * (csh1 * T * T + cfl1 * M * M) * x1 - T * v1 - M * turn1
        return E + 0.5 * (T * (v - v0) + M * (turn - turn0)), N, T, M

    return law


def _between(scene: Scene, phases: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Phases and radii at Gauss's points between phases, (elements, points)."""
    bottom, top = scene.spring.mean_diameter
    at = phases[:-1, None] + 0.5 * np.diff(phases)[:, None] * (1.0 + NODES)
    return at, 0.5 * (bottom + (top - bottom) * at / phases[-1])


def _ends(scene: Scene, helices: Helices, phases: np.ndarray, plane: float) -> tuple[np.ndarray, ...]:
    """Factors of chi in (B12), of rho - rho0 and of chi l in (B13)."""
    at, radius = _between(scene, phases)
    mean = helices.L * np.sqrt(1.0 - helices.u0**2)
    turns = (radius / mean[:, None]) ** 2 * np.cos(at - plane)
    # the sine u follows the length by less than 1/s, as shear and stretch do their part
    share = helices.s / helices.rate(helices.u0)[0]
    m = share * (turns @ WEIGHTS) * np.diff(phases) / 2.0
    sine = np.sin(phases - plane)
    return m, np.diff(np.cos(phases - plane)), -0.5 * share * (sine[1:] + sine[:-1])


def _own_offsets(helices: Helices, ends: Pair, m: np.ndarray, swell: np.ndarray, tip: np.ndarray) -> Callable:
    """v0 and dtheta0, each with its derivative in the length."""

    def own(l):  # noqa: E741
        chi, chi1, rho, rho1 = wound(helices, ends, l)
        return swell * rho + tip * chi * l, swell * rho1 + tip * (chi + l * chi1), -m * chi, -m * chi1

    return own


def wound(helices: Helices, ends: Pair, l: np.ndarray) -> tuple[np.ndarray, ...]:  # noqa: E741
    """chi and rho - rho0 at the length l, each with its derivative; beyond the range straight lines."""
    end = np.clip(l.real, *ends)
    beyond = np.where(end == l.real, 0.0, l - end)
    y = (l - beyond) / helices.s
    cosine, cosine0 = np.sqrt(1.0 - y * y), np.sqrt(1.0 - helices.u0**2)
    rate = 1.0 / (helices.s * cosine)
    chi = np.arcsin(y) - np.arcsin(helices.u0) + beyond * rate
    return chi, rate, helices.L * (cosine - cosine0 - beyond * y * rate), -helices.L * y * rate


def helices_of(scene: Scene, phases: np.ndarray) -> Helices:
    spring, E, G = scene.spring, scene.material.E, scene.material.G
    d, (_, radius) = spring.wire_diameter, _between(scene, phases)
    r = np.cbrt((radius**3) @ WEIGHTS / 2.0)  # by the axial flexibility of the taper
    rise = spring.active_height / spring.active_coils / (2.0 * math.pi)
    L = np.sqrt(r * r + rise * rise)
    area = math.pi * d * d / 4.0
    bending = E * math.pi * d**4 / 64.0
    return Helices(
        s=np.diff(phases) * L,
        L=L,
        u0=rise / L,
        GJ=G * math.pi * d**4 / 32.0,
        EI=bending,
        GA=SHEAR_FACTOR * G * area,
        EA=E * area,
    )


def reach(helices: Helices) -> tuple[np.ndarray, np.ndarray, Pair]:
    """Sines and lengths between which the law holds."""
    low, high = _range(helices)
    return low, high, (helices.section(low)[0], helices.section(high)[0])


def _range(helices: Helices) -> tuple[np.ndarray, np.ndarray]:
    """Sines between which the law holds, by its definition: cosine at least 0.2 (or half that at rest), and
    (B7) with a root well clear of its end, length and force rising."""
    cosine = np.minimum(LEAST_COSINE, 0.5 * np.sqrt(1.0 - helices.u0**2))
    sides = []
    for sign in (-1.0, 1.0):
        u = sign * np.sqrt(1.0 - cosine**2)
        while True:
            with np.errstate(invalid="ignore"):
                length, _, _, root = helices.section(u)
                slope, stiffness = helices.rate(u)
                good = (root >= LEAST_ROOT) & (stiffness > 0) & (slope > 0) & (abs(length) < helices.s)
            if good.all():
                break
            u = np.where(good, u, u + SHRINK * (helices.u0 - u))
        sides.append(u)
    return sides[0], sides[1]


def _axial(
    helices: Helices,
    low: np.ndarray,
    high: np.ndarray,
    ends: Pair,
    l: np.ndarray,  # noqa: E741
) -> Pair:
    """Energy and force at the length l; beyond the range a parabola of the same curvature."""
    # complex steps, along the first axis, leave the real part as it is
    real = l.real[0] if np.iscomplexobj(l) else l
    inside = np.clip(real, *ends)
    u = _sine(helices, low, high, inside)
    slope, stiffness = helices.rate(u)
    _, E, F, _ = helices.section(u)
    k, rest = stiffness / slope, l - inside
    # one step of Taylor's series from the real length: exact for complex steps
    within = (real > ends[0]) & (real < ends[1])
    rest = np.where(within, 1j * l.imag if np.iscomplexobj(l) else 0.0, rest)
    return E + (F + 0.5 * k * rest) * rest, F + k * rest


def _sine(helices: Helices, low: np.ndarray, high: np.ndarray, length: np.ndarray) -> np.ndarray:
    """Solve (B8) for the sine u: halving, then Newton's method."""
    a, b = low, high
    for _ in range(BISECTIONS):
        middle = 0.5 * (a + b)
        longer = helices.section(middle)[0] > length
        a, b = np.where(longer, a, middle), np.where(longer, middle, b)
    u = 0.5 * (a + b)
    for _ in range(POLISHES):
        step = (helices.section(u)[0] - length) / helices.rate(u)[0]
        u = np.clip(u - step, low, high)
        if np.abs(step).max() < 1e-9:  # whose square is below rounding
            break
    return u


def _square(s: np.ndarray, ends: Pair, l: np.ndarray) -> Pair:  # noqa: E741
    """x = (l/s)^2 and its derivative; beyond the range it tends to 1 (or 0) exponentially."""
    low, high = ends
    end = np.where(l.real > high, high, np.where(l.real < low, low, l.real))
    x, x1 = (end / s) ** 2, 2.0 * end / s**2
    beyond = l - end
    far = np.where(end * beyond.real > 0.0, 1.0, 0.0)
    sign = np.where(beyond.real >= 0.0, 1.0, -1.0)
    rate = np.abs(x1 / np.where(far == x, 1.0, far - x))
    decay = np.exp(-rate * sign * beyond)
    out = beyond.real != 0.0
    inner, slope = (l / s) ** 2, 2.0 * l / s**2
    return np.where(out, far - (far - x) * decay, inner), np.where(out, x1 * decay, slope)


def _flexibilities(h: Helices, x: np.ndarray) -> tuple[np.ndarray, ...]:
    """(B10), (B11) and their derivatives in x; with (l/s)^2 = x."""
    J, I, G, A = 1.0 / h.GJ, 1.0 / h.EI, 1.0 / h.GA, 1.0 / h.EA  # noqa: E741
    cfl = h.s * ((1.0 - x) * J + (1.0 + x) * I) / 2.0
    cfl1 = h.s * (I - J) / 2.0
    wire = 0.5 * h.L**2 * (1.0 - x) * (x * J + (1.0 - x) * I)
    wire1 = 0.5 * h.L**2 * ((1.0 - 2.0 * x) * J - 2.0 * (1.0 - x) * I)
    section, section1 = 0.5 * ((1.0 - x) * A + (1.0 + x) * G), 0.5 * (G - A)
    spread, spread1 = h.s**2 * x * cfl / 12.0, h.s**2 * (cfl + x * cfl1) / 12.0
    return h.s * (wire + section) + spread, h.s * (wire1 + section1) + spread1, cfl, cfl1
