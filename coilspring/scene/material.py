"""Linear elastic isotropic material."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, Self

from coilspring.errors import InputError
from coilspring.scene.schema import KEYS, keep_checked
from coilspring.words import shown

MODULUS = KEYS["material"]["E"].check
POISSON = KEYS["material"]["nu"].checks["number"]


@dataclass(frozen=True)
class Material:
    """Isotropic material of the wire.

    The paper names no material: the default is an assumption for spring steel. The density is for natural
    frequencies alone.
    """

    E: float = 206_000.0
    nu: float = 0.3
    density: float = field(default=7850.0, kw_only=True)

    def __post_init__(self) -> None:
        keep_checked(self, "material")

    @property
    def G(self) -> float:
        """Shear modulus, MPa."""
        return self.E / (2.0 * (1.0 + self.nu))

    @classmethod
    def from_keys(cls, keys: Mapping[str, Any]) -> Self:
        """Material of the keys of a scene file: E and nu, or E and G."""
        if "G" not in keys:
            return cls(**keys)
        return cls.from_moduli(keys.get("E", cls.E), keys["G"], keys.get("density", cls.density))

    @classmethod
    def from_moduli(cls, E: float, G: float, density: float = 7850.0) -> Self:
        """Material given by its two moduli, MPa; their ratio must leave nu within its range."""
        E, G = MODULUS("material.E", E), MODULUS("material.G", G)
        least, most = POISSON
        low, high = E / (2.0 * (1.0 + most)), E / (2.0 * (1.0 + least))
        if not low <= G <= high:
            raise InputError(
                f"material.G must be a number in [{low:g}, {high:g}], which E = {E:g} and Poisson's ratio "
                f"allow, got {shown(G)}"
            )
        nu = min(max(E / (2.0 * G) - 1.0, least), most)  # rounding may pass the ends
        return cls(E, nu, density=density)
