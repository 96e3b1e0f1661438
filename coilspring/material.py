"""Linear elastic isotropic material."""

from __future__ import annotations

from dataclasses import dataclass

from coilspring.errors import InputError, require_number


@dataclass(frozen=True)
class Material:
    """Isotropic material of the wire.

    The paper names no material: the default is an assumption for spring steel.
    """

    E: float = 206_000.0  # Young's modulus, MPa
    nu: float = 0.3  # Poisson's ratio

    def __post_init__(self) -> None:
        require_number("material.E", self.E, 0.0, 1e9, low_open=True)
        require_number("material.nu", self.nu, -1.0, 0.5, low_open=True)

    @property
    def G(self) -> float:
        """Shear modulus, MPa."""
        return self.E / (2.0 * (1.0 + self.nu))

    @classmethod
    def from_moduli(cls, E: float, G: float) -> Material:
        """Material given by its two moduli, MPa; E/3 <= G so that nu stays within (-1, 0.5]."""
        E = require_number("material.E", E, 0.0, 1e9, low_open=True)
        G = require_number("material.G", G, 0.0, 1e9, low_open=True)
        nu = E / (2.0 * G) - 1.0
        if nu > 0.5:
            raise InputError(f"material.G must be a number in [{E / 3.0:g}, inf) (E/3 at least), got {G!r}")
        return cls(E, nu)
