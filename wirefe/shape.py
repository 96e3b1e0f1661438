"""What is read off the wire model's states: tips, contact forces, the deformed wire."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from coilspring.compiling.packing import pack
from coilspring.contact.results import PairReader
from coilspring.scene import Scene
from coilspring.solver.stages import reactions
from wirefe import kernels, seated
from wirefe.mesh import WireMesh
from wirefe.model import ContactArrays, WireModel
from wirefe.overlap import carried
from wirefe.poses import ROW


def turned(q: np.ndarray, v: np.ndarray) -> np.ndarray:
    """Vectors v (..., 3) turned by the unit quaternions q (..., 4)."""
    t = 2.0 * np.cross(q[..., 1:], v)
    return v + q[..., :1] * t + np.cross(q[..., 1:], t)


def sphere_centres(contact: ContactArrays, states: np.ndarray) -> np.ndarray:
    """Centres of all spheres, shape (..., spheres, 3), in states (..., n), mm."""
    nodes = states.reshape(*states.shape[:-1], states.shape[-1] // ROW, ROW)
    carried = nodes[..., contact.attached, :]
    return carried[..., :3] + turned(carried[..., 3:], contact.offset)


@dataclass(frozen=True)
class WireShape(PairReader):
    """Reads the states of a wire model; see `coilspring.path.Shape`."""

    scene: Scene
    data: WireModel
    mesh: WireMesh

    def _nodes(self, states: np.ndarray) -> np.ndarray:
        return states.reshape(len(states), states.shape[1] // ROW, ROW)

    def tips(self, states: np.ndarray) -> np.ndarray:
        """UX, UY, ROTZ of the top reference point, shape (states, 3); mm, rad."""
        top = self._nodes(states)[:, -1]
        moved = top[:, :3] - self.mesh.reference
        # the top turns about Z alone; from state to state by less than half a turn
        angle = np.unwrap(np.concatenate(([0.0], 2.0 * np.arctan2(top[:, 6], top[:, 3]))))[1:]
        return np.column_stack((moved[:, 0], moved[:, 1], angle))

    @property
    def pair_law(self) -> ContactArrays:
        """The model's contact arrays, which hold the law of its pairs."""
        return self.data.contact

    def pair_vectors(self, states: np.ndarray) -> np.ndarray:
        """Vectors between the centres of the pairs, shape (states, pairs, 3), mm."""
        centres = sphere_centres(self.data.contact, states)
        first, second = self.data.contact.pairs.T
        return centres[:, second] - centres[:, first]

    def reactions(self, states: np.ndarray, histories: np.ndarray) -> np.ndarray:
        """Force that holds the top along Y, shape (states,), N."""
        size, part = 6 * (states.shape[1] // ROW), seated if len(self.data.plates.low) else kernels
        return reactions(part.assemble, self.data, size, size - 5, states, histories)

    def overlaps(self, states: np.ndarray) -> np.ndarray:
        """By how much the wire runs into itself, shape (states,), mm; below 0 where free."""
        data = pack(self.data)
        return np.array([kernels.overlap(*data, state)[0] for state in states])

    def plate_forces(self, states: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Normal forces of the bottom and of the top plate on the nodes `plates.low` and `plates.high` of the
        model, shapes (states, nodes), N; without nodes where end turns are rigid."""
        plates, nodes = self.data.plates, self._nodes(states)
        low = nodes[:, plates.low, 1] - plates.level
        normal = turned(nodes[:, -1, 3:], np.array([0.0, 1.0, 0.0]))[:, None]
        apart = nodes[:, -1:, :3] - nodes[:, plates.high, :3]
        high = (normal * apart).sum(axis=-1) - plates.depth
        return plates.stiffness * np.maximum(-low, 0.0), plates.stiffness * np.maximum(-high, 0.0)

    def centreline(self, state: np.ndarray, phases: np.ndarray) -> np.ndarray:
        """Wire at the phases given, shape (phases, 3), mm.

        See `wirefe.overlap.carried`.
        """
        node, share, arms = carried(self.scene.spring, self.mesh, phases)
        low, high = (state.reshape(-1, ROW)[n] for n in (node, node + 1))
        turn = turned(low[:, 3:], arms[:, :3]) + turned(high[:, 3:], arms[:, 3:])
        return turn + (1.0 - share[:, None]) * low[:, :3] + share[:, None] * high[:, :3]
