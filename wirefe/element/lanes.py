"""Numbers of several elements side by side, so that one instruction of the processor treats those of four.

A table is flat: the number i of the n-th element is at ``LANES * i + n``. The compiler sees that it may treat
several elements at once where the place of a number is its row times a constant, in a loop over `n` that has
no other calls, and where the number of elements is not one.
"""

from coilspring.compiling.compiled import arithmetic
from wirefe.element.algebra import plus
from wirefe.element.poses import ROW, four, three
from wirefe.element.rotations import turned

LANES, WIDTH = 8, 4  # elements side by side, and how many of them an instruction treats
# Rows of what `give_ends` gives: rotations of both nodes, the chord, the end frames at rest.
LOW, HIGH, SPAN, FIRST, SECOND = 0, 4, 8, 11, 15
ENDS = 19  # rows


@arithmetic
def wide(size):
    """Elements that are treated where there are `size`: what is found of those beyond is not read. They are
    given the numbers of the last one, which cost less than numbers that are none."""
    return (size + WIDTH - 1) // WIDTH * WIDTH


@arithmetic
def get_three(table, i, n):
    """Three rows of the n-th element."""
    return table[LANES * i + n], table[LANES * (i + 1) + n], table[LANES * (i + 2) + n]


@arithmetic
def get_four(table, i, n):
    """Four rows."""
    return *get_three(table, i, n), table[LANES * (i + 3) + n]


@arithmetic
def get_nine(table, i, n):
    """A matrix, in nine rows."""
    return *get_three(table, i, n), *get_three(table, i + 3, n), *get_three(table, i + 6, n)


@arithmetic
def put_three(table, i, n, a):
    """Write three rows."""
    table[LANES * i + n], table[LANES * (i + 1) + n], table[LANES * (i + 2) + n] = a


@arithmetic
def put_four(table, i, n, a):
    """Write four rows."""
    p = LANES * i + n
    table[p], table[p + LANES], table[p + 2 * LANES], table[p + 3 * LANES] = a


@arithmetic
def put_nine(table, i, n, A):
    """Write a matrix into nine rows."""
    put_three(table, i, n, (A[0], A[1], A[2]))
    put_three(table, i + 3, n, (A[3], A[4], A[5]))
    put_three(table, i + 6, n, (A[6], A[7], A[8]))


@arithmetic
def give_ends(table, n, state, triads, arm, e):
    """Give the n-th of a table the ends of the element e; the wire's end stands off from the last node by
    `arm`. Returns the arm from the element's second node to its end, as turned."""
    a = ROW * e
    turn, last = four(state, a + 10), e == len(triads) - 1
    r = turned(turn, three(arm, 0) if last else (0.0, 0.0, 0.0))
    put_four(table, LOW, n, four(state, a + 3))
    put_four(table, HIGH, n, turn)
    put_three(table, SPAN, n, plus(plus(three(state, a + 7), -1.0, three(state, a)), 1.0, r))
    put_four(table, FIRST, n, four(triads[e, 0], 0))
    put_four(table, SECOND, n, four(triads[e, 1], 0))
    return r
