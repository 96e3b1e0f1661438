"""Penalty contact between the circles in which the wire meets the working plane: (10)-(13).

With the centres cA, cB of a pair, g = cB - cA and h = |g|, the potential is
``Kc max(0, d - h)^(k+1) / (k+1)``; its gradient is the force (12) on the nodes and its moment.
"""

from __future__ import annotations

import math

from coilspring.compiled import kernel


@kernel
def circle_centre(x, y, theta, ox, oy):
    """Centre of a circle carried by a node: the node's position and the turned offset."""
    c, s = math.cos(theta), math.sin(theta)
    return x + c * ox - s * oy, y + s * ox + c * oy


@kernel
def pair_potential(gx, gy, h, d, kc, k, stuck, f, H):
    """Energy of one pair as a function of g; fills its gradient `f` (2,) and Hessian `H` (2, 2).

    `stuck` is the pair's row of the contact memory, (on, gx0, gy0, nx0, ny0): where on, the
    tangential potential 1/2 kt |(I - n0 n0^T)(g - g0)|^2 holds the pair, with kt = Kc.
    """
    energy = 0.0
    f[0] = f[1] = 0.0
    H[0, 0] = H[0, 1] = H[1, 0] = H[1, 1] = 0.0
    delta = d - h
    if delta > 0.0:
        nx, ny = gx / h, gy / h
        F = kc * delta**k
        slope = kc * k * delta ** (k - 1.0)
        turn = F / h
        f[0], f[1] = -F * nx, -F * ny
        H[0, 0] = slope * nx * nx - turn * ny * ny
        H[1, 1] = slope * ny * ny - turn * nx * nx
        H[0, 1] = H[1, 0] = (slope + turn) * nx * ny
        energy = F * delta / (k + 1.0)
    if stuck[0] > 0.0:
        tx, ty = -stuck[4], stuck[3]
        slip = tx * (gx - stuck[1]) + ty * (gy - stuck[2])
        f[0] += kc * slip * tx
        f[1] += kc * slip * ty
        H[0, 0] += kc * tx * tx
        H[1, 1] += kc * ty * ty
        H[0, 1] += kc * tx * ty
        H[1, 0] += kc * tx * ty
        energy += 0.5 * kc * slip * slip
    return energy


@kernel
def pair_forces(f, H, rax, ray, rbx, rby, g, K):
    """Gradient (6,) and Hessian (6, 6) in the two nodes' freedoms from those in the vector g.

    `ra`, `rb` are the vectors from each node to its circle's centre, as turned now.
    """
    # dg/dq, one row per freedom: -(I, r_A') and +(I, r_B') with r' = (-ry, rx)
    jx = (-1.0, 0.0, ray, 1.0, 0.0, -rby)
    jy = (0.0, -1.0, -rax, 0.0, 1.0, rbx)
    for i in range(6):
        g[i] = jx[i] * f[0] + jy[i] * f[1]
        hx = jx[i] * H[0, 0] + jy[i] * H[1, 0]
        hy = jx[i] * H[0, 1] + jy[i] * H[1, 1]
        for j in range(6):
            K[i, j] = hx * jx[j] + hy * jy[j]
    # second derivative of the centres: c'' = -r
    K[2, 2] += f[0] * rax + f[1] * ray
    K[5, 5] -= f[0] * rbx + f[1] * rby
