"""Nodes of the wire in a state."""

import numpy as np

from coilspring.compiling.compiled import arithmetic

ROW = 7  # numbers of a node in the state: position and rotation, a unit quaternion (w, x, y, z)


def at_rest(points: np.ndarray) -> np.ndarray:
    """Rows (n, 7) of nodes at `points` (n, 3) that have not turned."""
    rows = np.zeros((len(points), ROW))
    rows[:, :3] = points
    rows[:, 3] = 1.0
    return rows


@arithmetic
def three(a, i):
    """Three numbers of a vector, from the i-th on."""
    return a[i], a[i + 1], a[i + 2]


@arithmetic
def three_of(table, k, i):
    """Three numbers of a row of a table: a view of the row would be counted."""
    return table[k, i], table[k, i + 1], table[k, i + 2]


@arithmetic
def four(a, i):
    """Four numbers of a vector, from the i-th on."""
    return a[i], a[i + 1], a[i + 2], a[i + 3]
