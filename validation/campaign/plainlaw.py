"""A user's law for the verifier: its plain Python energy, differentiated by differences of its own.

The solver takes derivatives that are carried along by compiled code; this takes none of it.
"""

from __future__ import annotations

import math

import numpy as np

from coilspring import Scene
from equivbeam.laws.userlaw import HalfCoil, UserLaw
from validation.campaign.laws import Law

# Steps of the length at rest, or rad, for first and second derivatives: small, so that hardly a state lies so
# near a branch of the law, and in numbers of 80 bits where the machine has them, for the rounding.
STEP, WIDE_STEP = 1e-6, 1e-4
FIRST = {1: 45.0 / 60.0, 2: -9.0 / 60.0, 3: 1.0 / 60.0}  # central differences of order 6
SECOND = {0: -490.0 / 180.0, 1: 270.0 / 180.0, 2: -27.0 / 180.0, 3: 2.0 / 180.0}
MIXED = {1: 4.0 / 3.0, 2: -1.0 / 12.0}  # of order 4, along the diagonals
SIDES, AXES, PAIRS = (1, -1), np.eye(3, dtype=int), ((0, 1), (0, 2), (1, 2))
# Each derivative as coefficients of the energy after moves, in steps: of the axes, then of their pairs.
GRADIENT = [{tuple(side * k * e): side * c for k, c in FIRST.items() for side in SIDES} for e in AXES]
HESSIAN = [{tuple(side * k * e): c for k, c in SECOND.items() for side in SIDES} for e in AXES]
HESSIAN += [
    {
        tuple(side * k * (AXES[i] + t * AXES[j])): t * c / 4.0
        for k, c in MIXED.items()
        for t in SIDES
        for side in SIDES
    }
    for i, j in PAIRS
]


def coils_of(scene: Scene) -> list[HalfCoil]:
    """The half coils of a cylinder or cone of constant pitch."""
    spring, count, moduli = (
        scene.spring,
        round(2 * scene.spring.active_coils),
        (scene.material.E, scene.material.G),
    )
    (bottom, top), length = spring.mean_diameter, spring.active_height / count
    coils = []
    for index in range(count):
        D, begin = bottom + (top - bottom) * (index + 0.5) / count, index * math.pi + spring.start_phase
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
