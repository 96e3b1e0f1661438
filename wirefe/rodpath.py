"""The equilibrium path of any wire."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from wirefe.rod import Rod


@dataclass(frozen=True)
class RodPath:
    """Equilibria of a rod at the requested times, as far as they were reached.

    Attributes
    ----------
    rod : what was solved.
    times : (steps,) times reached.
    positions : (steps, nodes, 3).
    rotations : (steps, nodes, 4) of the nodes from rest, unit quaternions (w, x, y, z).
    iterations : (steps,) factorisations since the previous row.
    outcome, message, critical_time : as in `coilspring.EquilibriumPath`.
    residual_history : last Newton decrements over the reference work.
    solve_seconds : CPU time of the solve alone.
    negative_pivots : (steps,) of traced paths: 0 where the equilibrium is stable.
    """

    rod: Rod
    times: np.ndarray
    positions: np.ndarray
    rotations: np.ndarray
    iterations: np.ndarray
    outcome: str
    message: str
    critical_time: float | None
    residual_history: tuple[float, ...]
    solve_seconds: float
    negative_pivots: np.ndarray | None = None

    @classmethod
    def of(cls, rod: Rod, states: np.ndarray, **fields: Any) -> RodPath:
        """Path from the model's states, shape (steps, n), and the other fields."""
        rows = states.reshape(len(states), len(rod.points), -1)
        return cls(rod=rod, positions=rows[:, :, :3], rotations=rows[:, :, 3:], **fields)

    def displacements(self, node: int) -> np.ndarray:
        """Displacement of a node at the times reached, shape (steps, 3)."""
        return self.positions[:, node] - self.rod.points[node]
