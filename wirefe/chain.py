"""Block LDL^T for a chain of nodes with a few couplings along it.

The wire's matrix is block tridiagonal, plus a block for each contact pair. Nodes without contact are
eliminated first, in chain order: each leaves one coupling between its neighbours. What remains is
the small system of the contact nodes. The order and the fill are found once (`plan_chain`); the
numerical work is a fixed list of 6 x 6 operations.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from coilspring.compiled import clear, part

N6 = 6


class ChainPlan(NamedTuple):
    """Elimination plan; a coupling's block has the freedoms of the node eliminated first as rows."""

    order: np.ndarray  # (nodes,) node eliminated at each step; its diagonal block has its number
    start: np.ndarray  # (nodes + 1,) first entry of each step in `block` and `column`
    block: np.ndarray  # blocks right of the diagonal of each step
    column: np.ndarray  # node of their columns
    target: np.ndarray  # blocks updated by each step, in the order of `eliminate`
    blocks: int  # number of blocks


def plan_chain(
    nodes: int, couplings: np.ndarray, last: np.ndarray
) -> tuple[ChainPlan, np.ndarray, np.ndarray]:
    """Order and fill of the matrix.

    Parameters
    ----------
    nodes : number of nodes.
    couplings : (couplings, 2) pairs of coupled nodes, repetitions allowed.
    last : nodes to eliminate after all others.

    Returns
    -------
    plan : ChainPlan
    block, flipped : (couplings,) block of each coupling, and whether its first node has the rows.
    """
    late = np.zeros(nodes, dtype=bool)
    late[last] = True
    order = np.concatenate((np.flatnonzero(~late), np.flatnonzero(late)))
    place = np.empty(nodes, dtype=np.int64)
    place[order] = np.arange(nodes)
    below: list[set[int]] = [set() for _ in range(nodes)]  # later nodes coupled to a node
    for a, b in couplings:
        first, second = (a, b) if place[a] < place[b] else (b, a)
        below[first].add(int(second))
    number: dict[tuple[int, int], int] = {}
    start, block, column, target = [0], [], [], []
    for node in order.tolist():
        rows = sorted(below[node], key=place.__getitem__)
        for i, later in enumerate(rows):
            number.setdefault((later, node), nodes + len(number))
            below_i = rows[i + 1 :]
            below[later].update(below_i)
        column += rows
        block += [number[later, node] for later in rows]
        start.append(len(column))
    for step in range(nodes):
        rows = column[start[step] : start[step + 1]]
        for i, later in enumerate(rows):
            target += [number[later, other] for other in rows[:i]] + [later]
    plan = ChainPlan(
        order, np.array(start), np.array(block, dtype=np.int64), np.array(column, dtype=np.int64),
        np.array(target, dtype=np.int64), nodes + len(number),
    )  # fmt: skip
    flipped = place[couplings[:, 0]] < place[couplings[:, 1]] if len(couplings) else np.zeros(0, dtype=bool)
    found = [
        number[(int(b), int(a)) if flip else (int(a), int(b))]
        for (a, b), flip in zip(couplings, flipped, strict=True)
    ]
    return plan, np.array(found, dtype=np.int64), flipped


@part
def _factor_diagonal(D):
    """LDL^T of one block in place; returns its number of negative pivots and the least."""
    negative, least = 0, np.inf
    for j in range(N6):
        pivot = D[j, j]
        for m in range(j):
            pivot -= D[j, m] * D[j, m] * D[m, m]
        D[j, j] = pivot
        least = min(least, pivot)
        if not pivot > 0.0:
            negative += 1
        for i in range(j + 1, N6):
            total = D[i, j]
            for m in range(j):
                total -= D[i, m] * D[j, m] * D[m, m]
            D[i, j] = total / pivot
    return negative, least


@part
def _forward(D, U):
    """U <- L^-1 U, row by row."""
    for c in range(1, N6):
        for m in range(c):
            l = D[c, m]  # noqa: E741
            for r in range(N6):
                U[c, r] -= l * U[m, r]


