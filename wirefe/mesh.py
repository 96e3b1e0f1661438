"""Mesh of the wire: nodes on the helix and the top end's reference point."""

import math
from dataclasses import dataclass

import numpy as np

from coilspring.errors import InputError
from coilspring.scene.profile import TWO_PI
from coilspring.scene.spring import Spring

MOST_ELEMENTS = 2000  # of a turn
WHOLE = 1e-6  # by how much a number of elements may differ from a whole one
MOST_LOST = 0.05  # of the deflection, by chords, from which on it is said: 12 per turn lose 0.06


@dataclass(frozen=True)
class WireMesh:
    """Elastic wire between the two ends: its active part, or all of it where end turns rest on plates.

    Node 0 belongs to the bottom end, the last node is the top end's reference point, from which the
    wire's last point stands off by `arm`. On plates the wire has a node of its own at that point, too.
    """

    phases: np.ndarray  # (nodes,) of the wire's points
    points: np.ndarray  # (nodes, 3) at rest
    reference: np.ndarray  # (3,) top reference point at rest
    arm: np.ndarray  # (3,)

    @property
    def nodes(self) -> np.ndarray:
        """Nodes at rest, (nodes, 3): the points, but for the last one, which is the reference point."""
        return np.concatenate((self.points[:-1], self.reference[None]))


def mesh_wire(spring: Spring, elements_per_turn: int, on_plates: bool = False) -> WireMesh:
    """Nodes along the elastic wire, in equal elements.

    Raises
    ------
    InputError : where the active coils, or end turns on plates, are not a whole number of elements.
    """
    coils = "sections: the coils of all" if spring.sections else "active_coils"
    count = _elements(coils, spring.active_coils, elements_per_turn, 1000)
    first, last = 0.0, spring.phase_end
    if on_plates:
        count += 2 * _elements("end_turns", spring.end_turns, elements_per_turn, 100)
        first, last = spring.phase_range
    phases = np.linspace(first, last, count + 1)
    if on_plates:
        phases = np.append(phases, last)
    points = spring.points(phases)
    reference = np.array([0.0, spring.active_height, 0.0])
    return WireMesh(phases=phases, points=points, reference=reference, arm=points[-1] - reference)


def chord_warning(element: str, elements_per_turn: int, nu: float) -> str:
    """What a mesh of straight elements is too coarse for, or nothing."""
    lost = lost_by_chords(elements_per_turn, nu)
    if element != "straight" or lost < MOST_LOST:
        return ""
    return (
        f"; but {elements_per_turn} straight elements per turn are stiffer than the coil: without contact "
        f"an axial load deflects them by about {100.0 * lost:.2g} % less"
    )


def lost_by_chords(elements_per_turn: int, nu: float) -> float:
    """Share of a flat coil's axial deflection that the chords between its points lack.

    Those of half angle a are sin(a) / a of the wire, and nearer to the axis: an axial force F twists them by
    F R cos(a) in place of F R, and bends them by F s at s from their middle.
    """
    a = math.pi / elements_per_turn
    return 1.0 - math.sin(a) / a * (math.cos(a) ** 2 + math.sin(a) ** 2 / (3.0 * (1.0 + nu)))


def is_whole(elements: float) -> bool:
    """Whether so many elements are a whole number of them, but for rounding."""
    return abs(elements - round(elements)) <= WHOLE


def _elements(name: str, turns: float, elements_per_turn: int, most: int) -> int:
    """Number of elements in some turns of the wire."""
    count = round(turns * elements_per_turn)
    if count < 1 or not is_whole(turns * elements_per_turn):
        fits = (n for n in range(elements_per_turn, MOST_ELEMENTS + 1) if is_whole(turns * n))
        finer = next((f"; it is one of 1/{n}" for n in fits), "")
        raise InputError(
            f"spring.{name} must be a multiple of 1/{elements_per_turn} in [0.5, {most}] for the wire model "
            f"with elements_per_turn = {elements_per_turn}, got {turns!r}{finer}"
        )
    return count


def refuse_kinks(spring: Spring, mesh: WireMesh) -> None:
    """Refuse sections of the spring that meet within an element: curved ones are of one piece."""
    step = mesh.phases[1] - mesh.phases[0]
    count = round(TWO_PI / step)
    for number, knot in enumerate(spring.profile.knots[1:-1]):
        if not is_whole(knot / step):
            raise InputError(
                f"spring.sections[{number}] must end at a multiple of 1/{count} coils with element curved "
                f"and elements_per_turn = {count}, got an end at {knot / TWO_PI:g} coils"
            )
