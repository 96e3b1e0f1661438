"""Block LDL^T of a chain with couplings, against dense linear algebra."""

import numpy as np
import pytest

from wirefe.chain import eliminate, plan_chain, substitute


def random_system(nodes, couplings, last, seed, shift):
    """Blocks and the dense symmetric matrix they stand for."""
    rng = np.random.default_rng(seed)
    chain = np.stack((np.arange(nodes - 1), np.arange(1, nodes)), axis=1)
    pairs = np.concatenate((chain, np.array(couplings, dtype=int).reshape(-1, 2)))
    plan, block, flipped = plan_chain(nodes, pairs, np.array(last, dtype=int))
    F = np.zeros((plan.blocks, 6, 6))
    A = np.zeros((6 * nodes, 6 * nodes))
    for n in range(nodes):
        D = rng.normal(size=(6, 6))
        D = D + D.T + shift * np.eye(6)
        F[n] = D
        A[6 * n : 6 * n + 6, 6 * n : 6 * n + 6] = D
    for (a, b), number, flip in zip(pairs, block, flipped, strict=True):
        B = rng.normal(size=(6, 6))  # rows a, columns b
        F[number] += B if flip else B.T
        A[6 * a : 6 * a + 6, 6 * b : 6 * b + 6] += B
        A[6 * b : 6 * b + 6, 6 * a : 6 * a + 6] += B.T
    return plan, F, A


CASES = [
    (6, [], []),
    (12, [(0, 4), (4, 8), (2, 6)], [0, 2, 4, 6, 8, 11]),
    (15, [(1, 11), (3, 13), (3, 3 + 4), (0, 14)], [0, 1, 3, 7, 11, 13, 14]),
    (5, [(0, 1), (1, 3)], [0, 1, 3]),
    (12, [(0, 4), (8, 4), (4, 0), (4, 8), (0, 4)], [0, 4, 8, 11]),  # as of stations
    (60, [(node, node + 16) for node in range(44)], list(range(60))),  # coils that touch all along
    (120, [(node + 40, node) for node in range(0, 80, 2)] * 2, list(range(0, 120, 2))),  # at every other node
]


@pytest.mark.parametrize(("nodes", "couplings", "last"), CASES)
@pytest.mark.parametrize("shift", [12.0, 1.0])
def test_solution_and_inertia(nodes, couplings, last, shift):
    plan, F, A = random_system(nodes, couplings, last, nodes, shift)
    negative, least = eliminate(plan, F)
    assert (least < 0.0) == (negative > 0)
    assert negative == np.count_nonzero(np.linalg.eigvalsh(A) < 0.0)
    b = np.random.default_rng(1).normal(size=6 * nodes)
    x = b.copy()
    substitute(plan, F, x)
    np.testing.assert_allclose(A @ x, b, atol=1e-7 * np.abs(b).max())


def test_chain_without_couplings_has_no_fill():
    plan, _, _ = random_system(20, [], [], 0, 12.0)
    assert plan.blocks == 20 + 19


def test_work_grows_linearly_with_the_mesh_between_contacts():
    """Contact nodes every s nodes: the number of block updates per node does not depend on the mesh."""
    updates = []
    for stride in (10, 20, 40):
        turns = 6
        nodes = turns * 4 * stride
        contact = np.arange(0, nodes, stride)
        pairs = np.stack((contact[:-4], contact[4:]), axis=1)
        chain = np.stack((np.arange(nodes - 1), np.arange(1, nodes)), axis=1)
        plan, _, _ = plan_chain(nodes, np.concatenate((chain, pairs)), contact)
        updates.append(len(plan.target))
    first, second, third = updates
    assert third - second == pytest.approx(2 * (second - first), rel=0.01)


def test_fill_of_coils_that_touch_all_along_does_not_grow_with_their_elements():
    """In chain order each node would leave as many blocks as a turn has elements."""
    blocks = []
    for turn in (16, 32, 64):
        nodes = 5 * turn
        chain = np.stack((np.arange(nodes - 1), np.arange(1, nodes)), axis=1)
        first = np.arange(nodes - turn)
        pairs = np.stack((first, first + turn), axis=1)
        plan, _, _ = plan_chain(nodes, np.concatenate((chain, pairs)), np.arange(nodes))
        blocks.append(plan.blocks / nodes)
    assert blocks[0] < 0.5 * 16
    assert blocks[2] < 1.2 * blocks[0]
