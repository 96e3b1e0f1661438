"""A contact pair of spheres in the freedoms of the nodes that carry them; its law is `coilspring.pairlaw`."""

from __future__ import annotations

from coilspring.compiled import part


@part
def lever(f, r, C):
    """Second derivative of f . exp(phi) r in the spin phi: 1/2 (f r^T + r f^T) - (f . r) I."""
    fr = f[0] * r[0] + f[1] * r[1] + f[2] * r[2]
    for i in range(3):
        for j in range(3):
            C[i, j] = 0.5 * (f[i] * r[j] + r[i] * f[j])
        C[i, i] -= fr


@part
def _side(f, r, sign, g, K, J, C):
    """Gradient (6,) of one carrier and the lever's part of its Hessian; J (3, 6) is its dg/dq."""
    J[:] = 0.0
    for i in range(3):
        J[i, i] = sign
    J[0, 4], J[0, 5], J[1, 3] = sign * r[2], -sign * r[1], -sign * r[2]
    J[1, 5], J[2, 3], J[2, 4] = sign * r[0], sign * r[1], -sign * r[0]
    lever(f, r, C)
    for i in range(6):
        g[i] = J[0, i] * f[0] + J[1, i] * f[1] + J[2, i] * f[2]
    for i in range(3):
        for j in range(3):
            K[3 + i, 3 + j] = sign * C[i, j]


@part
def pair_matrix(f, Hg, ra, rb, g, K, Ja, Jb, C):
    """Gradient (12,) and Hessian (12, 12) of a pair in its carriers' freedoms; ra, rb as turned now."""
    K[:] = 0.0
    _side(f, ra, -1.0, g[:6], K[:6, :6], Ja, C)
    _side(f, rb, 1.0, g[6:], K[6:, 6:], Jb, C)
    for i in range(12):
        for j in range(12):
            total = 0.0
            for k in range(3):
                for l in range(3):  # noqa: E741
                    left = Ja[k, i] if i < 6 else Jb[k, i - 6]
                    right = Ja[l, j] if j < 6 else Jb[l, j - 6]
                    total += left * Hg[k, l] * right
            K[i, j] += total
