"""Coils of a spring from bottom to top: radius and height as piecewise functions of the phase."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple, Self

import numpy as np

from coilspring.errors import InputError, require_number
from coilspring.scene.schema import KEYS
from coilspring.words import shown

TWO_PI = 2.0 * math.pi
LONGEST = 1e9  # mm
ACTIVE_COILS = KEYS["spring"]["active_coils"].checks["number"]
SECTION_COILS = (0.01, ACTIVE_COILS[1])
MOST_SECTIONS = 1000
SAME = 1e-9  # relative, of two numbers that must agree
OTHER_DIAMETERS = {"outer_diameter": -1.0, "inner_diameter": 1.0}  # wire diameters from there to the mean


@dataclass(frozen=True)
class CoilSection:
    """Coils between two heights, of constant or linearly varying pitch and diameter.

    Attributes
    ----------
    coils : number of turns.
    pitch : at the bottom and at the top of the section, linear in the turns, mm; one number stands for
        both. The height is its integral.
    mean_diameter : coil diameters at the bottom and at the top, linear in the turns, mm; one number
        stands for both.
    """

    coils: float
    pitch: tuple[float, float]
    mean_diameter: tuple[float, float]

    @classmethod
    def from_keys(cls, keys: Mapping[str, Any], wire_diameter: float, field: str) -> Self:
        """The section of a table of a scene file; `field` is its name in messages."""
        others = {name: keys.get(name) for name in OTHER_DIAMETERS}
        if not keys.keys() & others.keys():
            return cls(**keys)
        return cls(keys["coils"], keys["pitch"], mean_of(wire_diameter, field, **others))

    @property
    def height(self) -> float:
        """Axial length, mm."""
        return 0.5 * self.coils * (self.pitch[0] + self.pitch[1])

    def checked(self, field: str, wire_diameter: float) -> Self:
        """The section with its numbers as floats; `field` is its name in messages.

        Raises `InputError`: a number out of its range, or coils that overlap at rest.
        """
        return type(self)(
            require_number(f"{field}.coils", self.coils, *SECTION_COILS),
            both_ends(f"{field}.pitch", self.pitch, wire_diameter * (1.0 - SAME)),
            both_ends(f"{field}.mean_diameter", self.mean_diameter, 2.0 * wire_diameter),  # index 2
        )


def checked_sections(sections: object, wire_diameter: float) -> tuple[CoilSection, ...]:
    """Sections with their numbers as floats, each beginning with the diameter at which the last one ends.

    Raises `InputError`: see `CoilSection.checked`.
    """
    if not isinstance(sections, list | tuple) or not 1 <= len(sections) <= MOST_SECTIONS:
        raise InputError(f"spring.sections must be 1 to {MOST_SECTIONS} sections, got {shown(sections)}")
    checked: list[CoilSection] = []
    for number, section in enumerate(sections):
        field = f"spring.sections[{number}]"
        if not isinstance(section, CoilSection):
            raise InputError(f"{field} must be a CoilSection, got {shown(section)}")
        checked.append(section.checked(field, wire_diameter))
        below, here = checked[max(number - 1, 0)].mean_diameter, checked[-1].mean_diameter
        if number > 0 and not math.isclose(below[1], here[0], rel_tol=SAME):
            raise InputError(
                f"{field}.mean_diameter must begin with {below[1]!r}, where the section below it ends, "
                f"got {here[0]!r}"
            )
    coils = sum(section.coils for section in checked)
    require_number("the sum of the coils of spring.sections", coils, *ACTIVE_COILS)
    return tuple(checked)


def totals(sections: Sequence[CoilSection]) -> dict[str, Any]:
    """What sections make together: the spring's coils, height and diameters at both ends."""
    return {
        "mean_diameter": (sections[0].mean_diameter[0], sections[-1].mean_diameter[1]),
        "active_coils": sum(section.coils for section in sections),
        "active_height": sum(section.height for section in sections),
    }


def closest(wire_diameter: float, step: float) -> float:
    """Least pitch of coils that touch, each of a radius larger by `step` than its neighbour's, mm."""
    return math.sqrt(max(wire_diameter**2 - step**2, 0.0))


def both_ends(field: str, value: object, least: float) -> tuple[float, float]:
    """Two numbers, at the bottom and at the top, of at least `least`; one stands for both."""
    value = value.tolist() if isinstance(value, np.ndarray) else value
    pair = value if isinstance(value, list | tuple) else (value, value)
    if len(pair) != 2:
        raise InputError(
            f"{field} must be one number or two (bottom, top), each in [{least:g}, {LONGEST:g}], "
            f"got {shown(value)}"
        )
    bottom, top = (require_number(field, end, least, LONGEST) for end in pair)
    return bottom, top


def mean_of(wire_diameter: float, field: str, **given: object) -> tuple[float, float]:
    """Mean coil diameters of outer or inner ones, of which one is not None, mm; see `OTHER_DIAMETERS`."""
    names = [name for name, value in given.items() if value is not None]
    if len(names) != 1:
        found = " and ".join(names) or "none"
        raise InputError(f"{field} must have one of {' and '.join(OTHER_DIAMETERS)}, got {found}")
    wires = OTHER_DIAMETERS[names[0]]
    low, high = both_ends(f"{field}.{names[0]}", given[names[0]], (2.0 - wires) * wire_diameter)  # index 2
    return low + wires * wire_diameter, high + wires * wire_diameter


class Profile(NamedTuple):
    """Radius and height of coils; y = start + x (rise + bend x) at the phase x beyond a section's knot."""

    knots: np.ndarray  # (sections + 1,) phases where sections begin and end
    radii: np.ndarray  # (sections + 1,) there
    start: np.ndarray  # (sections,) height where each begins
    rise: np.ndarray  # (sections,) dy/dphi there
    bend: np.ndarray  # (sections,) half of d2y/dphi2

    def place(self, phi: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Section of each phase, and the phase beyond its knot; at a knot the section above counts."""
        section = np.searchsorted(self.knots[1:-1], phi, side="right")
        return section, phi - self.knots[section]

    def height(self, phi: np.ndarray) -> np.ndarray:
        """Height at the phases `phi`, mm."""
        section, x = self.place(phi)
        return self.start[section] + x * (self.rise[section] + self.bend[section] * x)

    def rates(self, phi: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """dR/dphi, dy/dphi and d2y/dphi2 at the phases `phi`, mm."""
        section, x = self.place(phi)
        slope = np.diff(self.radii) / np.diff(self.knots)
        return slope[section], self.rise[section] + 2.0 * self.bend[section] * x, 2.0 * self.bend[section]


def profile(sections: Sequence[CoilSection]) -> Profile:
    """Radius and height of sections one above the other."""
    coils = np.array([each.coils for each in sections])
    low, high = np.array([each.pitch for each in sections]).T / TWO_PI
    return Profile(
        knots=np.cumsum([0.0, *(TWO_PI * coils)]),
        radii=0.5 * np.array([sections[0].mean_diameter[0], *(each.mean_diameter[1] for each in sections)]),
        start=np.cumsum([0.0, *(each.height for each in sections)])[:-1],
        rise=low,
        bend=0.5 * (high - low) / TWO_PI / coils,
    )
