"""The spring at rest: a wire on a helix, end turns included."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any, Self

import numpy as np

from coilspring.errors import InputError
from coilspring.scene.profile import (
    LONGEST,
    OTHER_DIAMETERS,
    SAME,
    TWO_PI,
    CoilSection,
    Profile,
    both_ends,
    checked_sections,
    closest,
    mean_of,
    profile,
    totals,
)
from coilspring.scene.schema import KEYS, keep_checked

WIRE = KEYS["spring"]["wire_diameter"].check
BESIDE = 1e-9  # rad: so far on both sides of a phase are the tangents whose mean is taken


@dataclass(frozen=True)
class Spring:
    """Helical compression spring with coils of linearly varying diameter, or of several sections.

    The phase `phi` runs along the wire and is zero at the first active point, 2 pi n at the last;
    the end turns are the phases below and above. The axis is Y.

    Attributes
    ----------
    wire_diameter : d, mm.
    mean_diameter : coil diameters at the bottom and at the top of the active part, mm; one number
        stands for both.
    active_coils : n.
    active_height : axial length of the active part at rest, mm.
    end_turns : turns at each end that are not active; 0 or at least 0.5.
    start_phase : angle of the first active point, rad: from X towards Z, of a right-handed spring towards -Z.
    hand : "left" is the helix as the project draws it, X = R cos, Z = R sin with Y rising; "right"
        is its mirror image in the X-Y plane.
    ends : "closed" end turns have the pitch d, "open" ones keep that of the coils next to them.
    wire_rigidity : "beam" is that of a straight wire with shear, "solid" that of the coiled wire by
        three-dimensional elasticity.
    sections : of the active part from bottom to top, as `Spring.of_sections` takes them; empty for coils
        of one pitch and linearly varying diameter.
    """

    wire_diameter: float
    mean_diameter: tuple[float, float]
    active_coils: float
    active_height: float
    end_turns: float = 1.0
    ends: str = field(default="closed", kw_only=True)
    start_phase: float = 0.0
    hand: str = "left"
    wire_rigidity: str = field(default="beam", kw_only=True)
    sections: tuple[CoilSection, ...] = ()

    def __post_init__(self) -> None:
        keep_checked(self, "spring")
        diameters = both_ends("spring.mean_diameter", self.mean_diameter, 2.0 * self.wire_diameter)  # index 2
        object.__setattr__(self, "mean_diameter", diameters)
        if 0.0 < self.end_turns < 0.5:
            raise InputError(f"spring.end_turns must be 0 or a number in [0.5, 100], got {self.end_turns!r}")
        if self.sections:
            self._keep_sections()
        else:
            self._refuse_overlap()

    @classmethod
    def from_keys(cls, keys: Mapping[str, Any]) -> Self:
        """Spring of the keys of a scene file: of one kind of coils, or of tables for its sections."""
        if "sections" in keys:
            d = WIRE("spring.wire_diameter", keys["wire_diameter"])
            tables = enumerate(keys["sections"])
            sections = [CoilSection.from_keys(table, d, f"spring.sections[{n}]") for n, table in tables]
            return cls.of_sections(**{**keys, "sections": sections})
        return cls.of_diameter(**keys) if keys.keys() & OTHER_DIAMETERS.keys() else cls(**keys)

    @classmethod
    def of_diameter(
        cls,
        wire_diameter: float,
        *,
        outer_diameter: float | tuple[float, float] | None = None,
        inner_diameter: float | tuple[float, float] | None = None,
        **others: Any,
    ) -> Self:
        """Spring of the outer or the inner diameter of its coils, mm: at bottom and top, or one number.

        `others` are `active_coils`, `active_height` and what else a spring has but `mean_diameter`.

        Raises
        ------
        InputError : a number out of its range, or none or several of the diameters.
        """
        if "mean_diameter" in others:
            names = ("outer_diameter", outer_diameter), ("inner_diameter", inner_diameter)
            found = " and ".join(["mean_diameter", *(name for name, value in names if value is not None)])
            raise InputError(
                f"spring must have one of mean_diameter, outer_diameter and inner_diameter, got {found}"
            )
        d = WIRE("spring.wire_diameter", wire_diameter)
        mean = mean_of(d, "spring", outer_diameter=outer_diameter, inner_diameter=inner_diameter)
        return cls(d, mean, **others)

    @classmethod
    def of_sections(cls, wire_diameter: float, sections: Sequence[CoilSection], **others: Any) -> Self:
        """Spring of sections from bottom to top; `others` are its end turns, start phase, hand and ends.

        Raises
        ------
        InputError : a number out of its range, or diameters that differ where two sections meet.
        """
        d = WIRE("spring.wire_diameter", wire_diameter)
        checked = checked_sections(sections, d)
        return cls(d, **totals(checked), **others, sections=checked)

    def _keep_sections(self) -> None:
        """Check the sections, and that the numbers of the whole spring are theirs."""
        object.__setattr__(self, "sections", checked_sections(self.sections, self.wire_diameter))
        for name, total in totals(self.sections).items():
            given = getattr(self, name)
            if not np.allclose(given, total, rtol=SAME, atol=0.0):
                raise InputError(
                    f"spring.{name} must be {total!r}, as spring.sections have it, got {given!r}"
                )

    def _refuse_overlap(self) -> None:
        """Refuse neighbouring coils whose wires run into each other at rest."""
        d = self.wire_diameter
        step = abs(self.mean_diameter[1] - self.mean_diameter[0]) / 2.0 / self.active_coils
        # Coils of a cone may nest, but not where the cone passes into an end turn, a cylinder.
        least = d if self.end_turns > 0.0 else closest(d, step)
        if self.pitch < least * (1.0 - SAME):
            raise InputError(
                f"spring.active_height must be a number in [{least * self.active_coils:g}, "
                f"{LONGEST:g}] so that the coils do not overlap at rest, got {self.active_height!r}"
            )

    @property
    def pitch(self) -> float:
        """Axial distance of neighbouring active coils, mm; of several sections, its mean."""
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

    @cached_property
    def coils(self) -> tuple[CoilSection, ...]:
        """The active part as sections: one, unless it has several."""
        pitch = (self.pitch, self.pitch)
        return self.sections or (CoilSection(self.active_coils, pitch, self.mean_diameter),)

    @cached_property
    def profile(self) -> Profile:
        """Radius and height of the active part."""
        return profile(self.coils)

    @property
    def end_pitch(self) -> tuple[float, float]:
        """Pitch of the end turns at the bottom and at the top, mm."""
        if self.ends == "closed":
            return self.wire_diameter, self.wire_diameter
        return self.coils[0].pitch[0], self.coils[-1].pitch[1]

    @property
    def tips(self) -> tuple[float, float]:
        """Height of the wire's tips over the bottom and the top of its active part, mm."""
        low, high = self.end_pitch
        return -self.end_turns * low, self.end_turns * high

    def radius(self, phi: np.ndarray) -> np.ndarray:
        """Coil radius at the phases `phi`, mm: piecewise linear, constant in the end turns."""
        return np.interp(phi, self.profile.knots, self.profile.radii)

    def height(self, phi: np.ndarray) -> np.ndarray:
        """Axial position of the wire at the phases `phi`, mm: the integral of the pitch."""
        phi = np.asarray(phi, dtype=float)
        active = np.clip(phi, 0.0, self.phase_end)
        low, high = self.end_pitch
        ends = (phi - active) * (np.where(phi < 0.0, low, high) / TWO_PI)
        return self.profile.height(active) + ends

    def rise(self, phi: np.ndarray) -> np.ndarray:
        """Axial advance of the wire per phase, mm: pitch over 2 pi; where two pitches meet, the upper one."""
        low, high = self.end_pitch
        active = self.profile.rates(np.clip(phi, 0.0, self.phase_end))[1]
        return np.where(phi < 0.0, low / TWO_PI, np.where(phi > self.phase_end, high / TWO_PI, active))

    def points(self, phi: np.ndarray) -> np.ndarray:
        """Wire centreline at rest, shape (len(phi), 3), mm."""
        phi = np.asarray(phi, dtype=float)
        return self._turned(phi, self.radius(phi), 0.0, self.height(phi))

    def derivatives(self, phi: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """First and second derivative of the active wire's `points` in `phi`, each (len(phi), 3), mm.

        Where two sections meet, those of the upper one.
        """
        phi = np.asarray(phi, dtype=float)
        slope, rise, bend = self.profile.rates(phi)
        radius = self.radius(phi)
        return self._turned(phi, slope, radius, rise), self._turned(phi, -radius, 2.0 * slope, bend)

    def inward(self, phi: np.ndarray) -> np.ndarray:
        """Second derivative of `points` in `phi`, end turns included, (len(phi), 3), mm: across the wire it
        is towards the centre of curvature. Where two sections meet, that of the upper one."""
        active = np.clip(phi, 0.0, self.phase_end)
        slope, _, bend = self.profile.rates(active) * (active == phi)
        return self._turned(phi, -self.radius(phi), 2.0 * slope, bend)

    def tangents(self, phi: np.ndarray) -> np.ndarray:
        """First derivative of `points` in `phi`, end turns included, (len(phi), 3), mm.

        Where two sections meet, or the end turns begin, the mean of both sides.
        """
        beside = np.asarray(phi, dtype=float) + np.array([[-BESIDE], [BESIDE]])
        active = np.clip(beside, 0.0, self.phase_end)
        slope = self.profile.rates(active)[0] * (beside == active)
        return self._turned(beside, slope, self.radius(beside), self.rise(beside)).mean(axis=0)

    def _turned(
        self, phi: np.ndarray, along: np.ndarray, across: np.ndarray | float, axial: np.ndarray
    ) -> np.ndarray:
        """Vectors of parts along the radius at the phases `phi`, across it as the wire turns, and axial."""
        angle = phi + self.start_phase
        c, s = np.cos(angle), np.sin(angle)
        sign = 1.0 if self.hand == "left" else -1.0
        return np.stack((along * c - across * s, axial, sign * (along * s + across * c)), axis=-1)

    def circle_phases(self) -> np.ndarray:
        """Phases at which the wire crosses the working plane X-Y, end turns included, rad."""
        first, last = self.phase_range
        low = math.ceil((first + self.start_phase) / math.pi - 1e-9)
        high = math.floor((last + self.start_phase) / math.pi + 1e-9)
        return np.arange(low, high + 1) * math.pi - self.start_phase
