"""Elasticity of an element: energy, forces and stiffness of a deformation e (see `wirefe.element.beam`).

    eta = e - 1/2 Q(e, e),   energy = 1/2 eta^T K eta,   A = d eta/de = I - Q e
    forces in e = A^T K eta,   stiffness = A^T K A - (K eta) . Q

e and eta are tuples of six numbers; Q is empty where all elements are straight.
"""

from coilspring.compiling.compiled import arithmetic
from wirefe.element.algebra import dot


@arithmetic
def elastic(e, K, Q, n, A):
    """Energy of the n-th element, its forces s in eta, and those in v and theta, A^T s.

    Fills A = d eta/de of a curved one.
    """
    eta = e
    if n < len(Q):
        a, b, c = _eta(e, Q, n, 0, A), _eta(e, Q, n, 1, A), _eta(e, Q, n, 2, A)
        eta = (a, b, c, _eta(e, Q, n, 3, A), _eta(e, Q, n, 4, A), _eta(e, Q, n, 5, A))
    s = (_row(K, 0, eta), _row(K, 1, eta), _row(K, 2, eta), _row(K, 3, eta), _row(K, 4, eta), _row(K, 5, eta))
    energy = dot(s, eta) + s[3] * eta[3] + s[4] * eta[4] + s[5] * eta[5]
    v, y = (s[0], s[1], s[2]), (s[3], s[4], s[5])
    if n < len(Q):
        v = (_column(A, 0, s), _column(A, 1, s), _column(A, 2, s))
        y = (_column(A, 3, s), _column(A, 4, s), _column(A, 5, s))
    return 0.5 * energy, s, v, y


@arithmetic
def _eta(e, Q, n, i, A):
    """One of eta; fills its row of A."""
    value = e[i]
    for j in range(6):
        rate = 0.0
        for k in range(6):
            rate += Q[n, i, 6 * j + k] * e[k]
        value -= 0.5 * rate * e[j]
        A[i, j] = (1.0 if i == j else 0.0) - rate
    return value


@arithmetic
def _row(K, i, x):
    """Row of a matrix (6, 6) times a vector."""
    return (K[i, 0] * x[0] + K[i, 1] * x[1] + K[i, 2] * x[2]) + (
        K[i, 3] * x[3] + K[i, 4] * x[4] + K[i, 5] * x[5]
    )


@arithmetic
def _column(K, j, x):
    """Column of a matrix (6, 6) times a vector."""
    return (K[0, j] * x[0] + K[1, j] * x[1] + K[2, j] * x[2]) + (
        K[3, j] * x[3] + K[4, j] * x[4] + K[5, j] * x[5]
    )


@arithmetic
def stiffness(K, Q, n, s, A, now):
    """Stiffness of the n-th element in e: A^T K A - s . Q, or K of a straight one."""
    if n >= len(Q):
        for i in range(6):
            for j in range(6):
                now[i, j] = K[i, j]
        return
    for j in range(6):
        a = A[0, j], A[1, j], A[2, j], A[3, j], A[4, j], A[5, j]
        Ka = _row(K, 0, a), _row(K, 1, a), _row(K, 2, a), _row(K, 3, a), _row(K, 4, a), _row(K, 5, a)
        for i in range(j + 1):
            value = _column(A, i, Ka)
            for k in range(6):
                value -= s[k] * Q[n, k, 6 * i + j]
            now[i, j] = now[j, i] = value
