"""A user's law for the verifier: its plain Python energy, differentiated by differences of its own.

The solver takes derivatives that are carried along by compiled code; this takes none of it.
"""

from __future__ import annotations

import math
from collections.abc import Callable

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
PAIRS = ((0, 1), (0, 2), (1, 2))


def coils_of(scene: Scene) -> list[HalfCoil]:
    """The half coils of a cylinder or cone of constant pitch."""
    spring, count = scene.spring, round(2 * scene.spring.active_coils)
    bottom, top = spring.mean_diameter
    length = spring.active_height / count
    coils = []
    for index in range(count):
        D = bottom + (top - bottom) * (index + 0.5) / count
        wire = math.sqrt(length**2 + (math.pi * D / 2.0) ** 2)
        begin = index * math.pi + spring.start_phase
        moduli = scene.material.E, scene.material.G
        phases = begin, begin + math.pi
        angle = math.asin(length / wire)
        coils.append(
            HalfCoil(D, spring.wire_diameter, length, wire, angle, *phases, spring.hand, *moduli, index)
        )
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
        axes = np.eye(3, dtype=int)
        U, both, h = self._moved(x, STEP, [k * axis for axis in axes for k in FIRST])
        g = np.stack([sum(c * both(k * axis, -1.0) for k, c in FIRST.items()) for axis in axes]) / h
        H = np.zeros((3, 3, *U.shape))
        if second:
            corners = [k * (axes[i] + side * axes[j]) for i, j in PAIRS for k in MIXED for side in (1, -1)]
            _, both, h = self._moved(x, WIDE_STEP, [*(k * axis for axis in axes for k in FIRST), *corners])
            for i in range(3):
                H[i, i] = (SECOND[0] * U + sum(SECOND[k] * both(k * axes[i], 1.0) for k in FIRST)) / h[i] ** 2
            for i, j in PAIRS:
                mixed = (
                    c * (both(k * (axes[i] + axes[j]), 1.0) - both(k * (axes[i] - axes[j]), 1.0)) / 4.0
                    for k, c in MIXED.items()
                )
                H[i, j] = H[j, i] = sum(mixed) / (h[i] * h[j])
        return U.astype(float), g.astype(float), H

    def _moved(
        self, x: np.ndarray, step: float, moves: list[np.ndarray]
    ) -> tuple[np.ndarray, Callable, np.ndarray]:
        """Energy at x, sum or difference of those to both sides by a move, and the size of a step."""
        h = step * self.size.reshape(3, *(1,) * (x.ndim - 2), -1)
        steps = np.array([np.zeros(3, int), *moves, *(-move for move in moves)])
        shifts = steps.reshape(-1, 3, *(1,) * (x.ndim - 1)) * h
        values = self(np.moveaxis(x[None] + shifts, 0, 1))
        at = {tuple(step.tolist()): value for step, value in zip(steps, values, strict=True)}

        def both(move: np.ndarray, sign: float) -> np.ndarray:
            return at[tuple(move.tolist())] + sign * at[tuple((-move).tolist())]

        return values[0], both, h
