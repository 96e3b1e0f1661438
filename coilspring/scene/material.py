"""Linear elastic isotropic material."""

from __future__ import annotations

from dataclasses import dataclass

from coilspring.errors import InputError, keep_numbers, require_number, shown

MODULI = (1e-3, 1e9)  # MPa
RANGES = {"E": MODULI, "nu": (-0.999, 0.5)}


@dataclass(frozen=True)
class Material:
    """Isotropic material of the wire.

    The paper names no material: the default is an assumption for spring steel.
    """

    E: float = 206_000.0  # Young's modulus, MPa
    nu: float = 0.3  # Poisson's ratio

    def __post_init__(self) -> None:
        keep_numbers(self, "material", RANGES)

    @property
    def G(self) -> float:
        """Shear modulus, MPa."""
        return self.E / (2.0 * (1.0 + self.nu))

    @classmethod
    def from_moduli(cls, E: float, G: float) -> Material:
        """Material given by its two moduli, MPa; their ratio must leave nu within its range."""
        E = require_number("material.E", E, *MODULI)
        G = require_number("material.G", G, *MODULI)
        least, most = RANGES["nu"]
        low, high = E / (2.0 * (1.0 + most)), E / (2.0 * (1.0 + least))
        if not low <= G <= high:
            raise InputError(
                f"material.G must be a number in [{low:g}, {high:g}], which E = {E:g} and Poisson's ratio "
                f"allow, got {shown(G)}"
            )
        return cls(E, min(max(E / (2.0 * G) - 1.0, least), most))  # rounding may pass the ends
