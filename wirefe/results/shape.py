"""What is read off the wire model's states: tips, contact forces, the deformed wire."""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from coilspring.compiling.packing import pack
from coilspring.contact.forces import tangential_sizes
from coilspring.contact.results import PairReader
from coilspring.scene import Scene
from coilspring.solver.stages import rates, reactions
from wirefe import kernels, seated
from wirefe.contact.points import ContactArrays
from wirefe.contact.stations import (
    across_wires,
    carried,
    fixed_to_sections,
    of_wires,
    rows,
    stations_in,
    turned_rows,
)
from wirefe.element.poses import at_rest
from wirefe.mesh import WireMesh
from wirefe.model import WireModel, matrix_size
from wirefe.results.stress import largest_stresses

END_POINTS = 32  # of a rigid end turn, compared with the plane of the other end


def contact_vectors(contact: ContactArrays, states: np.ndarray) -> np.ndarray:
    """Vectors across the gaps of all pairs, of the length h, shape (states, pairs, 3), mm."""
    if not len(contact.pairs):
        return np.zeros((len(states), 0, 3))
    first, second = contact.pairs.T
    if not of_wires(contact.parts):
        centres = contact_centres(contact, states)
        return centres[:, second] - centres[:, first]
    x, t = stations_in(states, contact.attached, contact.parts)
    w = x[:, second] - x[:, first]
    return across_wires(w, t[:, first] + t[:, second], contact.rest_overlap)


def contact_centres(contact: ContactArrays, states: np.ndarray) -> np.ndarray:
    """Contact points, shape (states, points, 3), in states (states, n), mm."""
    if of_wires(contact.parts):
        return stations_in(states, contact.attached, contact.parts)[0]
    own = rows(states)[:, contact.attached]
    return own[..., :3] + turned_rows(own[..., 3:], contact.parts)


