"""Linear stiffness of any wire at rest, as a sparse matrix."""

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


def scattered(values: np.ndarray, rows: np.ndarray, columns: np.ndarray, size: int) -> csr_array:
    """A sparse matrix (size, size) of dense blocks, by the rows and columns of each."""
    from scipy.sparse import coo_array

    row, column = np.broadcast_arrays(rows[:, :, None], columns[:, None, :])
    return coo_array((values.ravel(), (row.ravel(), column.ravel())), shape=(size, size)).tocsr()
