"""Mesh of the wire: nodes on the helix, elements between them, contact spheres, numbering."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from coilspring.errors import InputError, require_integer
from coilspring.scene import Scene
from coilspring.scene.spring import Spring

TWO_PI = 2.0 * math.pi
PAIRS_OF_PENALTY = 4  # the scene's stiffness is that of a pair at 4 pairs per turn


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


def mesh_wire(spring: Spring, elements_per_turn: int, on_plates: bool = False) -> WireMesh:
    """Nodes along the elastic wire; the line mesh is scikit-fem's.

    Raises
    ------
    InputError : where the active coils, or end turns on plates, are not a whole number of elements.
    """
    from skfem import MeshLine

    count = _elements("active_coils", spring.active_coils, elements_per_turn, 1000)
    first, last = 0.0, spring.phase_end
    if on_plates:
        count += 2 * _elements("end_turns", spring.end_turns, elements_per_turn, 100)
        first, last = spring.phase_range
    phases = MeshLine(np.linspace(first, last, count + 1)).p[0]
    if on_plates:
        phases = np.append(phases, last)
    points = spring.points(phases)
    reference = np.array([0.0, spring.active_height, 0.0])
    return WireMesh(phases=phases, points=points, reference=reference, arm=points[-1] - reference)


def _elements(name: str, turns: float, elements_per_turn: int, most: int) -> int:
    """Number of elements in some turns of the wire."""
    count = round(turns * elements_per_turn)
    if count < 1 or abs(turns * elements_per_turn - count) > 1e-6:
        raise InputError(
            f"spring.{name} must be a multiple of 1/{elements_per_turn} (1/elements_per_turn) in "
            f"[0.5, {most}] for the wire model, got {turns!r}"
        )
    return count


def refuse_kinks(spring: Spring, mesh: WireMesh) -> None:
    """Refuse sections of the spring that meet within an element: curved ones are of one piece."""
    step = mesh.phases[1]
    for number, knot in enumerate(spring.profile.knots[1:-1], 1):
        if abs(knot / step - round(knot / step)) > 1e-6:
            raise InputError(
                f"spring.sections[{number}] must end at a multiple of 1/{round(TWO_PI / step)} coils "
                f"(1/elements_per_turn) with element curved, got an end at {knot / TWO_PI:g} coils"
            )


@dataclass(frozen=True)
class Spheres:
    """Contact spheres, the pairs that may touch, and their law."""

    attached: np.ndarray  # (spheres,) node to which each is attached
    arm: np.ndarray  # (spheres, 3) from the node's point to the centre, at rest
    pairs: np.ndarray  # (pairs, 2), from bottom to top
    diameter: float
    stiffness: float  # of a pair
    exponent: float
    near: int  # spheres so near each other along the wire do not touch: half a turn
    apart: float  # least gap at rest of spheres that are no pair
    friction: float  # coefficient: 0 without friction, infinite where closed pairs do not slide


def no_spheres() -> Spheres:
    """A wire that touches nothing."""
    whole = np.zeros(0, dtype=np.int64)
    return Spheres(whole, np.zeros((0, 3)), whole.reshape(0, 2), 1.0, 1.0, 1.0, 0, math.inf, 0.0)


def place_spheres(
    scene: Scene,
    mesh: WireMesh,
    elements_per_turn: int,
    pairs_per_turn: int,
    found: np.ndarray | None = None,
) -> Spheres:
    """Spheres at `pairs_per_turn` phases a turn, end turns included, each paired one turn above.

    The stiffness per length of wire is kept: K * 4 / pairs. Pairs inside one rigid end are left out;
    the pairs `found` are added.
    """
    require_integer("pairs_per_turn", pairs_per_turn, 1, 1000)
    if elements_per_turn % pairs_per_turn:
        raise InputError(
            f"elements_per_turn must be a multiple of pairs_per_turn = {pairs_per_turn}, "
            f"got {elements_per_turn!r}"
        )
    spring = scene.spring
    stride = elements_per_turn // pairs_per_turn
    last = len(mesh.phases) - 1
    first, end = (phase / TWO_PI * pairs_per_turn for phase in spring.phase_range)
    index = np.arange(math.ceil(first - 1e-9), math.floor(end + 1e-9) + 1)
    phases = index * TWO_PI / pairs_per_turn
    start = round(mesh.phases[0] / TWO_PI * elements_per_turn)
    attached = np.clip(index * stride - start, 0, last)
    rest = np.concatenate((mesh.points[:-1], mesh.reference[None]))
    pairs = np.stack((np.arange(len(index) - pairs_per_turn), np.arange(pairs_per_turn, len(index))), axis=1)
    pairs = pairs[attached[pairs[:, 0]] != attached[pairs[:, 1]]]
    if found is not None:
        pairs = np.concatenate((pairs, found))
    near = pairs_per_turn // 2
    _, gaps = near_pairs(spring.points(phases), attached, pairs, near, np.inf)
    return Spheres(
        attached=attached,
        arm=spring.points(phases) - rest[attached],
        pairs=pairs if scene.contact.enabled else pairs[:0],
        diameter=spring.wire_diameter,
        stiffness=scene.contact.stiffness * PAIRS_OF_PENALTY / pairs_per_turn,
        exponent=float(scene.contact.exponent),
        near=near,
        apart=float(gaps.min(initial=np.inf)) - spring.wire_diameter,
        friction=scene.contact.coefficient,
    )


def near_pairs(
    centres: np.ndarray, attached: np.ndarray, pairs: np.ndarray, near: int, reach: float
) -> tuple[np.ndarray, np.ndarray]:
    """Spheres that are no pair, with centres nearer than `reach`: (n, 2), and their distances (n,).

    Spheres up to `near` apart along the wire, or carried by one node, do not touch.
    """
    first, second = np.triu_indices(len(centres), near + 1)
    distance = np.linalg.norm(centres[second] - centres[first], axis=1)
    count = len(centres)
    new = ~np.isin(first * count + second, pairs[:, 0] * count + pairs[:, 1])
    keep = new & (distance < reach) & (attached[first] != attached[second])
    return np.stack((first[keep], second[keep]), axis=1), distance[keep]
