"""Two-node beam element with the logarithm on SE(3) as deformation measure.

The end frames are R1, R2 (node rotation times the element's own end triad), r = x2 - x1. With
``theta = log(R1^T R2)``, the frame half way ``M = R1 exp(theta/2)`` and ``u = M^T r``,

    P(theta) = alpha I - c theta theta^T,  alpha = (theta/2) / sin(theta/2) = 1 + c theta^2
    v = P u,   e = (v, theta) - e0,   energy = 1/2 e^T K e

(v, theta) is the logarithm of the relative pose (Sonneville, Cardona & Bruls 2014, CMAME 268, eq. 14 ff.,
written here in the half-way frame, in which P is symmetric). A rigid motion leaves it unchanged, and
K may be any stiffness of a piece of wire. Variations use spatial spins phi_i of the nodes:

    rho = M^T (dx2 - dx1),  w = M^T (phi2 - phi1),  mu = M^T (phi1 + phi2)/2 - tau/2 theta x w
    dtheta = P w,   du = rho + u x mu,   tau = tan(theta/4)/theta

The Hessian is that along the exponential map, hence symmetric; docs/theory.md derives it.
"""

from __future__ import annotations

import math

import numpy as np

from coilspring.compiled import arithmetic, kernel
from wirefe.algebra import cross, product, skew, turned
from wirefe.rotations import quaternion_product, rotation_matrix, stretch_functions


@arithmetic
def relative_pose(ends, turns, triads, p1, p2, m, M, th, u):
    """Half-way frame M (3, 3), relative rotation th (3,) and chord u (3,) in that frame.

    `p1`, `p2`, `m` are scratch (4,). Returns a = theta/2 with its sine and cosine. Relative
    rotations reach to 180 degrees.
    """
    quaternion_product(turns[0], triads[0], p1)
    quaternion_product(turns[1], triads[1], p2)
    cos_a = p1[0] * p2[0] + p1[1] * p2[1] + p1[2] * p2[2] + p1[3] * p2[3]
    sign = 1.0 if cos_a >= 0.0 else -1.0  # q and -q are one rotation: take the shorter way
    cos_a *= sign
    for i in range(4):
        p2[i] *= sign
        m[i] = p1[i] + p2[i]
    # vector part of conj(p1) p2: sin(a) times the axis, the same in R1, M and R2
    th[0] = p1[0] * p2[1] - p1[1] * p2[0] - p1[2] * p2[3] + p1[3] * p2[2]
    th[1] = p1[0] * p2[2] + p1[1] * p2[3] - p1[2] * p2[0] - p1[3] * p2[1]
    th[2] = p1[0] * p2[3] - p1[1] * p2[2] + p1[2] * p2[1] - p1[3] * p2[0]
    sin_a = math.sqrt(th[0] ** 2 + th[1] ** 2 + th[2] ** 2)
    a = math.atan2(sin_a, cos_a)
    twice = 2.0 * a / sin_a if sin_a > 0.0 else 2.0
    norm = 1.0 / math.sqrt(m[0] ** 2 + m[1] ** 2 + m[2] ** 2 + m[3] ** 2)
    for i in range(4):
        m[i] *= norm
    rotation_matrix(m, M)
    for i in range(3):
        th[i] *= twice
        u[i] = 0.0
        for j in range(3):
            u[i] += M[j, i] * (ends[1, j] - ends[0, j])
    return a, sin_a, cos_a


@kernel
def deformations(ends, turns, triads, e):
    """Deformation measures (v, theta) of all elements, shape (n, 6), before e0 is taken off."""
    p1, p2, m = np.empty(4), np.empty(4), np.empty(4)
    M, th, u = np.empty((3, 3)), np.empty(3), np.empty(3)
    for n in range(len(ends)):
        a, sin_a, cos_a = relative_pose(ends[n], turns[n], triads[n], p1, p2, m, M, th, u)
        q = 4.0 * a * a
        c = stretch_functions(q, a, sin_a, cos_a)[0]
        along = th[0] * u[0] + th[1] * u[1] + th[2] * u[2]
        for i in range(3):
            e[n, i] = (1.0 + c * q) * u[i] - c * along * th[i]
            e[n, 3 + i] = th[i]


