"""Contact forces of which each holds a gap closed, is zero, or holds a slip back, where all are linear."""

import numpy as np

from coilspring.compiling.compiled import arithmetic, lent, part

TOUCHES, FREE, STICKS = 0, 1, 2
GAP, SLIP, HELD = range(3)
MOST_TURNS = 10  # of each pair
MOST_COMBINED = 5  # pairs, of which every combination is tried
SAME = 1e-3  # of the largest force of sticking, by which the forces of two solutions differ at least


@part
def complementary(opens, slips, rows):
    """Forces of pairs of which each touches, is open and holds nothing, or is pressed and does not slip.

    Gaps and slips are linear in the forces. Pairs that are none of the three are turned one at a time, those
    of least index first: where the matrices are P-matrices that ends (Murty 1974, Opsearch 11, 123).

    Parameters
    ----------
    opens, slips : (n, n), derivatives of the gaps, mm/N, and of the slips by the forces.
    rows : (3, n), gaps, slips (as the force that they would take) and forces; the last two are replaced by
        those of the solution.

    Returns
    -------
    bool, bool
        Whether there was a regular system to solve, and whether other forces would do as well: sticking is
        friction without a bound, so what a pair holds may press it, and then holds it. Of more than
        `MOST_COMBINED` pairs that is not known.
    """
    n = opens.shape[0]
    state, M, count = np.zeros(n, np.int64), np.empty((n, n + 1)), 0
    found = _turned(state, opens, slips, rows, M)
    if not found:
        # the ones that what they hold closes rather are open however much they hold, or pressed
        for p in range(n):
            state[p] = TOUCHES if opens[p, p] > 0.0 else FREE if rows[GAP, p] > 0.0 else STICKS
        found = _turned(state, opens, slips, rows, M)
    if n <= MOST_COMBINED:
        first, count = _combined(opens, slips, rows, M)
        if not found and count > 0:
            state[:] = first
    if not _solved(state, opens, slips, rows, M):
        return False, count > 1
    for p in range(n):
        for q in range(n):
            rows[SLIP, p] += slips[p, q] * M[q, n]
        rows[HELD, p] += M[p, n]
        if state[p] != TOUCHES:
            rows[HELD if state[p] == FREE else SLIP, p] = 0.0
    return True, count > 1


@part
def _combined(opens, slips, rows, M):
    """What pairs are in the first of all combinations that is a solution, and the number of solutions, 2 at
    most."""
    n, largest, count = opens.shape[0], 0.0, 0
    state, first, forces = np.zeros(n, np.int64), np.zeros(n, np.int64), np.empty(n)
    for p in range(n):
        largest = max(largest, rows[HELD, p] + rows[SLIP, p])
    for combination in range(3**n):
        rest = combination
        for p in range(n):
            state[p] = rest % 3
            rest //= 3
        if not _solved(state, opens, slips, rows, M) or _next(state, opens, slips, rows, M) < n:
            continue
        for p in range(n):
            if count > 0 and abs(M[p, n] - forces[p]) > SAME * largest:
                return first, 2
        if count == 0:
            first[:], forces[:], count = state, M[:, n], 1
    return first, count


@part
def _turned(state, opens, slips, rows, M):
    """Turn pairs until all are what they are said to be; whether they are at last."""
    n = opens.shape[0]
    for turn in range(MOST_TURNS * n + 1):
        if not _solved(state, opens, slips, rows, M):
            return False
        p = _next(state, opens, slips, rows, M)
        if p == n:
            return True
        if turn == MOST_TURNS * n:
            break
        state[p] = TOUCHES if state[p] != TOUCHES else FREE if rows[HELD, p] + M[p, n] < 0.0 else STICKS
    return False


@part
def _solved(state, opens, slips, rows, M):
    """Find the forces of pairs that are what they are said to be, the last column of `M`; whether there are
    such."""
    for p in range(opens.shape[0]):
        _equation(state[p], p, opens, slips, rows, M)
    return eliminated(M) != 0


@part
def _next(state, opens, slips, rows, M):
    """The first pair that is not what it is said to be, n where there is none."""
    n = opens.shape[0]
    for p in range(n):
        gap, slip = rows[GAP, p], rows[SLIP, p]
        for q in range(n):
            gap += opens[p, q] * M[q, n]
            slip += slips[p, q] * M[q, n]
        if state[p] == TOUCHES:
            wrong = rows[HELD, p] + M[p, n] < 0.0 or slip < 0.0
        else:
            wrong = gap < 0.0 if state[p] == FREE else gap > 0.0
        if wrong:
            return p
    return n


@part
def _equation(state, p, opens, slips, rows, M):
    """Row of a pair: no gap, no force or no slip."""
    n = opens.shape[0]
    for q in range(n):
        if state == TOUCHES:
            M[p, q] = opens[p, q]
        elif state == STICKS:
            M[p, q] = slips[p, q]
        else:
            M[p, q] = 1.0 if p == q else 0.0
    if state == TOUCHES:
        M[p, n] = -rows[GAP, p]
    elif state == STICKS:
        M[p, n] = -rows[SLIP, p]
    else:
        M[p, n] = -rows[HELD, p]


@part
def eliminated(M):
    """Solve a system with its right side in the last column, in place.

    Returns the sign of the determinant, 0 where the system is singular.
    """
    M, n, sign = lent(M), M.shape[0], 1
    for i in range(n):  # equations of different units
        most = 0.0
        for j in range(n):
            most = max(most, abs(M[i, j]))
        for j in range(n + 1):
            M[i, j] = M[i, j] / most if most > 0.0 else 0.0
    for k in range(n):
        pivot = k
        for i in range(k + 1, n):
            if abs(M[i, k]) > abs(M[pivot, k]):
                pivot = i
        if not abs(M[pivot, k]) > 0.0:
            return 0
        if (pivot != k) != (M[pivot, k] < 0.0):
            sign = -sign
        for j in range(k, n + 1):
            M[k, j], M[pivot, j] = M[pivot, j], M[k, j]
        for i in range(k + 1, n):
            _subtract(M[i, k + 1 :], M[i, k] / M[k, k], M[k, k + 1 :])
    for k in range(n - 1, -1, -1):
        for j in range(k + 1, n):
            M[k, n] -= M[k, j] * M[j, n]
        M[k, n] /= M[k, k]
    return sign


@arithmetic
def _subtract(a, factor, b):
    """a -= factor b: numbers side by side are taken four at a time."""
    for j in range(a.size):
        a[j] -= factor * b[j]
