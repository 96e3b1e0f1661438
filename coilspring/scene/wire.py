"""Round wire: section properties and stiffnesses."""

from __future__ import annotations

import math
from dataclasses import dataclass

from coilspring.scene.material import Material

SHEAR_FACTOR = 0.9  # of a solid circular section (6/7..0.9 in the literature; the paper gives none)


@dataclass(frozen=True)
class Section:
    """Stiffnesses of a rod's cross section."""

    EA: float  # axial, N
    GA: float  # transverse shear, shear factor included, N
    GJ: float  # torsion, N mm^2
    EI: float  # bending, N mm^2


def round_section(diameter: float, material: Material) -> Section:
    """Section stiffnesses of a solid round wire.

    Parameters
    ----------
    diameter : wire diameter, mm.
    material : the wire's material.
    """
    area = math.pi * diameter**2 / 4.0
    inertia = math.pi * diameter**4 / 64.0
    return Section(
        EA=material.E * area,
        GA=SHEAR_FACTOR * material.G * area,
        GJ=material.G * 2.0 * inertia,
        EI=material.E * inertia,
    )
