"""The coiled wire drawn from the equivalent beam: rendering and what is read off its states."""

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from coilspring.compiling.packing import pack
from coilspring.contact.results import PairReader
from coilspring.scene import Scene
from coilspring.solver.stages import rates, reactions
from equivbeam import band, kernels
from equivbeam.model import BeamModel, matrix_size, rest_state, with_tangent


def element_measures(states: np.ndarray) -> np.ndarray:
    """l, v and dtheta of all elements by (B1), (states, elements, 3); `states` are flat, three a node."""
    nodes = states.reshape(len(states), -1, 3)
    ax, ay = np.moveaxis(np.diff(nodes[..., :2], axis=1), -1, 0)
    mean = 0.5 * (nodes[:, 1:, 2] + nodes[:, :-1, 2])
    c, s = np.cos(mean), np.sin(mean)
    return np.stack((ay * c - ax * s, ax * c + ay * s, np.diff(nodes[..., 2], axis=1)), axis=-1)


@dataclass(frozen=True)
class BeamShape(PairReader):
    """Reads the states of an equivalent beam; see `coilspring.path.Shape`."""

    scene: Scene
    data: BeamModel
    assembler: Callable[[], Callable]  # gives `assemble`: compiled code does not go with a pickled path

    @property
    def assemble(self) -> Callable:
        """The kernel with the path's law; `InputError` for a law that this process does not know."""
        return self.assembler()

    @property
    def update_history(self) -> Callable:
        """The model's kernel."""
        return kernels.update_history

    def _nodes(self, states: np.ndarray) -> np.ndarray:
        """Positions and rotations, shape (states, nodes, 3)."""
        return states.reshape(len(states), states.shape[1] // 3, 3)

    @property
    def rest(self) -> np.ndarray:
        """State at rest, flat."""
        return rest_state(self.data)

    def tips(self, states: np.ndarray) -> np.ndarray:
        """UX, UY, ROTZ of the last node, shape (states, 3)."""
        return self._nodes(states)[:, -1] - np.array([0.0, self.scene.spring.active_height, 0.0])

    @property
    def pair_law(self) -> BeamModel:
        """The model's arrays, which hold the law of its pairs."""
        return self.data

    def circles(self, states: np.ndarray) -> np.ndarray:
        """Centres of the contact circles, shape (states, circles, 2), mm."""
        return self._nodes(states)[:, self.data.attached, :2] + self.arms(states, self.data.offset)

    def arms(self, states: np.ndarray, offset: np.ndarray) -> np.ndarray:
        """Vectors (circles, 2) from the nodes at rest, turned as these are, shape (states, circles, 2)."""
        turn = self._nodes(states)[:, self.data.attached, 2]
        c, s = np.cos(turn), np.sin(turn)
        ox, oy = offset.T
        return np.stack((c * ox - s * oy, s * ox + c * oy), axis=-1)

    def pair_vectors(self, states: np.ndarray) -> np.ndarray:
        """Vectors between the centres of the pairs, shape (states, pairs, 3)."""
        centres = self.circles(states)
        first, second = self.data.pairs.T
        vectors = np.zeros((len(states), len(first), 3))
        vectors[..., :2] = centres[:, second] - centres[:, first]
        return vectors

    def reactions(self, states: np.ndarray, histories: np.ndarray) -> np.ndarray:
        """Force that holds the top along X and Y, shape (states, 2), N."""
        size = states.shape[1] - 3
        free = self.data._replace(fixed=self.data.fixed * np.array([0.0, 0.0, 1.0]))
        return reactions(self.assemble, free, size, size - 3, states, histories)

    def rates(self, states: np.ndarray, histories: np.ndarray | None, directions: np.ndarray) -> np.ndarray:
        """Tangent stiffness of the top along directions (states, 2), shape (states,), N/mm.

        The tangent is exact, even where the paper's matrix led to the states.
        """
        compiled, size = (self.assemble, band.factor, band.solve), states.shape[1] - 3
        sizes, remembered = (size, matrix_size(self.data)), self.histories(histories, states)
        return rates(compiled, with_tangent(self.data), sizes, size - 3, states, remembered, directions)

    def largest_stresses(self, states: np.ndarray, histories: np.ndarray | None) -> None:
        """Nothing: the beam has no wire."""

    def beyond_ends(self, states: np.ndarray) -> np.ndarray:
        """By how much circles are beyond the planes of the ends, shape (states,), mm; see
        `coilspring.path.Shape`."""
        centres, (low, high) = self.circles(states), self.scene.spring.tips
        x, y, theta = self._nodes(states)[:, -1].T[..., None]
        above = (centres[..., 1] - y) * np.cos(theta) - (centres[..., 0] - x) * np.sin(theta)
        return np.maximum(low - centres[..., 1].min(axis=1), above.max(axis=1) - high)

    def overlaps(self, states: np.ndarray) -> np.ndarray:
        """By how much circles overlap, shape (states,), mm; see `equivbeam.contact.circle_overlap`."""
        data = pack(self.data)
        return np.array([kernels.overlap(*data, state)[0] for state in states])

    def centreline(self, state: np.ndarray, phases: np.ndarray) -> np.ndarray:
        """Wire at the phases given, shape (phases, 3), mm.

        Between two nodes the axis and its rotation are interpolated linearly; the end turns move
        with the first and the last node.
        """
        spring = self.scene.spring
        nodes = state.reshape(-1, 3)
        station = np.clip(phases, 0.0, spring.phase_end) / math.pi
        lower = np.minimum(station.astype(int), len(nodes) - 2)
        share = (station - lower)[:, None]
        x, y, theta = ((1.0 - share) * nodes[lower] + share * nodes[lower + 1]).T
        rest = spring.points(phases)
        axis = np.interp(station, np.arange(len(nodes)), rest_state(self.data)[1::3])
        rise = rest[:, 1] - axis
        c, s = np.cos(theta), np.sin(theta)
        return np.stack((x + c * rest[:, 0] - s * rise, y + s * rest[:, 0] + c * rise, rest[:, 2]), axis=-1)