@part
def _subtract(T, V, U):
    """T -= V^T U for 6 x 6 blocks; a row of T is kept in registers."""
    for r in range(N6):
        t0, t1, t2, t3, t4, t5 = T[r, 0], T[r, 1], T[r, 2], T[r, 3], T[r, 4], T[r, 5]
        for k in range(N6):
            v = V[k, r]
            t0 -= v * U[k, 0]
            t1 -= v * U[k, 1]
            t2 -= v * U[k, 2]
            t3 -= v * U[k, 3]
            t4 -= v * U[k, 4]
            t5 -= v * U[k, 5]
        T[r, 0], T[r, 1], T[r, 2], T[r, 3], T[r, 4], T[r, 5] = t0, t1, t2, t3, t4, t5


@part
def _is_zero(U):
    """Whether a block is empty, as those of open pairs and of their fill are."""
    for i in range(N6):
        for j in range(N6):
            if U[i, j] != 0.0:
                return False
    return True


@part
def eliminate(plan, F):
    """LDL^T of the blocks (blocks, 6, 6) in place; returns the number of negative pivots and the least.

    Work is spent on blocks that hold something: those of pairs that touch, and their fill.
    """
    negative, least = 0, np.inf
    scaled = np.empty((N6, N6))
    empty = np.zeros(plan.block.size, np.bool_)
    t = 0
    for step in range(plan.order.size):
        D = F[plan.order[step]]
        below, low = _factor_diagonal(D)
        negative, least = negative + below, min(least, low)
        begin, end = plan.start[step], plan.start[step + 1]
        for a in range(begin, end):
            U = F[plan.block[a]]
            empty[a] = _is_zero(U)
            if empty[a]:
                t += a - begin + 1
                continue
            _forward(D, U)
            for k in range(N6):
                w = 1.0 / D[k, k]
                for r in range(N6):
                    scaled[k, r] = w * U[k, r]
            for b in range(begin, a + 1):
                if not empty[b]:
                    _subtract(F[plan.target[t]], F[plan.block[b]], scaled)
                t += 1
    return negative, least


@part
def substitute(plan, F, b):
    """Solve in place for the right-hand side `b` (nodes * 6,)."""
    steps = plan.order.size
    order, start, block, column = plan.order, plan.start, plan.block, plan.column
    for step in range(steps):
        n = order[step]
        D, p = F[n], N6 * n
        y0, y1, y2, y3, y4, y5 = b[p], b[p + 1], b[p + 2], b[p + 3], b[p + 4], b[p + 5]
        y1 -= D[1, 0] * y0
        y2 -= D[2, 0] * y0 + D[2, 1] * y1
        y3 -= D[3, 0] * y0 + D[3, 1] * y1 + D[3, 2] * y2
        y4 -= D[4, 0] * y0 + D[4, 1] * y1 + D[4, 2] * y2 + D[4, 3] * y3
        y5 -= D[5, 0] * y0 + D[5, 1] * y1 + D[5, 2] * y2 + D[5, 3] * y3 + D[5, 4] * y4
        b[p], b[p + 1], b[p + 2], b[p + 3], b[p + 4], b[p + 5] = y0, y1, y2, y3, y4, y5
        y0, y1, y2 = y0 / D[0, 0], y1 / D[1, 1], y2 / D[2, 2]
        y3, y4, y5 = y3 / D[3, 3], y4 / D[4, 4], y5 / D[5, 5]
        for a in range(start[step], start[step + 1]):
            U, p = F[block[a]], N6 * column[a]
            for j in range(N6):
                b[p + j] -= (
                    U[0, j] * y0 + U[1, j] * y1 + U[2, j] * y2 + U[3, j] * y3 + U[4, j] * y4 + U[5, j] * y5
                )
    z = np.empty(N6)
    for step in range(steps - 1, -1, -1):
        n = order[step]
        D, p = F[n], N6 * n
        clear(z)
        for a in range(start[step], start[step + 1]):
            U, q = F[block[a]], N6 * column[a]
            x0, x1, x2, x3, x4, x5 = b[q], b[q + 1], b[q + 2], b[q + 3], b[q + 4], b[q + 5]
            for i in range(N6):
                z[i] += (
                    U[i, 0] * x0 + U[i, 1] * x1 + U[i, 2] * x2 + U[i, 3] * x3 + U[i, 4] * x4 + U[i, 5] * x5
                )
        for i in range(N6):
            b[p + i] = (b[p + i] - z[i]) / D[i, i]
        for i in range(N6 - 2, -1, -1):
            for j in range(i + 1, N6):
                b[p + i] -= D[j, i] * b[p + j]
