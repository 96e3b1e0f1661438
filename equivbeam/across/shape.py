"""What is read off the states of the beam in the plane across."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from coilspring.driving import reactions
from coilspring.packing import pack
from coilspring.pairreader import PairReader
from coilspring.scene import Scene
from equivbeam.across import kernels
from equivbeam.across.model import AcrossModel
from equivbeam.across.pairs import vectors, windings
from equivbeam.stations import quarters_at_ends


@dataclass(frozen=True)
class AcrossShape(PairReader):
    """Reads the states; see `coilspring.path.Shape`."""

    scene: Scene
    data: AcrossModel

    @property
    def pair_law(self) -> AcrossModel:
        """The model's arrays, which hold the law of its pairs."""
        return self.data

    def tips(self, states: np.ndarray) -> np.ndarray:
        """UX, UY, ROTZ of the last node, shape (states, 3); the first and the last are held."""
        return states[:, -3:] - np.array([0.0, self.scene.spring.active_height, 0.0])

    def pair_vectors(self, states: np.ndarray) -> np.ndarray:
        """Vectors between the centres of the pairs, shape (states, pairs, 3)."""
        rows = self.data.rows
        found = [vectors(self.data, state, windings(rows, state)) for state in states]
        return np.array(found).reshape(len(states), len(self.data.pairs), 3)

    def reactions(self, states: np.ndarray, memories: np.ndarray) -> np.ndarray:
        """Force that holds the top along Y, shape (states,), N."""
        size = states.shape[1] - 3
        return reactions(kernels.assemble, self.data, size, size - 2, states, memories)

    def overlaps(self, states: np.ndarray) -> np.ndarray:
        """By how much circles of pairs overlap or have passed each other, shape (states,), mm."""
        data = pack(self.data)
        return np.array([kernels.overlap(*data, state)[0] for state in states])

    def centreline(self, state: np.ndarray, phases: np.ndarray) -> np.ndarray:
        """Wire at the phases given, shape (phases, 3), mm.

        Between two nodes the axis and its rotation are interpolated linearly in the height at rest; the end
        turns move with the first and the last node. The tilt out of the plane, (B14), is not drawn.
        """
        spring = self.scene.spring
        at = np.clip(phases, 0.0, spring.phase_end)
        heights = spring.height(quarters_at_ends(spring).phases)
        axis = spring.height(at)
        x, y, turn = (np.interp(axis, heights, values) for values in state.reshape(-1, 3).T)
        rise, radius = spring.height(phases) - axis, spring.radius(phases)
        c, s, out = np.cos(turn), np.sin(turn), radius * np.sin(phases)
        inside, beside = x + c * out - s * rise, radius * np.cos(phases)
        # the radius to the first active point is that beside the plane
        start, hand = spring.start_phase, 1.0 if spring.hand == "left" else -1.0
        X = beside * np.cos(start) - inside * np.sin(start)
        Z = hand * (beside * np.sin(start) + inside * np.cos(start))
        return np.stack((X, y + s * out + c * rise, Z), axis=-1)