@kernel
def deformation_rates(ends, triads):
    """d(v, theta) at rest for a motion (dx, spin) of each element's second end, shape (n, 6, 6)."""
    J = np.empty((len(ends), 6, 6))
    turns, still = np.zeros((2, 4)), np.zeros(6)
    turns[:, 0] = 1.0
    p1, p2, m, th, u = np.empty(4), np.empty(4), np.empty(4), np.empty(3), np.empty(3)
    M, P, Vt, Wt, Gt = (
        np.empty((3, 3)),
        np.empty((3, 3)),
        np.empty((3, 3)),
        np.empty((3, 3)),
        np.empty((3, 3)),
    )
    Mt, Sk, T = np.empty((3, 3)), np.empty((3, 3)), np.empty((3, 3))
    for e in range(len(ends)):
        a, sin_a, cos_a = relative_pose(ends[e], turns, triads[e], p1, p2, m, M, th, u)
        q = 4.0 * a * a
        f = stretch_functions(q, a, sin_a, cos_a)
        _derivatives(q, f, th, u, still, P, Vt, Wt, Gt)
        # spin of the half-way frame, with the first end held: (I - tau theta x) w / 2
        skew(th, -0.5 * f[3], T)
        for i in range(3):
            T[i, i] += 0.5
            for j in range(3):
                Mt[i, j] = M[j, i]
        skew(u, 1.0, Sk)
        product(P, Sk, Sk)
        product(Sk, T, Sk)
        product(Vt, P, Vt)
        for i in range(3):
            for j in range(3):
                Vt[i, j] += Sk[i, j]
        product(Vt, Mt, Vt)
        product(P, Mt, P)
        for i in range(3):
            for j in range(3):
                J[e, i, j] = J[e, 3 + i, 3 + j] = P[i, j]
                J[e, i, 3 + j], J[e, 3 + i, j] = Vt[i, j], 0.0
    return J


@arithmetic
def beams(ends, turns, triads, e0, K, g, H):
    """Energy of all elements; fills their gradients g (n, 12) and Hessians H (n, 12, 12), if not empty.

    Freedoms of an element are (x1, phi1, x2, phi2) with spatial spins phi.

    Parameters
    ----------
    ends : (n, 2, 3) positions of the elements' ends.
    turns : (n, 2, 4) rotations of the nodes at the ends, unit quaternions.
    triads : (n, 2, 4) end frames at rest, unit quaternions.
    e0 : (n, 6) deformation measures at rest.
    K : (n, 6, 6) stiffnesses in (v, theta).
    """
    p1, p2, m4 = np.empty(4), np.empty(4), np.empty(4)
    M, P, Sk, T = np.empty((3, 3)), np.empty((3, 3)), np.empty((3, 3)), np.empty((3, 3))
    th, u, s = np.empty(3), np.empty(3), np.empty(6)
    N, m, Pm, C, X = np.empty(3), np.empty(3), np.empty(3), np.empty(3), np.empty(3)
    Vt, Wt, Gt = np.empty((3, 3)), np.empty((3, 3)), np.empty((3, 3))
    D, KD, Z = np.empty((3, 9)), np.empty((6, 9)), np.empty((9, 9))
    rr, rm, rw = np.empty((3, 3)), np.empty((3, 3)), np.empty((3, 3))
    mm, mw, ww = np.empty((3, 3)), np.empty((3, 3)), np.empty((3, 3))
    energy = 0.0
    for n in range(len(ends)):
        a, sin_a, cos_a = relative_pose(ends[n], turns[n], triads[n], p1, p2, m4, M, th, u)
        q = 4.0 * a * a
        f = stretch_functions(q, a, sin_a, cos_a)
        energy += _forces(q, f, th, u, e0[n], K[n], s, N, m, Pm, C, X)
        _gradient(M, N, C, Pm, X, f[3], g[n])
        if n >= len(H):
            continue  # no matrix asked for
        _derivatives(q, f, th, u, s, P, Vt, Wt, Gt)
        _material(u, P, Vt, K[n], Sk, T, D, KD, Z)
        _geometric(f, th, u, N, m, Pm, C, X, P, Wt, Gt, Sk, T, Z)
        _half_way_blocks(th, f[3], Z, Sk, T, rr, rm, rw, mm, mw, ww)
        _spread(M, T, rr, rm, rw, mm, mw, ww, H[n])
    return energy


@arithmetic
def _forces(q, f, th, u, e0, K, s, N, m, Pm, C, X):
    """Energy of one element; fills s = K e (6,) and the forces conjugate to u, theta, w and mu.

    N to u, m to theta, P m to w, C = N x u to mu; X = theta x C.
    """
    c, c1 = f[0], f[1]
    al, al1 = 1.0 + c * q, c1 * q + c
    B = th[0] * u[0] + th[1] * u[1] + th[2] * u[2]
    energy = 0.0
    for i in range(6):
        s[i] = 0.0
        for j in range(6):
            e = al * u[j] - c * B * th[j] if j < 3 else th[j - 3]
            s[i] += K[i, j] * (e - e0[j])
    for i in range(6):
        e = al * u[i] - c * B * th[i] if i < 3 else th[i - 3]
        energy += 0.5 * s[i] * (e - e0[i])
    A = th[0] * s[0] + th[1] * s[1] + th[2] * s[2]
    S = s[0] * u[0] + s[1] * u[1] + s[2] * u[2]
    for i in range(3):
        N[i] = al * s[i] - c * A * th[i]
        m[i] = s[3 + i] + 2.0 * (al1 * S - c1 * A * B) * th[i] - c * (B * s[i] + A * u[i])
    mt = m[0] * th[0] + m[1] * th[1] + m[2] * th[2]
    for i in range(3):
        Pm[i] = al * m[i] - c * mt * th[i]
    cross(N, u, C)
    cross(th, C, X)
    return energy


