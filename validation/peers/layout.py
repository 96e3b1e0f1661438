"""What a peer is given, the points, spheres and pairs of a scene's wire, and what it answers."""

import math
from dataclasses import dataclass

import numpy as np

from coilspring import InputError, Scene
from coilspring.curves import Curve
from coilspring.scene.load import stage_ends

PAIRS_PER_TURN = 4
NODES_PER_TURN = 40


@dataclass(frozen=True)
class PeerCurve:
    """Load curve of one code, as far as it was reached."""

    code: str  # its name
    times: np.ndarray  # (steps,) of the load
    tips: np.ndarray  # (steps, 3) UX, UY, ROTZ of the top reference point, mm, rad
    seconds: float  # CPU time of the solution
    iterations: int = 0  # Newton iterations of all steps, where they are known
    reaction: np.ndarray | None = None  # (steps,) axial force that holds the top, N, where UY is prescribed

    @property
    def curve(self) -> Curve:
        """What it answers to its load."""
        return Curve.answered(self.times, self.tips, self.reaction)


@dataclass(frozen=True)
class Layout:
    """The wire of a scene as points, and what touches; mm."""

    points: np.ndarray  # (nodes, 3) on the active wire, from the clamped bottom to the rigid top
    reference: np.ndarray  # (3,) top reference point
    spheres: np.ndarray  # (spheres, 3) centres
    attached: np.ndarray  # (spheres,) node of each: -1 the clamped bottom, `len(points)` the rigid top
    pairs: np.ndarray  # (pairs, 2) of spheres a turn apart, without those of one rigid end

    def rest(self, pair: np.ndarray) -> float:
        """Distance of the centres of a pair at rest, mm."""
        return float(np.linalg.norm(np.diff(self.spheres[pair], axis=0)))


def layout(scene: Scene, nodes_per_turn: int) -> Layout:
    """Points at `nodes_per_turn` equal phases a turn, which meet the coils' ends, and spheres at four."""
    spring = scene.spring
    last = round(spring.active_coils * nodes_per_turn)
    if last < 1 or abs(spring.active_coils * nodes_per_turn - last) > 1e-6:
        raise InputError(
            f"spring.active_coils must be a multiple of 1/{nodes_per_turn} in [0.5, 1000] for this peer, "
            f"got {spring.active_coils!r}"
        )
    first, end = (phase / (2.0 * math.pi) * PAIRS_PER_TURN for phase in spring.phase_range)
    index = np.arange(math.ceil(first - 1e-9), math.floor(end + 1e-9) + 1)
    nodes = index * (nodes_per_turn // PAIRS_PER_TURN)
    attached = np.where(nodes > last, last + 1, np.maximum(nodes, -1))
    pairs = np.stack((np.arange(len(index) - PAIRS_PER_TURN), np.arange(PAIRS_PER_TURN, len(index))), axis=1)
    low, high = np.clip(nodes, 0, last)[pairs].T  # node 0 and the last one move with their ends
    return Layout(
        points=spring.points(np.linspace(0.0, spring.phase_end, last + 1)),
        reference=np.array([0.0, spring.active_height, 0.0]),
        spheres=spring.points(2.0 * math.pi / PAIRS_PER_TURN * index),
        attached=attached,
        pairs=pairs[low != high] if scene.contact.enabled else pairs[:0],
    )


def amplitudes(scene: Scene) -> dict[int, list[tuple[float, float]]]:
    """What drives the top along X (1) and Y (2): points of time 0..1 and force, N, or of time and UY, mm.

    A direction in which nothing is given is left out.
    """
    columns = stage_ends(scene.load).T.tolist()
    times = np.linspace(0.0, 1.0, len(columns[0])).tolist()
    return {i: list(zip(times, column, strict=True)) for i, column in enumerate(columns, 1) if any(column)}


def refuse(scene: Scene, peer: str) -> None:
    """Raise `InputError` for what the peers are not given."""
    scene.supports.require_supported(peer)
    rigidity, contact = scene.spring.wire_rigidity, scene.contact
    beams, springs = "whose wire is one of beams", "which has springs between points"
    if rigidity != "beam":
        raise InputError(f'spring.wire_rigidity must be "beam" for {peer}, {beams}, got {rigidity!r}')
    if not contact.enabled:
        return
    if contact.geometry != "spheres":
        raise InputError(
            f'contact.geometry must be "spheres" for {peer}, {springs}, got {contact.geometry!r}; '
            "--geometry spheres takes them"
        )
    if contact.exponent != 1.0:
        raise InputError(f"contact.exponent must be 1 for {peer}, got {contact.exponent!r}")
    if contact.sliding == "coulomb":
        raise InputError(f'contact.sliding must be "free" or "none" for {peer}, got "coulomb"')
