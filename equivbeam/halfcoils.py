"""Where along the wire the nodes of an equivalent beam stand."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from coilspring.errors import InputError
from coilspring.scene.spring import Spring

ROUNDING = 1e-9  # of a half turn: a phase is known no better


class HalfCoils(NamedTuple):
    """Phases of the nodes, from 0 to the last active point, and what is between them."""

    phases: np.ndarray  # (n + 1,) of the nodes, rad
    middles: np.ndarray  # (n,) phases in the middle of the elements, rad
    lengths: np.ndarray  # (n,) their axial lengths at rest, mm


def half_coil_count(spring: Spring) -> int:
    """Number of half coils; `InputError` where the active coils are not a whole number of them."""
    count = round(2 * spring.active_coils)
    if abs(2 * spring.active_coils - count) > 1e-9:
        raise InputError(
            f"spring.active_coils must be a multiple of 0.5 in [0.5, 1000] for the equivalent beam, "
            f"got {spring.active_coils!r}"
        )
    return count


def nearest_crossing(spring: Spring) -> int:
    """Number k of the phase k pi about the axis, in the working plane, nearest to the first active point.

    Half way between two of them it is the lower one. There the last digit of the phase would decide for the
    sign of its cosine: -90 and 270 degrees, which are one spring, would have circles on different sides.
    """
    return math.ceil(spring.start_phase / math.pi - 0.5 - ROUNDING)


def wire_lengths(spring: Spring) -> np.ndarray:
    """Lengths of the wire of the half coils, each of a helix of the mean diameter in its middle, mm."""
    at = half_coils(spring)
    return np.hypot(at.lengths, math.pi * spring.radius(at.middles))


def half_coils(spring: Spring) -> HalfCoils:
    """Nodes at phases k pi, where a wire that starts in the working plane crosses it."""
    count = half_coil_count(spring)
    phases = np.arange(count + 1) * math.pi
    # without sections half the pitch, without the rounding of differences
    lengths = np.diff(spring.height(phases)) if spring.sections else np.full(count, 0.5 * spring.pitch)
    return HalfCoils(phases, 0.5 * (phases[:-1] + phases[1:]), lengths)
