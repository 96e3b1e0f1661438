"""The coils at rest for the verifier, from the numbers of their sections alone."""

import math

import numpy as np
from numpy.polynomial import Polynomial

from coilspring import Spring

TURN = 2.0 * math.pi
NUDGE = 1e-9  # rad: so far beside a point are the tangents whose mean it has


def coil_shape(spring: Spring, phases: np.ndarray, order: int = 0, below: bool = False) -> np.ndarray:
    """Radius and height (2, ...) of the active wire at the phases, or their derivatives of some order; where
    two sections meet those of the upper one, or of the one `below`."""
    phases = np.asarray(phases, dtype=float)
    found, begin, bottom = np.zeros((2, *phases.shape)), 0.0, 0.0
    for section in spring.coils:
        coils, (low, high), (lower, upper) = section.coils, section.pitch, section.mean_diameter
        here, turns = phases > begin + (0.5 if below else -0.5) * NUDGE, TURN * coils
        radius = Polynomial((0.5 * lower, 0.5 * (upper - lower)))
        height = Polynomial((bottom, coils * low, 0.5 * coils * (high - low)))
        for values, part in zip(found, (radius, height), strict=True):
            values[here] = part.deriv(order)((phases[here] - begin) / turns) / turns**order
        begin, bottom = begin + turns, bottom + 0.5 * coils * (low + high)
    return found


def middles(spring: Spring) -> tuple[np.ndarray, np.ndarray]:
    """Radius in the middle of each half coil, and the rise a radian there, which is its mean."""
    phases = half_coils(spring)[:-1] + 0.5 * math.pi
    return coil_shape(spring, phases)[0], coil_shape(spring, phases, 1)[1]


def half_coils(spring: Spring) -> np.ndarray:
    """Phases (n + 1,) at which the n half coils of the active wire begin and end."""
    return np.arange(round(2 * spring.active_coils) + 1) * math.pi


def end_pitch(spring: Spring) -> tuple[float, float]:
    """Pitch of the end turns at the bottom and at the top: the wire's diameter where they are closed."""
    if spring.ends == "closed":
        return spring.wire_diameter, spring.wire_diameter
    return spring.coils[0].pitch[0], spring.coils[-1].pitch[1]


def largest_diameter(spring: Spring) -> float:
    """Of all coils."""
    return max(diameter for section in spring.coils for diameter in section.mean_diameter)
