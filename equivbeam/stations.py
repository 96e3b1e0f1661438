"""Where along the wire the nodes of an equivalent beam stand."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from coilspring.errors import InputError
from coilspring.scene.spring import Spring


@dataclass(frozen=True)
class Stations:
    """Phases of the nodes, and what is between them.

    Attributes
    ----------
    phases : (n + 1,) phases of the nodes, rad, from 0 to the last active point.
    lengths : (n,) their axial lengths at rest, mm.
    plane : phase at which the wire crosses the working plane on its positive side, rad.
    """

    phases: np.ndarray
    lengths: np.ndarray
    plane: float

    @property
    def middles(self) -> np.ndarray:
        """Phases in the middle of the elements, rad."""
        return 0.5 * (self.phases[:-1] + self.phases[1:])


def half_coil_count(spring: Spring) -> int:
    """Number of half coils.

    Raises
    ------
    InputError : where the active coils are not a whole number of half coils.
    """
    count = round(2 * spring.active_coils)
    if abs(2 * spring.active_coils - count) > 1e-9:
        raise InputError(
            f"spring.active_coils must be a multiple of 0.5 in [0.5, 1000] for the equivalent beam, "
            f"got {spring.active_coils!r}"
        )
    return count


def half_coils(spring: Spring) -> Stations:
    """Nodes at phases k pi, where a wire that starts in the working plane crosses it."""
    count = half_coil_count(spring)
    phases = np.arange(count + 1) * math.pi
    # without sections half the pitch, without the rounding of differences
    lengths = np.diff(spring.height(phases)) if spring.sections else np.full(count, 0.5 * spring.pitch)
    return Stations(phases, lengths, -spring.start_phase)
