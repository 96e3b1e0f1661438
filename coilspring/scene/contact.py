"""Law of the contact between coils."""

from __future__ import annotations

import math
from dataclasses import dataclass

from coilspring.errors import InputError, require_number, shown
from coilspring.scene.schema import keep_checked


@dataclass(frozen=True)
class Contact:
    """Penalty law of the coil contact, F = K max(0, d - h)^exponent between neighbouring coils.

    Attributes
    ----------
    enabled : False lets coils pass through each other.
    stiffness : K of each pair at 4 pairs per turn, N/mm^exponent; more pairs share it.
    exponent : of the penetration.
    sliding : "free", "none" (sticking contact), or "coulomb" (with friction).
    friction : coefficient, with "coulomb" alone.
    geometry : of the wire model's contact: the "wires" themselves, whose gap is taken across both, or
        "spheres" on them, as the paper has it; the equivalent beam has circles either way.
    """

    enabled: bool = True
    stiffness: float = 1.0e4
    exponent: float = 1.0
    sliding: str = "free"
    geometry: str = "wires"
    friction: float | None = None

    def __post_init__(self) -> None:
        keep_checked(self, "contact")
        if self.sliding == "coulomb":
            value = require_number("contact.friction", self.friction, 1e-6, 10.0)
            object.__setattr__(self, "friction", value)
        elif self.friction is not None:
            raise InputError(
                f'contact.friction goes with contact.sliding = "coulomb" alone, got {shown(self.friction)} '
                f"with {shown(self.sliding)}"
            )

    @property
    def coefficient(self) -> float:
        """Coefficient of friction: 0 for sliding "free", infinite for "none"."""
        return {"free": 0.0, "none": math.inf}.get(self.sliding, self.friction or 0.0)
