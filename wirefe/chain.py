"""Block LDL^T for a chain of nodes with a few couplings along it.

The wire's matrix is block tridiagonal, plus a block for each contact pair. Nodes without contact are
eliminated first, in chain order: each leaves one coupling between its neighbours. What remains is
the small system of the contact nodes. In chain order each of these leaves about as many blocks as a turn has
of them. Where these are many, all nodes are eliminated by minimum degree instead, which leaves far fewer. The
order and the fill are found once (`plan_chain`); the numerical work is a fixed list of 6 x 6 operations.
"""

from __future__ import annotations

from heapq import heapify, heappop, heappush
from typing import NamedTuple

import numpy as np

from coilspring.compiling.compiled import arithmetic, inlined
from coilspring.compiling.packing import Wholes

N6 = 6
TINY = 1e-300  # of any unit: too small to change a number
WIDE = 14  # contact nodes that a coupling spans: minimum degree leaves less fill from here on, at the latest


class ChainPlan(NamedTuple):
    """Elimination plan; a coupling's block has the dofs of the node eliminated first as rows."""

    order: Wholes  # (nodes,) node eliminated at each step; its diagonal block has its number
    start: Wholes  # (nodes + 1,) first entry of each step in `column`
    column: Wholes  # node of each block right of the diagonal, step by step; they follow the diagonal blocks
    target: Wholes  # blocks updated by each step, in the order of `eliminate`
    blocks: int  # number of blocks


def plan_chain(
    nodes: int, couplings: np.ndarray, last: np.ndarray
) -> tuple[ChainPlan, np.ndarray, np.ndarray]:
    """Order and fill of the matrix.

    Parameters
    ----------
    nodes : number of nodes.
    couplings : (couplings, 2) pairs of coupled nodes, repetitions allowed.
    last : contact nodes, which come after all others in chain order.

    Returns
    -------
    plan : ChainPlan
    block, flipped : (couplings,) block of each coupling, and whether its first node has the rows.
    """
    low, high = np.sort(couplings, axis=1).T
    once, which = np.unique(low * nodes + high, return_inverse=True)  # most of stations are repetitions
    coupled = np.stack(np.divmod(once, nodes), axis=1)
    late = np.zeros(nodes, dtype=bool)
    late[last] = True
    span = np.ptp(np.cumsum(late)[coupled[late[coupled].all(axis=1)]], axis=1).max(initial=0)
    rank = np.zeros(nodes, dtype=np.int64) if span >= WIDE else np.arange(nodes) + nodes * late
    later = _eliminated(rank.tolist(), coupled.tolist())
    order = np.array(list(later))
    place = np.empty(nodes, dtype=np.int64)
    place[order] = np.arange(nodes)
    number: list[dict[int, int]] = [{} for _ in range(nodes)]  # blocks of a node's column, by their row
    start, column, target = [0], [], []
    for node, others in later.items():
        rows = sorted(others, key=place.__getitem__)
        number[node] = {row: nodes + block for block, row in enumerate(rows, start[-1])}
        column += rows
        start.append(len(column))
    for step in range(nodes):
        rows = column[start[step] : start[step + 1]]
        blocks = [number[row] for row in rows]
        for i, other in enumerate(rows):
            target += [known[other] for known in blocks[:i]]
            target.append(other)
    entries, targets = np.array(column, dtype=np.int64), np.array(target, dtype=np.int64)
    plan = ChainPlan(order, np.array(start), entries, targets, nodes + len(column))
    rows_first = place[couplings[:, 0]] < place[couplings[:, 1]]
    block = [number[a].get(b, 0) or number[b][a] for a, b in coupled.tolist()]
    return plan, np.array(block, dtype=np.int64)[which], rows_first


