"""The laws of a half coil in plain numpy, for the verifier: N, T, M from l, v, dtheta, real or complex.

Haringx: (B2), (B3). Helix: (B5)-(B13), with central differences of its coefficients in the length. A user's
law: central differences of its plain Python energy; of the solver's derivatives nothing is taken.
"""

import math
from collections.abc import Callable
from functools import cached_property

import numpy as np

from coilspring import Scene
from equivbeam.laws.halfcoil import HalfCoil
from equivbeam.laws.userlaw import UserLaw
from validation.campaign.coils import coil_shape, half_coils, middles
from validation.campaign.wireparts import rigidities

Law = Callable[[np.ndarray, np.ndarray, np.ndarray], tuple[np.ndarray, np.ndarray, np.ndarray]]

NODES, WEIGHTS = np.polynomial.legendre.leggauss(8)
MOST_STEPS = 20  # of Newton's method on the length
NUDGE = 1e-6  # of the length of wire, with which differences are taken
LEAST_COSINE, LEAST_ROOT, SHRINK = 0.2, 0.5, 0.05  # how far the helix law reaches: see `Helices.ends`

# Steps of a user's law for first and second derivatives, of the length at rest, or rad: small, so that hardly
# a state lies so near a branch of the law, and in numbers of 80 bits where the machine has them.
STEP, WIDE_STEP = 1e-6, 1e-4
FIRST = {1: 45.0 / 60.0, 2: -9.0 / 60.0, 3: 1.0 / 60.0}  # central differences of order 6
SECOND = {0: -490.0 / 180.0, 1: 270.0 / 180.0, 2: -27.0 / 180.0, 3: 2.0 / 180.0}
MIXED = {1: 4.0 / 3.0, 2: -1.0 / 12.0}  # of order 4, along the diagonals
SIDES, AXES, PAIRS = (1, -1), np.eye(3, dtype=int), ((0, 1), (0, 2), (1, 2))
# Each derivative as coefficients of the energy after moves, in steps: of the axes, then of their pairs.
GRADIENT = [{tuple(side * k * e): side * c for k, c in FIRST.items() for side in SIDES} for e in AXES]
HESSIAN = [{tuple(side * k * e): c for k, c in SECOND.items() for side in SIDES} for e in AXES]
for i, j in PAIRS:
    moves = ((side * k, t, t * c / 4.0) for k, c in MIXED.items() for t in SIDES for side in SIDES)
    HESSIAN.append({tuple(k * (AXES[i] + t * AXES[j])): c for k, t, c in moves})


def haringx_law(scene: Scene) -> Law:
    """Constant stiffnesses of all half coils, (B3)."""
    spring, E, G = scene.spring, scene.material.E, scene.material.G
    d, (radius, rise) = spring.wire_diameter, middles(spring)
    D, pitch = 2.0 * radius, 2.0 * math.pi * rise
    cosine = 1.0 / np.sqrt(1.0 + (pitch / (math.pi * D)) ** 2)
    axial = G * d**4 * cosine / (4.0 * D**3)
    shear = E * d**4 * cosine / (4.0 * D**3)
    bending = E * G * d**4 * cosine / (8.0 * D * (2.0 * G + E))

    def law(l, v, turn):  # noqa: E741
        return axial * (l - 0.5 * pitch), shear * v, bending * turn

    return law


def helix_law(scene: Scene) -> Law:
    """The helix law of all half coils with all its refinements."""
    phases = half_coils(scene.spring)
    at = phases[:-1, None] + 0.5 * np.diff(phases)[:, None] * (1.0 + NODES)  # Gauss's points
    radius = coil_shape(scene.spring, at)[0]
    helices = Helices(scene, phases, radius)
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


class Helices:
    """Half coils as helices between the phases, from the radii at Gauss's points."""

    def __init__(self, scene: Scene, phases: np.ndarray, radius: np.ndarray) -> None:
        self.EA, self.GA, self.GJ, self.EI = rigidities(scene)
        r = np.cbrt((radius**3) @ WEIGHTS / 2.0)  # by the axial flexibility of the taper
        _, rise = middles(scene.spring)
        self.L = np.sqrt(r * r + rise * rise)  # length of wire a radian
        self.s = np.diff(phases) * self.L  # length of wire
        self.u0 = rise / self.L  # sine at rest

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
        """Sines (2, half coils) between which the law holds, and the lengths there: with a cosine of at least
        0.2 (or half that at rest), and where (B7) has a root well clear of its end, length and force rising.
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
        """Force at the length l, with (B8) solved by Newton's method; beyond the range a straight line."""
        end = np.clip(l.real, *self.ends[1])
        u = np.clip(end / self.s, *self.ends[0])
        for _ in range(MOST_STEPS):
            step = (self.section(u)[0] - end) / self.rate(u)[0]
            u = np.clip(u - step, *self.ends[0])
            if np.abs(step).max() < 1e-9:  # whose square is below rounding
                break
        slope, stiffness = self.rate(u)
        return self.section(u)[1] + stiffness / slope * (l - end)

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


