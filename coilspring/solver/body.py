"""A model where a path has ended, as Python calls it: its forces, its tangent and its softest mode."""

from dataclasses import dataclass, field

import numpy as np

from coilspring.solver.interface import Kernels
from coilspring.solver.system import DIAGONAL, DOF, FREE, PLACE, STIFFNESS

INVERSE_ITERATIONS = 30
DIFFERENCE = 1e-6  # of the span of the state's numbers, with which a difference is taken


@dataclass(frozen=True)
class Body:
    """A model's kernels with its packed data, as Python calls them where a path has ended."""

    kernels: Kernels
    data: tuple[np.ndarray, np.ndarray]
    dofs: int
    matrix_size: int
    prescribed: np.ndarray = field(default_factory=lambda: FREE)  # see `coilspring.solver.system`

    def _bare(self, state: np.ndarray, history: np.ndarray, least_gap: float, H: np.ndarray) -> np.ndarray:
        g = np.empty(self.dofs)
        self.kernels.assemble(*self.data, state, least_gap, history, state, g, H)
        return g

    def moved(self, state: np.ndarray, step: np.ndarray, factor: float = 1.0) -> np.ndarray:
        """State moved by ``factor * step``."""
        out = state.copy()
        self.kernels.retract(*self.data, state, step, factor, state, 0.0, out)
        return out

    def distance(self, a: np.ndarray, b: np.ndarray) -> float:
        """Bound on how far any point moves from state `a` to `b`, mm."""
        return float(self.kernels.displacement_bound(*self.data, a, b, np.inf)[0])

    def gradient(self, state: np.ndarray, history: np.ndarray, least_gap: float = 0.0) -> np.ndarray:
        """Gradient of the energy; with an infinite `least_gap` contact is left out."""
        g = self._bare(state, history, least_gap, np.empty(0))
        if self.prescribed.size:
            g[int(self.prescribed[DOF])] = 0.0
        return g

    def pull(self, state: np.ndarray, history: np.ndarray) -> np.ndarray:
        """What the prescribed number of the state, as it moves, pulls at the degrees of freedom."""
        size, ends = DIFFERENCE * float(np.ptp(state)), []
        for sign in (1.0, -1.0):
            moved = state.copy()
            moved[int(self.prescribed[PLACE])] += sign * size
            ends.append(self.gradient(moved, history))
        return (ends[1] - ends[0]) / (2.0 * size)

    def factored(self, state: np.ndarray, history: np.ndarray) -> tuple[np.ndarray, int]:
        """Factor of the matrix at `state`, and its negative pivots."""
        H = np.empty(self.matrix_size)
        self._bare(state, history, 0.0, H)
        if self.prescribed.size:
            H[int(self.prescribed[DIAGONAL])] += self.prescribed[STIFFNESS]
        negative, _ = self.kernels.factor(*self.data, H)
        return H, negative

    def solved(self, H: np.ndarray, b: np.ndarray) -> np.ndarray:
        """Solution for the right-hand side `b` with a factor `H`."""
        out = b.copy()
        self.kernels.solve(*self.data, H, out)
        if self.prescribed.size and b[int(self.prescribed[DOF])] == 0.0:
            out[int(self.prescribed[DOF])] = 0.0
        return out


def softest(
    body: Body, state: np.ndarray, history: np.ndarray, start: np.ndarray
) -> tuple[float, np.ndarray]:
    """Softest mode (dofs,) of the matrix at `state`, by inverse iteration, and its stiffness over that of
    the same motion at `start` (at rest, or where a stage of loads began), contact left out: a number without
    units, 0 at a critical point."""

    def stiffness(mode: np.ndarray) -> np.ndarray:
        size = DIFFERENCE * float(np.ptp(start)) / float(np.abs(mode).max())
        ahead, back = (
            body.gradient(body.moved(start, step), history, np.inf) for step in (size * mode, -size * mode)
        )
        return (ahead - back) / (2.0 * size)

    H, _ = body.factored(state, history)
    # nothing in held dofs, and no symmetry that could hide the mode
    mode = stiffness(1.0 + np.arange(body.dofs) / body.dofs)
    value = 0.0
    for _ in range(INVERSE_ITERATIONS):
        new = body.solved(H, mode)
        square = new @ new
        value = float(new @ mode / square)
        mode = new / np.sqrt(square)
    return value / float(mode @ stiffness(mode)), mode
