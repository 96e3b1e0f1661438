"""Nodes of the wire in a state, and the pose of an element between two of them."""

import numpy as np

from coilspring.compiling.compiled import arithmetic
from wirefe.element.algebra import plus
from wirefe.element.rotations import conjugate, half_way, times, turned

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


@arithmetic
def pose(state, e, triads, arm):
    """Pose of the element e between the nodes e and e + 1, whose end frames at rest are `triads` (2, 4).

    Returns the end frames, the second with the sign of the shorter way, the frame half way, the chord in
    that frame, and the arm from the second node to the element's end, at rest `arm`, as turned.
    """
    a = ROW * e
    turn = four(state, a + 10)
    p1 = times(four(state, a + 3), four(triads[0], 0))
    m, p2 = half_way(p1, times(turn, four(triads[1], 0)))
    r = turned(turn, arm)
    chord = plus(plus(three(state, a + 7), -1.0, three(state, a)), 1.0, r)
    return p1, p2, m, turned(conjugate(m), chord), r
