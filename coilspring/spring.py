"""The spring at rest: a wire on a helix, closed end turns included."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from coilspring.errors import InputError, keep_numbers, require_choice, require_number, shown

HANDS = ("left", "right")
TWO_PI = 2.0 * math.pi
LONGEST = 1e9  # mm
RANGES = {
    "wire_diameter": (1e-6, 1e6),  # a fourth power of it must not vanish
    "active_coils": (0.5, 1000.0),
    "active_height": (1e-6, LONGEST),
    "end_turns": (0.0, 100.0),
    "start_phase": (-1e3, 1e3),
}


@dataclass(frozen=True)
class Spring:
    """Helical compression spring with coils of linearly varying diameter.

    The phase `phi` runs along the wire and is zero at the first active point, 2 pi n at the last;
    the closed end turns are the phases below and above. The axis is Y.

    Attributes
    ----------
    wire_diameter : d, mm.
    mean_diameter : coil diameters at the bottom and at the top of the active part, mm; one number
        stands for both.
    active_coils : n.
    active_height : axial length of the active part at rest, mm.
    end_turns : closed turns at each end, rigid, of pitch d; 0 or at least 0.5.
    start_phase : angle from X towards Z of the first active point, rad.
    hand : "left" is the helix as the project draws it, X = R cos, Z = R sin with Y rising; "right"
        is its mirror image in the X-Y plane.
    """

    wire_diameter: float
    mean_diameter: tuple[float, float]
    active_coils: float
    active_height: float
    end_turns: float = 1.0
    start_phase: float = 0.0
    hand: str = "left"

    def __post_init__(self) -> None:
        keep_numbers(self, "spring", RANGES)
        object.__setattr__(self, "mean_diameter", _both_ends(self.mean_diameter, self.wire_diameter))
        if 0.0 < self.end_turns < 0.5:
            raise InputError(f"spring.end_turns must be 0 or a number in [0.5, 100], got {self.end_turns!r}")
        require_choice("spring.hand", self.hand, HANDS)
        self._refuse_overlap()

    def _refuse_overlap(self) -> None:
        """Refuse neighbouring coils whose wires run into each other at rest."""
        d = self.wire_diameter
        step = abs(self.mean_diameter[1] - self.mean_diameter[0]) / 2.0 / self.active_coils
        # Coils of a cone may nest, but not where the cone passes into an end turn, a cylinder.
        least = d if self.end_turns > 0.0 else math.sqrt(max(d**2 - step**2, 0.0))
        if self.pitch < least * (1.0 - 1e-9):
            raise InputError(
                f"spring.active_height must be a number in [{least * self.active_coils:g}, "
                f"{RANGES['active_height'][1]:g}] so that the coils do not overlap at rest, "
                f"got {self.active_height!r}"
            )

    @property
    def pitch(self) -> float:
        """Axial distance of neighbouring active coils, mm."""
        return self.active_height / self.active_coils

    @property
    def phase_end(self) -> float:
        """Phase of the last active point, rad."""
        return TWO_PI * self.active_coils

    @property
    def phase_range(self) -> tuple[float, float]:
        """First and last phase of the wire, end turns included, rad."""
        ends = TWO_PI * self.end_turns
        return -ends, self.phase_end + ends

    def radius(self, phi: np.ndarray) -> np.ndarray:
        """Coil radius at the phases `phi`, mm: linear in the active part, constant in the end turns."""
        bottom, top = self.mean_diameter
        share = np.clip(np.asarray(phi) / self.phase_end, 0.0, 1.0)
        return 0.5 * (bottom + (top - bottom) * share)

    def height(self, phi: np.ndarray) -> np.ndarray:
        """Axial position of the wire at the phases `phi`, mm; pitch = wire diameter in the end turns."""
        phi = np.asarray(phi, dtype=float)
        active = np.clip(phi, 0.0, self.phase_end)
        return active * self.pitch / TWO_PI + (phi - active) * self.wire_diameter / TWO_PI

    def points(self, phi: np.ndarray) -> np.ndarray:
        """Wire centreline at rest, shape (len(phi), 3), mm."""
        phi = np.asarray(phi, dtype=float)
        radius = self.radius(phi)
        angle = phi + self.start_phase
        sign = 1.0 if self.hand == "left" else -1.0
        return np.stack((radius * np.cos(angle), self.height(phi), sign * radius * np.sin(angle)), axis=-1)

    def derivatives(self, phi: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """First and second derivative of the active wire's `points` in `phi`, each (len(phi), 3), mm."""
        phi = np.asarray(phi, dtype=float)
        bottom, top = self.mean_diameter
        radius, slope = self.radius(phi), 0.5 * (top - bottom) / self.phase_end
        c, s = np.cos(phi + self.start_phase), np.sin(phi + self.start_phase)
        sign = 1.0 if self.hand == "left" else -1.0
        rise = np.full_like(phi, self.pitch / TWO_PI)
        first = np.stack((slope * c - radius * s, rise, sign * (slope * s + radius * c)), axis=-1)
        second = (-2.0 * slope * s - radius * c, 0.0 * rise, sign * (2.0 * slope * c - radius * s))
        return first, np.stack(second, axis=-1)

    def circle_phases(self) -> np.ndarray:
        """Phases at which the wire crosses the working plane X-Y, end turns included, rad."""
        first, last = self.phase_range
        low = math.ceil((first + self.start_phase) / math.pi - 1e-9)
        high = math.floor((last + self.start_phase) / math.pi + 1e-9)
        return np.arange(low, high + 1) * math.pi - self.start_phase


def _both_ends(value: object, wire_diameter: float) -> tuple[float, float]:
    """Coil diameters at the bottom and at the top, of index 2 at least."""
    pair = value if isinstance(value, list | tuple) else (value, value)
    if len(pair) != 2:
        raise InputError(
            f"spring.mean_diameter must be one number or two (bottom, top), each at least twice the "
            f"wire diameter, got {shown(value)}"
        )
    least = 2.0 * wire_diameter  # index 2
    bottom, top = (require_number("spring.mean_diameter", end, least, LONGEST) for end in pair)
    return bottom, top
