"""Sphere-to-sphere penalty contact between points of the wire.

With the centres of a pair, g = cB - cA and h = |g|, the potential is ``K max(0, d - h)^(k+1)/(k+1)``.
Where sliding is off, a closed pair also has ``1/2 K |(I - n0 n0^T)(g - g0)|^2``, g0 and n0 being the
vector and its direction at the end of the substep in which the pair closed.
"""

from __future__ import annotations

from coilspring.compiled import kernel


@kernel
def sphere_pair(g, h, d, K, k, stuck, f, H):
    """Energy of a pair as a function of g; fills its gradient f (3,) and Hessian H (3, 3).

    `stuck` is the pair's row of the contact memory: (on, g0 (3), n0 (3)).
    """
    energy = 0.0
    f[:] = 0.0
    H[:] = 0.0
    delta = d - h
    if delta > 0.0:
        F = K * delta**k
        slope = K * k * delta ** (k - 1.0)
        turn = F / h
        energy = F * delta / (k + 1.0)
        for i in range(3):
            ni = g[i] / h
            f[i] = -F * ni
            H[i, i] = -turn
            for j in range(3):
                H[i, j] += (slope + turn) * ni * g[j] / h
    if stuck[0] > 0.0:
        along = 0.0
        for i in range(3):
            along += stuck[4 + i] * (g[i] - stuck[1 + i])
        for i in range(3):
            slip = g[i] - stuck[1 + i] - along * stuck[4 + i]
            f[i] += K * slip
            H[i, i] += K
            energy += 0.5 * K * slip * slip
            for j in range(3):
                H[i, j] -= K * stuck[4 + i] * stuck[4 + j]
    return energy


@kernel
def lever(f, r, C):
    """Second derivative of f . exp(phi) r in the spin phi: 1/2 (f r^T + r f^T) - (f . r) I."""
    fr = f[0] * r[0] + f[1] * r[1] + f[2] * r[2]
    for i in range(3):
        for j in range(3):
            C[i, j] = 0.5 * (f[i] * r[j] + r[i] * f[j])
        C[i, i] -= fr


@kernel
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


@kernel
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