def _eliminated(rank: list[int], coupled: list[list[int]]) -> dict[int, set[int]]:
    """Nodes in the order of elimination, each with the later ones that are coupled to it by then.

    The node of the lowest rank comes first, among equals that with the fewest couplings (minimum degree).
    """
    near: list[set[int]] = [set() for _ in rank]
    for a, b in coupled:
        near[a].add(b)
        near[b].add(a)
    later: dict[int, set[int]] = {}
    waiting = [(rank[node], len(others), node) for node, others in enumerate(near)]
    heapify(waiting)
    while waiting:
        _, degree, node = heappop(waiting)
        others = near[node]
        if node in later or degree != len(others):
            continue  # it has other couplings by now
        later[node] = others
        for other in others:
            near[other] |= others
            near[other] -= {node, other}
            heappush(waiting, (rank[other], len(near[other]), other))
    return later


@arithmetic
def _factor_diagonal(D):
    """LDL^T of one block in place, on and below its diagonal; returns its number of negative pivots and the
    least."""
    negative, least = 0, np.inf
    for j in range(N6):
        pivot = D[j, j]
        least = min(least, pivot)
        if not pivot > 0.0:
            negative += 1
        w = 1.0 / pivot
        for i in range(j + 1, N6):
            l = w * D[i, j]  # noqa: E741
            for k in range(j + 1, i + 1):
                D[i, k] -= l * D[k, j]
        for i in range(j + 1, N6):
            D[i, j] *= w
    return negative, least


@arithmetic
def _lower(D, x):
    """L^-1 x of six numbers, which stay in registers."""
    x0, x1, x2, x3, x4, x5 = x
    x1 -= D[1, 0] * x0
    x2 -= D[2, 0] * x0 + D[2, 1] * x1
    x3 -= D[3, 0] * x0 + D[3, 1] * x1 + D[3, 2] * x2
    x4 -= D[4, 0] * x0 + D[4, 1] * x1 + D[4, 2] * x2 + D[4, 3] * x3
    x5 -= D[5, 0] * x0 + D[5, 1] * x1 + D[5, 2] * x2 + D[5, 3] * x3 + D[5, 4] * x4
    return x0, x1, x2, x3, x4, x5


@arithmetic
def _upper(D, x):
    """L^-T x of six numbers."""
    x0, x1, x2, x3, x4, x5 = x
    x4 -= D[5, 4] * x5
    x3 -= D[5, 3] * x5 + D[4, 3] * x4
    x2 -= D[5, 2] * x5 + D[4, 2] * x4 + D[3, 2] * x3
    x1 -= D[5, 1] * x5 + D[4, 1] * x4 + D[3, 1] * x3 + D[2, 1] * x2
    x0 -= D[5, 0] * x5 + D[4, 0] * x4 + D[3, 0] * x3 + D[2, 0] * x2 + D[1, 0] * x1
    return x0, x1, x2, x3, x4, x5


@arithmetic
def _over(D, x):
    """Six numbers over the pivots."""
    return x[0] / D[0, 0], x[1] / D[1, 1], x[2] / D[2, 2], x[3] / D[3, 3], x[4] / D[4, 4], x[5] / D[5, 5]


@arithmetic
def _column(U, r):
    """A column of a block."""
    return U[0, r], U[1, r], U[2, r], U[3, r], U[4, r], U[5, r]


@arithmetic
def _put_column(U, r, x):
    """Write a column of a block."""
    U[0, r], U[1, r], U[2, r], U[3, r], U[4, r], U[5, r] = x


@arithmetic
def _six(b, p):
    """Six numbers of a vector."""
    return b[p], b[p + 1], b[p + 2], b[p + 3], b[p + 4], b[p + 5]


@arithmetic
def _put_six(b, p, x):
    """Write six numbers of a vector."""
    b[p], b[p + 1], b[p + 2], b[p + 3], b[p + 4], b[p + 5] = x


@arithmetic
def _sum_of(x, y):
    """x . y of six numbers."""
    return x[0] * y[0] + x[1] * y[1] + x[2] * y[2] + x[3] * y[3] + x[4] * y[4] + x[5] * y[5]


