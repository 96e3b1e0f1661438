"""Penalty contact between the circles in which the wire meets the working plane: (10)-(13).

With the centres cA, cB of a pair, g = cB - cA and h = |g|, the potential is
``Kc max(0, d - h)^(k+1) / (k+1)``; its gradient is the force (12) on the nodes and its moment.
"""

from __future__ import annotations

import math

from coilspring.compiled import part

# A pair's row of the contact memory: whether it is held, g0, n0, the bound of its tangential force, the
# length it has slid, and the work that friction has taken.
ON, GX0, GY0, NX0, NY0, BOUND, SLID, WORK = range(8)
MEMORY = 8


@part
def circle_centre(x, y, theta, ox, oy):
    """Centre of a circle carried by a node: the node's position and the turned offset."""
    c, s = math.cos(theta), math.sin(theta)
    return x + c * ox - s * oy, y + s * ox + c * oy


@part
def pair_potential(gx, gy, h, d, kc, k, row, f, H):
    """Energy of one pair as a function of g; fills its gradient `f` (2,) and Hessian `H` (2, 2).

    `row` is the pair's row of the contact memory: where held, the tangential potential
    1/2 kt |(I - n0 n0^T)(g - g0)|^2 holds the pair, with kt = Kc, up to the bound of its force.
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
    if row[ON] > 0.0:
        tx, ty = -row[NY0], row[NX0]
        e = tx * (gx - row[GX0]) + ty * (gy - row[GY0])
        kt, T = kc, kc * e
        if abs(T) <= row[BOUND]:
            energy += 0.5 * T * e
        else:
            kt, T = 0.0, math.copysign(row[BOUND], e)
            energy += row[BOUND] * (abs(e) - 0.5 * row[BOUND] / kc)
        f[0] += T * tx
        f[1] += T * ty
        H[0, 0] += kt * tx * tx
        H[1, 1] += kt * ty * ty
        H[0, 1] += kt * tx * ty
        H[1, 0] += kt * tx * ty
    return energy


@part
def hold(gx, gy, h, kc, row):
    """Update a pair's memory where it touches at the end of a substep.

    A new pair is remembered as it is; one that slid keeps the stretch that its bound allows.
    """
    if row[ON] == 0.0:
        row[GX0], row[GY0], row[NX0], row[NY0] = gx, gy, gx / h, gy / h
        row[ON], row[BOUND], row[SLID], row[WORK] = 1.0, math.inf, 0.0, 0.0
        return
    e = row[NX0] * (gy - row[GY0]) - row[NY0] * (gx - row[GX0])
    if kc * abs(e) <= row[BOUND]:
        return
    way = abs(e) - row[BOUND] / kc
    row[SLID] += way
    row[WORK] += row[BOUND] * way
    row[NX0], row[NY0] = gx / h, gy / h
    kept = math.copysign(row[BOUND] / kc, e)
    row[GX0], row[GY0] = gx + kept * row[NY0], gy - kept * row[NX0]


@part
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
