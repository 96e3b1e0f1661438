"""A model where a path has ended, as Python calls it: its forces, its tangent and its softest mode."""

from typing import NamedTuple

import numpy as np

from coilspring.compiling.packing import pack
from coilspring.solver.equilibrium import operations
from coilspring.solver.interface import Kernels
from coilspring.solver.problem import Problem
from coilspring.solver.system import DOF, System

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

    def stiffness(self, state: np.ndarray, history: np.ndarray, mode: np.ndarray) -> np.ndarray:
        """Forces that a motion takes at `state`, contact left out, by differences of gradients."""
        size = DIFFERENCE * float(np.ptp(state)) / float(np.abs(mode).max())
        ahead, back = (
            self.gradient(self.moved(state, step), history, np.inf) for step in (size * mode, -size * mode)
        )
        return (ahead - back) / (2.0 * size)

    def factored(
        self, state: np.ndarray, history: np.ndarray, least_gap: float = 0.0
    ) -> tuple[np.ndarray, int]:
        """Factor of the matrix at `state`, and its negative pivots; `least_gap` as of `gradient`."""
        H = np.empty(self.matrix_size)
        operations.assembled(self.system, state, least_gap, history, state, np.empty(self.dofs), H)
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
    body: Body, state: np.ndarray, history: np.ndarray, start: np.ndarray, load: np.ndarray
) -> tuple[float, np.ndarray, float]:
    """Softest mode (dofs,) of the matrix at `state`, by inverse iteration, and two numbers without units.

    Both compare with what is at `start` (at rest, or where a stage of loads began), contact left out.

    Returns
    -------
    share : its stiffness over that of the same motion there; 0 at a critical point.
    mode : of length 1.
    work : of the load with it, over the most that the load does there with a motion of as much energy;
        0 where a branch bifurcates. `load` gives the tangent: the growing one, or that of what is prescribed.
    """

    def energy(motion: np.ndarray) -> float:
        return float(motion @ body.stiffness(start, history, motion))

    H, _ = body.factored(state, history)
    # nothing in held dofs, and no symmetry that could hide the mode
    mode = body.stiffness(start, history, 1.0 + np.arange(body.dofs) / body.dofs)
    value = 0.0
    for _ in range(INVERSE_ITERATIONS):
        new = body.solved(H, mode)
        square = new @ new
        value = float(new @ mode / square)
        mode = new / np.sqrt(square)
    rest, _ = body.factored(start, history, np.inf)
    answer = body.solved(rest, load)
    if body.system.prescribed.size:
        answer[int(body.system.prescribed[DOF])] = 0.0
    own = energy(mode)
    most = own * energy(answer) if answer.any() else 0.0
    work = abs(value * float(body.solved(H, load) @ mode)) / np.sqrt(most) if most > 0.0 else 0.0
    return value / own, mode, work