@arithmetic
def _added_product(y, U, z):
    """y + U z of six numbers."""
    return (
        y[0] + _sum_of(_six(U[0], 0), z),
        y[1] + _sum_of(_six(U[1], 0), z),
        y[2] + _sum_of(_six(U[2], 0), z),
        y[3] + _sum_of(_six(U[3], 0), z),
        y[4] + _sum_of(_six(U[4], 0), z),
        y[5] + _sum_of(_six(U[5], 0), z),
    )


@arithmetic
def _subtract(T, V, U, lower):
    """T -= V^T U for 6 x 6 blocks, or of T what is on and below its diagonal."""
    for r in range(N6):
        v = _column(V, r)
        for c in range(r + 1 if lower else N6):
            T[r, c] -= _sum_of(v, _column(U, c))


@inlined
def _is_zero(U):
    """Whether a block is empty, as those of open pairs and of their fill are."""
    for i in range(N6):
        for j in range(N6):
            if U[i, j] != 0.0:
                return False
    return True


@inlined
def eliminate(plan, F):
    """LDL^T of the blocks (blocks, 6, 6) in place; returns the number of negative pivots and the least.

    Work is spent on blocks that hold something: those of pairs that touch, and their fill. Their first entry
    tells them from empty ones.
    """
    negative, least = 0, np.inf
    scaled = np.empty((N6, N6))
    nodes, t = plan.order.size, 0
    for step in range(nodes):
        D = F[plan.order[step]]
        below, low = _factor_diagonal(D)
        negative, least = negative + below, min(least, low)
        begin, end = plan.start[step], plan.start[step + 1]
        for a in range(begin, end):
            U = F[nodes + a]
            if _is_zero(U):
                t += a - begin + 1
                continue
            if U[0, 0] == 0.0:
                U[0, 0] = TINY
            for r in range(N6):
                x = _lower(D, _column(U, r))
                _put_column(U, r, x)
                _put_column(scaled, r, _over(D, x))
            for b in range(begin, a + 1):
                if F[nodes + b, 0, 0] != 0.0:
                    _subtract(F[plan.target[t]], F[nodes + b], scaled, b == a)
                t += 1
    return negative, least


@inlined
def substitute(plan, F, b):
    """Solve in place for the right-hand side `b` (nodes * 6,)."""
    order, start, column = plan.order, plan.start, plan.column
    nodes = order.size
    for step in range(nodes):
        D, p = F[order[step]], N6 * order[step]
        x = _lower(D, _six(b, p))
        _put_six(b, p, x)
        y = _over(D, x)
        for a in range(start[step], start[step + 1]):
            U, q = F[nodes + a], N6 * column[a]
            if U[0, 0] != 0.0:
                for j in range(N6):
                    b[q + j] -= _sum_of(_column(U, j), y)
    for step in range(nodes - 1, -1, -1):
        D, p = F[order[step]], N6 * order[step]
        x, y = _over(D, _six(b, p)), (0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
        for a in range(start[step], start[step + 1]):
            U = F[nodes + a]
            if U[0, 0] != 0.0:
                y = _added_product(y, U, _six(b, N6 * column[a]))
        y = _over(D, y)
        x = (x[0] - y[0], x[1] - y[1], x[2] - y[2], x[3] - y[3], x[4] - y[4], x[5] - y[5])
        _put_six(b, p, _upper(D, x))


@inlined
def add_gradient(g, a, b, ge):
    """Add a gradient (12,) at two nodes."""
    for i in range(6):
        g[6 * a + i] += ge[i]
        g[6 * b + i] += ge[6 + i]


@inlined
def add_nodes(H, a, b, Ke):
    """Add a Hessian's (12, 12) diagonal blocks at two nodes."""
    for i in range(6):
        for j in range(6):
            H[a, i, j] += Ke[i, j]
            H[b, i, j] += Ke[6 + i, 6 + j]


@inlined
def add_block(H, block, flip, K):
    """Add the coupling K[:6, 6:] of a first and a second node."""
    B = H[block]
    for i in range(6):
        for j in range(6):
            if flip:
                B[i, j] += K[i, 6 + j]
            else:
                B[i, j] += K[6 + i, j]