@arithmetic
def _derivatives(q, f, th, u, s, P, Vt, Wt, Gt):
    """P, d(P u)/dtheta, d(P sv)/dtheta and the second derivative of sv . P u in theta."""
    c, c1, c2 = f[0], f[1], f[2]
    al, al1, al2 = 1.0 + c * q, c1 * q + c, c2 * q + 2.0 * c1
    A = th[0] * s[0] + th[1] * s[1] + th[2] * s[2]
    B = th[0] * u[0] + th[1] * u[1] + th[2] * u[2]
    S = s[0] * u[0] + s[1] * u[1] + s[2] * u[2]
    for i in range(3):
        for j in range(3):
            unit = 1.0 if i == j else 0.0
            P[i, j] = al * unit - c * th[i] * th[j]
            Vt[i, j] = 2.0 * (al1 * u[i] - c1 * B * th[i]) * th[j] - c * (B * unit + th[i] * u[j])
            Wt[i, j] = 2.0 * (al1 * s[i] - c1 * A * th[i]) * th[j] - c * (A * unit + th[i] * s[j])
            yi, yj = B * s[i] + A * u[i], B * s[j] + A * u[j]
            Gt[i, j] = (
                2.0 * unit * (al1 * S - c1 * A * B)
                + 4.0 * (al2 * S - c2 * A * B) * th[i] * th[j]
                - 2.0 * c1 * (th[i] * yj + yi * th[j])
                - c * (s[i] * u[j] + u[i] * s[j])
            )


@arithmetic
def _material(u, P, Vt, K, Sk, T, D, KD, Z):
    """Z = D^T K D (upper part): dv = P (rho + u x mu) + d(P u)/dtheta P w, dtheta = P w."""
    skew(u, 1.0, Sk)
    product(P, Sk, T)
    for i in range(3):
        for j in range(3):
            D[i, j], D[i, 3 + j] = P[i, j], T[i, j]
    product(Vt, P, T)
    for i in range(3):
        for j in range(3):
            D[i, 6 + j] = T[i, j]
    # the rows of dtheta are zero but for w
    for i in range(6):
        k0, k1, k2 = K[i, 0], K[i, 1], K[i, 2]
        for j in range(9):
            KD[i, j] = k0 * D[0, j] + k1 * D[1, j] + k2 * D[2, j]
        k0, k1, k2 = K[i, 3], K[i, 4], K[i, 5]
        for j in range(3):
            KD[i, 6 + j] += k0 * P[0, j] + k1 * P[1, j] + k2 * P[2, j]
    for i in range(9):
        d0, d1, d2 = D[0, i], D[1, i], D[2, i]
        for j in range(9):
            Z[i, j] = d0 * KD[0, j] + d1 * KD[1, j] + d2 * KD[2, j]
    for i in range(3):
        for j in range(3):
            Z[6 + i, 6 + j] += P[0, i] * KD[3, 6 + j] + P[1, i] * KD[4, 6 + j] + P[2, i] * KD[5, 6 + j]


