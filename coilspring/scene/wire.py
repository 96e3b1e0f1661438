"""Round wire: section properties and stiffnesses."""

import math
from dataclasses import dataclass

import numpy as np

from coilspring.errors import require_number
from coilspring.scene.material import Material
from coilspring.scene.schema import KEYS

LOW, HIGH = KEYS["spring"]["wire_diameter"].checks["number"]  # mm
SHEAR_FACTOR = 0.9  # of a solid circular section (6/7..0.9 in the literature; the paper gives none)
Stiffness = float | np.ndarray  # an array has one for each piece of a wire


@dataclass(frozen=True)
class Section:
    """Stiffnesses of a rod's cross section."""

    EA: Stiffness  # axial, N
    GA: Stiffness  # transverse shear, shear factor included, N
    GJ: Stiffness  # torsion, N mm^2
    EI: Stiffness  # bending, N mm^2


def round_section(diameter: float, material: Material) -> Section:
    """Section stiffnesses of a solid round wire of a diameter in mm."""
    require_number("diameter", diameter, LOW, HIGH)
    area = math.pi * diameter**2 / 4.0
    inertia = math.pi * diameter**4 / 64.0
    return Section(
        EA=material.E * area,
        GA=SHEAR_FACTOR * material.G * area,
        GJ=material.G * 2.0 * inertia,
        EI=material.E * inertia,
    )