def coils_of(scene: Scene) -> list[HalfCoil]:
    """The half coils of a spring."""
    spring, moduli = scene.spring, (scene.material.E, scene.material.G)
    coils = []
    for index, (radius, rise) in enumerate(zip(*middles(spring), strict=True)):
        D, length = 2.0 * float(radius), math.pi * float(rise)
        begin = index * math.pi + spring.start_phase
        wire = math.sqrt(length**2 + (math.pi * D / 2.0) ** 2)
        shape = (D, spring.wire_diameter, length, wire, math.asin(length / wire), begin, begin + math.pi)
        coils.append(HalfCoil(*shape, spring.hand, *moduli, index))
    return coils


def plain_law(scene: Scene, law: UserLaw) -> Law:
    """(l, v, dtheta) of all half coils -> N, T, M of each; of complex steps their derivatives too."""
    coils = coils_of(scene)
    energy = PlainEnergy(law, coils)

    def found(l, v, turn):  # noqa: E741
        x = np.stack((l, v, turn))
        if not np.iscomplexobj(x):
            return tuple(energy.derivatives(x, second=False)[1])
        real = x.real
        alike = x.ndim == 3 and bool((real == real[:, :1]).all())  # steps around one state
        _, g, H = energy.derivatives(real[:, :1] if alike else real, second=True)
        return tuple(g + 1j * np.einsum("ij...,j...->i...", H, x.imag))

    return found


class PlainEnergy:
    """The energy of all half coils as the law's file says it, at whole arrays where it takes them."""

    def __init__(self, law: UserLaw, coils: list[HalfCoil]) -> None:
        self.law = law
        self.values = [tuple(np.atleast_1d(law.parameters(coil)).tolist()) for coil in coils]
        lengths = np.array([coil.length for coil in coils])
        self.size = np.stack((lengths, lengths, np.ones(len(coils))))
        self._whole = True

    def __call__(self, x: np.ndarray) -> np.ndarray:
        """Energies at l, v, dtheta of all half coils, (3, ..., half coils)."""
        if self._whole:
            try:
                with np.errstate(all="ignore"):
                    p = tuple(np.array(self.values).T)
                    return np.array(np.broadcast_to(self.law.energy(*x, p), x.shape[1:]), dtype=np.longdouble)
            except (TypeError, ValueError):  # it branches, or calls functions of numbers
                self._whole = False
        flat = x.reshape(3, -1, x.shape[-1])
        each = [[self._one(flat[:, i, k], k) for k in range(flat.shape[2])] for i in range(flat.shape[1])]
        return np.array(each, dtype=np.longdouble).reshape(x.shape[1:])

    def _one(self, state: np.ndarray, k: int) -> float:
        try:
            return self.law.energy(*state, self.values[k])
        except (ValueError, ZeroDivisionError, OverflowError):
            return math.nan

    def derivatives(self, x: np.ndarray, second: bool) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Energy, gradient and, where asked for, Hessian."""
        x = x.astype(np.longdouble)
        size = self.size.reshape(3, *(1,) * (x.ndim - 2), -1)
        U, *slopes = self._sums(x, STEP * size, [{(0, 0, 0): 1.0}, *GRADIENT])
        g, H = np.stack(slopes) / (STEP * size), np.zeros((3, 3, *U.shape))
        if second:
            sums = self._sums(x, WIDE_STEP * size, HESSIAN)
            for (i, j), value in zip(((0, 0), (1, 1), (2, 2), *PAIRS), sums, strict=True):
                H[i, j] = H[j, i] = value / (WIDE_STEP**2 * size[i] * size[j])
        return U.astype(float), g.astype(float), H

    def _sums(self, x: np.ndarray, step: np.ndarray, rules: list[dict]) -> np.ndarray:
        """Sums of the energies after the moves of each rule, times their coefficients."""
        moves = sorted({move for rule in rules for move in rule})
        shifts = np.array(moves).reshape(-1, 3, *(1,) * (x.ndim - 1)) * step
        values = self(np.moveaxis(x[None] + shifts, 0, 1))
        return np.tensordot([[rule.get(move, 0.0) for move in moves] for rule in rules], values, 1)