@arithmetic
def _geometric(f, th, u, N, m, Pm, C, X, P, Wt, Gt, Sk, T, Z):
    """Add what the forces do along the second derivatives; `Sk` holds [u], `Gt` is overwritten."""
    c, c1, tau, tau1 = f[0], f[1], f[3], f[4]
    al1 = c + c1 * (th[0] ** 2 + th[1] ** 2 + th[2] ** 2)
    Nu = N[0] * u[0] + N[1] * u[1] + N[2] * u[2]
    Ct = C[0] * th[0] + C[1] * th[1] + C[2] * th[2]
    mt = m[0] * th[0] + m[1] * th[1] + m[2] * th[2]
    product(Wt, P, T)
    for i in range(3):
        for j in range(3):
            Z[i, 6 + j] += T[i, j]
    product(Sk, T, Wt)  # [u] d(P sv)/dtheta P
    skew(N, 1.0, T)
    skew(Pm, 0.5, Sk)
    for i in range(3):
        for j in range(3):
            unit = 1.0 if i == j else 0.0
            Z[i, 3 + j] -= T[i, j]
            if j >= i:
                Z[3 + i, 3 + j] += 0.5 * (N[i] * u[j] + u[i] * N[j]) - Nu * unit
            Z[3 + i, 6 + j] += 0.25 * tau * (C[i] * th[j] - Ct * unit) - Wt[i, j] + Sk[i, j]
    product(Gt, P, T)
    product(P, T, Gt)
    skew(C, 1.0, Sk)
    product(Sk, P, T)
    for i in range(3):
        for j in range(i, 3):
            # sym: -tau/2 [C] P - tau' (C x theta) theta^T + 2 alpha' theta m^T - c theta (P m)^T
            one = -0.5 * tau * T[i, j] + tau1 * X[i] * th[j] + th[i] * (2.0 * al1 * m[j] - c * Pm[j])
            two = -0.5 * tau * T[j, i] + tau1 * X[j] * th[i] + th[j] * (2.0 * al1 * m[i] - c * Pm[i])
            Z[6 + i, 6 + j] += Gt[i, j] + 0.5 * (one + two) - mt * (2.0 * c1 * th[i] * th[j] + c * P[i, j])


@arithmetic
def _gradient(M, N, C, Pm, X, tau, g):
    """Gradient (12,) from the half-way frame's N (force), C = N x u, P m and X = theta x C."""
    for i in range(3):
        force = M[i, 0] * N[0] + M[i, 1] * N[1] + M[i, 2] * N[2]
        mean = 0.5 * (M[i, 0] * C[0] + M[i, 1] * C[1] + M[i, 2] * C[2])
        bend = 0.0
        for j in range(3):
            bend += M[i, j] * (Pm[j] + 0.5 * tau * X[j])
        g[i], g[6 + i] = -force, force
        g[3 + i], g[9 + i] = mean - bend, mean + bend


@arithmetic
def _half_way_blocks(th, tau, Z, S, T, rr, rm, rw, mm, mw, ww):
    """Blocks of the Hessian in (rho, mean spin, w) from Z in (rho, mu, w): mu = mean + S w."""
    skew(th, -0.5 * tau, S)
    for i in range(3):
        for j in range(3):
            low, high = (i, j) if i < j else (j, i)
            rr[i, j] = Z[low, high]
            rm[i, j] = Z[i, 3 + j]
            rw[i, j] = Z[i, 6 + j]
            mm[i, j] = Z[3 + low, 3 + high]
            mw[i, j] = Z[3 + i, 6 + j]
            ww[i, j] = Z[6 + low, 6 + high]
    product(rm, S, T)
    for i in range(3):
        for j in range(3):
            rw[i, j] += T[i, j]
    product(mm, S, T)
    for i in range(3):
        for j in range(3):
            # S^T mw + mw^T S + S^T mm S
            total = 0.0
            for k in range(3):
                total += S[k, i] * (mw[k, j] + T[k, j]) + mw[k, i] * S[k, j]
            ww[i, j] += total
    for i in range(3):
        for j in range(3):
            mw[i, j] += T[i, j]


@arithmetic
def _spread(M, T, rr, rm, rw, mm, mw, ww, H):
    """Hessian (12, 12) of the end freedoms from the blocks in the half-way frame."""
    for i in range(3):
        for j in range(3):
            T[i, j] = M[j, i]
    turned(M, T, rr)
    turned(M, T, rm)
    turned(M, T, rw)
    turned(M, T, mm)
    turned(M, T, mw)
    turned(M, T, ww)
    for i in range(3):
        for j in range(3):
            x = rr[i, j]
            H[i, j] = H[6 + i, 6 + j] = x
            H[i, 6 + j] = H[6 + i, j] = -x
            left, right = 0.5 * rm[i, j] - rw[i, j], 0.5 * rm[i, j] + rw[i, j]
            H[6 + i, 3 + j] = H[3 + j, 6 + i] = left
            H[i, 3 + j] = H[3 + j, i] = -left
            H[6 + i, 9 + j] = H[9 + j, 6 + i] = right
            H[i, 9 + j] = H[9 + j, i] = -right
            same = 0.25 * mm[i, j] + ww[i, j]
            sym, anti = 0.5 * (mw[i, j] + mw[j, i]), 0.5 * (mw[i, j] - mw[j, i])
            H[3 + i, 3 + j] = same - sym
            H[9 + i, 9 + j] = same + sym
            H[3 + i, 9 + j] = 0.25 * mm[i, j] - ww[i, j] + anti
            H[9 + j, 3 + i] = H[3 + i, 9 + j]
