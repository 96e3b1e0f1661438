"""What a user's law knows of a half coil."""

import math
from dataclasses import dataclass

from coilspring.scene.material import Material
from coilspring.scene.spring import Spring
from equivbeam.halfcoils import half_coils


@dataclass(frozen=True)
class HalfCoil:
    """A half coil of a spring at rest.

    Attributes
    ----------
    mean_diameter : mean coil diameter D in the middle of the half coil, mm.
    wire_diameter : d, mm.
    length : axial length at rest, mm.
    wire_length : length of its wire, of a helix of the mean diameter, mm.
    helix_angle : angle of that helix, rad.
    start_phase, end_phase : where it begins and ends, from the working plane about the axis, rad.
    hand : "left" or "right".
    E, G : moduli, MPa.
    index : number of the half coil from the bottom, from 0.
    """

    mean_diameter: float
    wire_diameter: float
    length: float
    wire_length: float
    helix_angle: float
    start_phase: float
    end_phase: float
    hand: str
    E: float
    G: float
    index: int


def spring_coils(spring: Spring, material: Material) -> list[HalfCoil]:
    """The half coils of a spring, from the bottom."""
    at = half_coils(spring)
    diameters, phases = 2.0 * spring.radius(at.middles), (at.phases + spring.start_phase).tolist()
    return [
        HalfCoil(
            mean_diameter=D,
            wire_diameter=spring.wire_diameter,
            length=length,
            wire_length=math.hypot(length, 0.5 * math.pi * D),
            helix_angle=math.atan(2.0 * length / (math.pi * D)),
            start_phase=phases[index],
            end_phase=phases[index + 1],
            hand=spring.hand,
            E=material.E,
            G=material.G,
            index=index,
        )
        for index, (D, length) in enumerate(zip(diameters.tolist(), at.lengths.tolist(), strict=True))
    ]
