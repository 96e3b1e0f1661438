"""Block LDL^T for a chain of nodes with a few couplings along it.

The wire's matrix is block tridiagonal, plus a block for each contact pair. Nodes without contact are
eliminated first, in chain order: each leaves one coupling between its neighbours. What remains is
the small system of the contact nodes. The order and the fill are found once (`plan_chain`); the
numerical work is a fixed list of 6 x 6 operations.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from coilspring.compiling.compiled import clear, inlined, zeros
from coilspring.compiling.packing import Wholes

N6 = 6


class ChainPlan(NamedTuple):
    """Elimination plan; a coupling's block has the dofs of the node eliminated first as rows."""

    order: Wholes  # (nodes,) node eliminated at each step; its diagonal block has its number
    start: Wholes  # (nodes + 1,) first entry of each step in `block` and `column`
    block: Wholes  # blocks right of the diagonal of each step
    column: Wholes  # node of their columns
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


@inlined
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


@inlined
def _forward(D, U):
    """U <- L^-1 U, row by row."""
    for c in range(1, N6):
        for m in range(c):
            l = D[c, m]  # noqa: E741
            for r in range(N6):
                U[c, r] -= l * U[m, r]


@inlined
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

    Work is spent on blocks that hold something: those of pairs that touch, and their fill.
    """
    negative, least = 0, np.inf
    scaled = np.empty((N6, N6))
    full = zeros(plan.block.size)
    t = 0
    for step in range(plan.order.size):
        D = F[plan.order[step]]
        below, low = _factor_diagonal(D)
        negative, least = negative + below, min(least, low)
        begin, end = plan.start[step], plan.start[step + 1]
        for a in range(begin, end):
            U = F[plan.block[a]]
            if _is_zero(U):
                t += a - begin + 1
                continue
            full[a] = 1.0
            _forward(D, U)
            for k in range(N6):
                w = 1.0 / D[k, k]
                for r in range(N6):
                    scaled[k, r] = w * U[k, r]
            for b in range(begin, a + 1):
                if full[b] > 0.0:
                    _subtract(F[plan.target[t]], F[plan.block[b]], scaled)
                t += 1
    return negative, least


@inlined
def substitute(plan, F, b):
    """Solve in place for the right-hand side `b` (nodes * 6,)."""
    order, start, block, column = plan.order, plan.start, plan.block, plan.column
    y = zeros(N6)
    for step in range(order.size):
        D, p = F[order[step]], N6 * order[step]
        for i in range(N6):
            total = b[p + i]
            for j in range(i):
                total -= D[i, j] * b[p + j]
            b[p + i] = total
            y[i] = total / D[i, i]
        for a in range(start[step], start[step + 1]):
            U, q = F[block[a]], N6 * column[a]
            for i in range(N6):
                for j in range(N6):
                    b[q + j] -= U[i, j] * y[i]
    for step in range(order.size - 1, -1, -1):
        D, p = F[order[step]], N6 * order[step]
        clear(y)
        for a in range(start[step], start[step + 1]):
            U, q = F[block[a]], N6 * column[a]
            for i in range(N6):
                for j in range(N6):
                    y[i] += U[i, j] * b[q + j]
        for i in range(N6 - 1, -1, -1):
            total = (b[p + i] - y[i]) / D[i, i]
            for j in range(i + 1, N6):
                total -= D[j, i] * b[p + j]
            b[p + i] = total


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
