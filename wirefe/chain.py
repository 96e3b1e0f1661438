"""Block LDL^T for a chain of nodes with a few couplings along it.

The wire's matrix is block tridiagonal, plus a block for each contact pair. Nodes without contact are
eliminated first, in chain order: each leaves one coupling between its neighbours. What remains is
the small system of the contact nodes. The order and the fill are found once (`plan_chain`); the
numerical work is a fixed list of 6 x 6 operations.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from coilspring.compiled import kernel

N6 = 6


class ChainPlan(NamedTuple):
    """Elimination plan; blocks are stored with the later eliminated node's freedoms as rows."""

    order: np.ndarray  # (nodes,) node eliminated at each step; its diagonal block has its number
    start: np.ndarray  # (nodes + 1,) first entry of each step in `block` and `row`
    block: np.ndarray  # blocks below the diagonal of each step
    row: np.ndarray  # node of their rows
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
    start, block, row, target = [0], [], [], []
    for node in order.tolist():
        rows = sorted(below[node], key=place.__getitem__)
        for i, later in enumerate(rows):
            number.setdefault((later, node), nodes + len(number))
            below_i = rows[i + 1 :]
            below[later].update(below_i)
        row += rows
        block += [number[later, node] for later in rows]
        start.append(len(row))
    for step in range(nodes):
        rows = row[start[step] : start[step + 1]]
        for i, later in enumerate(rows):
            target += [number[later, other] for other in rows[:i]] + [later]
    plan = ChainPlan(
        order, np.array(start), np.array(block, dtype=np.int64), np.array(row, dtype=np.int64),
        np.array(target, dtype=np.int64), nodes + len(number),
    )  # fmt: skip
    flipped = place[couplings[:, 0]] > place[couplings[:, 1]] if len(couplings) else np.zeros(0, dtype=bool)
    found = [
        number[(int(a), int(b)) if flip else (int(b), int(a))]
        for (a, b), flip in zip(couplings, flipped, strict=True)
    ]
    return plan, np.array(found, dtype=np.int64), flipped


@kernel
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


@kernel
def eliminate(plan, F):
    """LDL^T of the blocks (blocks, 6, 6) in place; returns the number of negative pivots and the least."""
    negative, least = 0, np.inf
    scaled = np.empty((N6, N6))
    t = 0
    for step in range(plan.order.size):
        D = F[plan.order[step]]
        below, low = _factor_diagonal(D)
        negative, least = negative + below, min(least, low)
        begin, end = plan.start[step], plan.start[step + 1]
        for a in range(begin, end):
            B = F[plan.block[a]]
            for c in range(N6):
                for m in range(c):
                    l = D[c, m]  # noqa: E741
                    for r in range(N6):
                        B[r, c] -= B[r, m] * l
        for a in range(begin, end):
            B = F[plan.block[a]]
            for r in range(N6):
                for c in range(N6):
                    scaled[r, c] = B[r, c] / D[c, c]
            for b in range(begin, a + 1):
                # blocks before `a` are scaled already: their product wants the unscaled `B`
                _subtract(F[plan.target[t]], scaled if b == a else B, B if b == a else F[plan.block[b]])
                t += 1
            for r in range(N6):
                for c in range(N6):
                    B[r, c] = scaled[r, c]
    return negative, least


@kernel
def _subtract(T, A, B):
    """T -= A B^T for 6 x 6 blocks."""
    for r in range(N6):
        for c in range(N6):
            total = 0.0
            for k in range(N6):
                total += A[r, k] * B[c, k]
            T[r, c] -= total


@kernel
def substitute(plan, F, b):
    """Solve in place for the right-hand side `b` (nodes * 6,)."""
    steps = plan.order.size
    for step in range(steps):
        n = plan.order[step]
        D = F[n]
        y = b[N6 * n : N6 * n + N6]
        for i in range(1, N6):
            for j in range(i):
                y[i] -= D[i, j] * y[j]
        for a in range(plan.start[step], plan.start[step + 1]):
            B = F[plan.block[a]]
            p = N6 * plan.row[a]
            for i in range(N6):
                total = 0.0
                for j in range(N6):
                    total += B[i, j] * y[j]
                b[p + i] -= total
    for step in range(steps - 1, -1, -1):
        n = plan.order[step]
        D = F[n]
        y = b[N6 * n : N6 * n + N6]
        for i in range(N6):
            y[i] /= D[i, i]
        for a in range(plan.start[step], plan.start[step + 1]):
            B = F[plan.block[a]]
            p = N6 * plan.row[a]
            for i in range(N6):
                for j in range(N6):
                    y[j] -= B[i, j] * b[p + i]
        for i in range(N6 - 2, -1, -1):
            for j in range(i + 1, N6):
                y[i] -= D[j, i] * y[j]
