"""A contact pair of spheres in the freedoms of the nodes that carry them; its law is `coilspring.pairlaw`."""

from __future__ import annotations

from coilspring.compiled import clear_table, part


@part
def lever(f, r, C):
    """Second derivative of f . exp(phi) r in the spin phi: 1/2 (f r^T + r f^T) - (f . r) I."""
    fr = f[0] * r[0] + f[1] * r[1] + f[2] * r[2]
    for i in range(3):
        for j in range(3):
            C[i, j] = 0.5 * (f[i] * r[j] + r[i] * f[j])
        C[i, i] -= fr


@part
def _side(f, r, sign, at, g, K, J, C):
    """Gradient of one carrier, whose six freedoms begin `at`; adds to the Hessian, and fills J = dg/dq."""
    for i in range(3):
        for j in range(6):
            J[i, at + j] = 0.0
        J[i, at + i] = sign
    x, y, z = sign * r[0], sign * r[1], sign * r[2]
    J[0, at + 4], J[0, at + 5], J[1, at + 3] = z, -y, -z
    J[1, at + 5], J[2, at + 3], J[2, at + 4] = x, y, -x
    lever(f, r, C)
    for i in range(at, at + 6):
        g[i] = J[0, i] * f[0] + J[1, i] * f[1] + J[2, i] * f[2]
    for i in range(3):
        for j in range(3):
            K[at + 3 + i, at + 3 + j] += sign * C[i, j]


@part
def pair_matrix(f, Hg, ra, rb, g, K, J, C):
    """Gradient (12,) and Hessian (12, 12) of a pair in its carriers' freedoms; ra, rb as turned now."""
    clear_table(K)
    _side(f, ra, -1.0, 0, g, K, J, C)
    _side(f, rb, 1.0, 6, g, K, J, C)
    for i in range(12):
        for k in range(3):
            row = J[0, i] * Hg[0, k] + J[1, i] * Hg[1, k] + J[2, i] * Hg[2, k]
            for j in range(12):
                K[i, j] += row * J[k, j]