@dataclass(frozen=True)
class WireShape(PairReader):
    """Reads the states of a wire model; see `coilspring.path.Shape`."""

    scene: Scene
    data: WireModel
    mesh: WireMesh

    @property
    def rest(self) -> np.ndarray:
        """State at rest, flat."""
        return at_rest(self.mesh.nodes).ravel()

    def tips(self, states: np.ndarray) -> np.ndarray:
        """UX, UY, ROTZ of the top reference point, shape (states, 3); mm, rad."""
        nodes = rows(states)
        top, turned = nodes[:, -1], nodes[..., 3:]
        moved = top[:, :3] - self.mesh.reference
        # q and -q are one orientation; along the wire, which turns little from node to node, one follows
        same = np.column_stack((turned[:, 0, 0], (turned[:, 1:] * turned[:, :-1]).sum(axis=-1))) >= 0.0
        sign = np.where(same, 1.0, -1.0).prod(axis=1)
        # the top turns about Z alone: that is its angle but for two whole turns, from state to state by less
        angle = 2.0 * np.arctan2(sign * top[:, 6], sign * top[:, 3])
        angle = np.unwrap(np.concatenate(([0.0], angle)), period=4.0 * np.pi)[1:]
        return np.column_stack((moved[:, 0], moved[:, 1], angle))

    @property
    def pair_law(self) -> ContactArrays:
        """The model's contact arrays, which hold the law of its pairs."""
        return self.data.contact

    @property
    def pair_stiffness(self) -> np.ndarray:
        """Penalty of each pair, (pairs,), N/mm^k."""
        return self.data.contact.kc * self.data.contact.weights

    def pair_vectors(self, states: np.ndarray) -> np.ndarray:
        """Vectors across the gaps of the pairs, shape (states, pairs, 3), mm."""
        return contact_vectors(self.data.contact, states)

    def tangential_forces(self, states: np.ndarray, histories: np.ndarray) -> np.ndarray:
        """See `coilspring.contact.results.PairReader`; of wires at the material points that touched first."""
        contact = self.data.contact
        if not (len(contact.pairs) and of_wires(contact.parts)):
            return super().tangential_forces(states, histories)
        n = contact_vectors(contact, states)
        n /= np.linalg.norm(n, axis=-1, keepdims=True)
        centres = contact_centres(contact, states)
        first, second = (
            centres[:, side]
            + fixed_to_sections(rows(states), contact.attached[side], contact.parts[side], arms)
            for side, arms in zip(contact.pairs.T, np.split(histories["arms"], 2, axis=-1), strict=True)
        )
        slip = second - first
        slip -= (slip * n).sum(axis=-1, keepdims=True) * n
        length = np.linalg.norm(slip, axis=-1)
        force = tangential_sizes(length, histories)
        share = np.divide(force, length, out=np.zeros_like(force), where=length > 0.0)
        return share[..., None] * slip

    def beyond_ends(self, states: np.ndarray) -> np.ndarray:
        """By how much the wire is beyond the planes of the ends, (states,), mm; see `coilspring.path.Shape`.

        Its nodes, and rigid end turns, each at the other end: there they come where the top tilts alone.
        """
        nodes, (low, high) = rows(states), self.scene.spring.tips
        place, turn, wire = nodes[:, -1:, :3], nodes[:, -1:, 3:], nodes[:, :-1, :3]
        normal = turned_rows(turn, np.array([0.0, 1.0, 0.0]))
        below = low - wire[..., 1].min(axis=1)
        above = ((wire - place) * normal).sum(axis=-1).max(axis=1) - high
        if "rotz" not in self.scene.supports.top_held:
            bottom, arms = self._rigid_ends
            below = np.maximum(below, low - (place + turned_rows(turn, arms))[..., 1].min(axis=1))
            above = np.maximum(above, ((bottom - place) * normal).sum(axis=-1).max(axis=1) - high)
        return np.maximum(below, above)

    @cached_property
    def _rigid_ends(self) -> tuple[np.ndarray, np.ndarray]:
        """Points at rest of the wire below its first node, and arms to those above its last, (points, 3)."""
        spring, phases = self.scene.spring, self.mesh.phases
        first, last = spring.phase_range
        beyond = np.linspace((first, phases[-1]), (phases[0], last), END_POINTS, axis=1)
        below, above = np.split(spring.points(beyond.ravel()), 2)
        return below, above - self.mesh.reference

    @property
    def size(self) -> int:
        """Number of degrees of freedom, held ones included."""
        return 6 * len(self.data.elements.triads) + 6

    @property
    def update_history(self) -> Callable:
        """The model's kernel; that for plates differs in the least gap alone."""
        return kernels.update_history

    @property
    def assemble(self) -> Callable:
        """The kernel of the model: with plates, or without."""
        return (seated if len(self.data.plates.node) else kernels).assemble

    def reactions(self, states: np.ndarray, histories: np.ndarray) -> np.ndarray:
        """Force that holds the top along X and Y, shape (states, 2), N."""
        held, top = self.data.held, self.size - 6
        data = self.data._replace(held=held._replace(dof=held.dof[(held.dof < top) | (held.dof > top + 1)]))
        return reactions(self.assemble, data, self.size, top, states, histories)

    def rates(self, states: np.ndarray, histories: np.ndarray | None, directions: np.ndarray) -> np.ndarray:
        """Tangent stiffness of the top along directions (states, 2), shape (states,), N/mm."""
        compiled, sizes = (self.assemble, kernels.factor, kernels.solve), (self.size, matrix_size(self.data))
        remembered = self.histories(histories, states)
        return rates(compiled, self.data, sizes, self.size - 6, states, remembered, directions)

    def largest_stresses(self, states: np.ndarray, histories: np.ndarray | None) -> np.ndarray:
        """Largest shear stress of the wire, corrected for its curvature, shape (states,), MPa."""
        return largest_stresses(self, states, histories)

    def overlaps(self, states: np.ndarray) -> np.ndarray:
        """By how much the wire runs into itself, shape (states,), mm; below 0 where free."""
        data = pack(self.data)
        return np.array([kernels.overlap(*data, state)[0] for state in states])

    def centreline(self, state: np.ndarray, phases: np.ndarray) -> np.ndarray:
        """Wire at the phases given, shape (phases, 3), mm."""
        return stations_in(state[None], *carried(self.scene.spring, self.mesh, phases))[0][0]
