"""A model where a path has ended, as Python calls it: its forces, its tangent and its softest mode."""

from typing import NamedTuple

import numpy as np

from coilspring.compiling.packing import pack
from coilspring.solver.equilibrium import operations
from coilspring.solver.interface import Kernels
from coilspring.solver.problem import Problem
from coilspring.solver.system import PLACE, System

INVERSE_ITERATIONS = 30
DIFFERENCE = 1e-6  # of the span of the state's numbers, with which a difference is taken


class Body(NamedTuple):
    """A model with its constraint, as Python calls it where a path has ended."""

    system: System
    dofs: int
    matrix_size: int

    def moved(self, state: np.ndarray, step: np.ndarray, factor: float = 1.0) -> np.ndarray:
        """State moved by ``factor * step``."""
        out = state.copy()
        operations.moved(self.system, state, step, factor, out)
        return out

    def distance(self, a: np.ndarray, b: np.ndarray) -> float:
        """Bound on how far any point moves from state `a` to `b`, mm."""
        system = self.system
        return float(system.displacement_bound(system.reals, system.ints, a, b, np.inf)[0])

    def update_pairs(self, state: np.ndarray, history: np.ndarray) -> None:
        """Make a contact history that of a state which nothing led to."""
        self.system.update_pairs(self.system.reals, self.system.ints, state, state, state, history)

    def gradient(self, state: np.ndarray, history: np.ndarray, least_gap: float = 0.0) -> np.ndarray:
        """Gradient of the energy; with an infinite `least_gap` contact is left out."""
        g = np.empty(self.dofs)
        operations.assembled(self.system, state, least_gap, history, state, g, np.empty(0))
        return g

    def pull(self, state: np.ndarray, history: np.ndarray) -> np.ndarray:
        """What the prescribed number of the state, as it moves, pulls at the degrees of freedom."""
        size, ends = DIFFERENCE * float(np.ptp(state)), []
        for sign in (1.0, -1.0):
            moved = state.copy()
            moved[int(self.system.prescribed[PLACE])] += sign * size
            ends.append(self.gradient(moved, history))
        return (ends[1] - ends[0]) / (2.0 * size)

    def factored(self, state: np.ndarray, history: np.ndarray) -> tuple[np.ndarray, int]:
        """Factor of the matrix at `state`, and its negative pivots."""
        H = np.empty(self.matrix_size)
        operations.assembled(self.system, state, 0.0, history, state, np.empty(self.dofs), H)
        negative, _ = operations.factored(self.system, H)
        return H, negative

    def solved(self, H: np.ndarray, b: np.ndarray) -> np.ndarray:
        """Solution for the right-hand side `b` with a factor `H`."""
        out = b.copy()
        operations.solve(self.system, H, out)
        return out


def body_of(problem: Problem, kernels: Kernels) -> Body:
    """A model as its problem describes it."""
    system = System(*pack(problem.data), problem.prescribed, np.zeros(1), *kernels)
    return Body(system, problem.load.size, problem.matrix_size)


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
