"""Linear stiffness of any wire at rest, as a sparse matrix, and the flexibility of its end."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from wirefe.element.beam import beams
from wirefe.element.poses import at_rest
from wirefe.rod import Rod

if TYPE_CHECKING:
    from scipy.sparse import csr_array


def linear_stiffness(rod: Rod) -> csr_array:
    """Stiffness matrix at rest, dofs 6 node + (ux, uy, uz, rotx, roty, rotz), held ones included."""
    count = len(rod.stiffness)
    g, H = np.empty((count, 12)), np.empty((count, 12, 12))
    beams(at_rest(rod.points).ravel(), np.zeros(3), rod.triads, rod.strain0, rod.stiffness, rod.second, g, H)
    dofs = 6 * np.arange(count)[:, None] + np.arange(12)
    return scattered(H, dofs, dofs, rod.held.size)


def tip_flexibility(rod: Rod, at: np.ndarray) -> np.ndarray:
    """Motion (u, rotation) of a point fixed to the last node by unit forces and moments there, shape (6, 6).

    The first node is clamped; loads and what else is held play no part. `at` is the point, (3,) in mm.
    """
    from scipy.sparse.linalg import spsolve

    wrenches = np.zeros((rod.held.size - 6, 6))
    wrenches[-6:] = np.eye(6)
    wrenches[-3:, :3] = np.cross(at - rod.points[-1], np.eye(3)).T
    return wrenches.T @ spsolve(linear_stiffness(rod)[6:, 6:].tocsc(), wrenches)


def scattered(values: np.ndarray, rows: np.ndarray, columns: np.ndarray, size: int) -> csr_array:
    """A sparse matrix (size, size) of dense blocks, by the rows and columns of each."""
    from scipy.sparse import coo_array

    row, column = np.broadcast_arrays(rows[:, :, None], columns[:, None, :])
    return coo_array((values.ravel(), (row.ravel(), column.ravel())), shape=(size, size)).tocsr()
