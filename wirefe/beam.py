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
from numba import njit

from wirefe.rotations import quaternion_product, rotation_matrix, stretch_functions


@njit(cache=True, error_model="numpy", inline="always")
def _skew(x, y, z, S):
    S[0, 0], S[0, 1], S[0, 2] = 0.0, -z, y
    S[1, 0], S[1, 1], S[1, 2] = z, 0.0, -x
    S[2, 0], S[2, 1], S[2, 2] = -y, x, 0.0


@njit(cache=True, error_model="numpy", inline="always")
def _product(A, B, C):
    """C = A B for 3 x 3 matrices."""
    for i in range(3):
        for j in range(3):
            C[i, j] = A[i, 0] * B[0, j] + A[i, 1] * B[1, j] + A[i, 2] * B[2, j]


@njit(cache=True, error_model="numpy", inline="always")
def _turned(M, A, C, T):
    """C = M A M^T with the scratch matrix T."""
    _product(M, A, T)
    for i in range(3):
        for j in range(3):
            C[i, j] = T[i, 0] * M[j, 0] + T[i, 1] * M[j, 1] + T[i, 2] * M[j, 2]


@njit(cache=True, error_model="numpy")
def relative_pose(x1, q1, x2, q2, lam1, lam2, M, th, u):
    """Half-way frame M (3, 3), relative rotation th (3,) and chord u (3,) in that frame.

    Returns a = theta/2 with its sine and cosine. Relative rotations reach to 180 degrees.
    """
    p1 = np.empty(4)
    p2 = np.empty(4)
    m = np.empty(4)
    quaternion_product(q1, lam1, p1)
    quaternion_product(q2, lam2, p2)
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
        u[i] = M[0, i] * (x2[0] - x1[0]) + M[1, i] * (x2[1] - x1[1]) + M[2, i] * (x2[2] - x1[2])
    return a, sin_a, cos_a


@njit(cache=True, error_model="numpy")
def deformation(x1, q1, x2, q2, lam1, lam2, e):
    """Deformation measure (v, theta) of one element, before e0 is taken off."""
    M = np.empty((3, 3))
    th = np.empty(3)
    u = np.empty(3)
    a, sin_a, cos_a = relative_pose(x1, q1, x2, q2, lam1, lam2, M, th, u)
    q = 4.0 * a * a
    c, _, _, _, _ = stretch_functions(q, a, sin_a, cos_a)
    along = th[0] * u[0] + th[1] * u[1] + th[2] * u[2]
    for i in range(3):
        e[i] = (1.0 + c * q) * u[i] - c * along * th[i]
        e[3 + i] = th[i]


@njit(cache=True, error_model="numpy")
def beam(x1, q1, x2, q2, lam1, lam2, e0, K, g, H):
    """Energy of one element; fills its gradient g (12,) and Hessian H (12, 12).

    Freedoms are (x1, phi1, x2, phi2) with spatial spins phi.
    """
    M = np.empty((3, 3))
    th = np.empty(3)
    u = np.empty(3)
    a, sin_a, cos_a = relative_pose(x1, q1, x2, q2, lam1, lam2, M, th, u)
    q = 4.0 * a * a
    c, c1, c2, tau, tau1 = stretch_functions(q, a, sin_a, cos_a)
    al, al1, al2 = 1.0 + c * q, c1 * q + c, c2 * q + 2.0 * c1
    B = th[0] * u[0] + th[1] * u[1] + th[2] * u[2]
    e = np.empty(6)
    s = np.empty(6)
    for i in range(3):
        e[i] = al * u[i] - c * B * th[i] - e0[i]
        e[3 + i] = th[i] - e0[3 + i]
    energy = 0.0
    for i in range(6):
        s[i] = 0.0
        for j in range(6):
            s[i] += K[i, j] * e[j]
        energy += 0.5 * s[i] * e[i]
    sv, st = s[:3], s[3:]
    A = th[0] * sv[0] + th[1] * sv[1] + th[2] * sv[2]
    S = sv[0] * u[0] + sv[1] * u[1] + sv[2] * u[2]
    N = np.empty(3)  # force in the half-way frame, conjugate to u
    m = np.empty(3)  # conjugate to theta
    for i in range(3):
        N[i] = al * sv[i] - c * A * th[i]
        m[i] = st[i] + 2.0 * (al1 * S - c1 * A * B) * th[i] - c * (B * sv[i] + A * u[i])
    mt = m[0] * th[0] + m[1] * th[1] + m[2] * th[2]
    Pm = np.empty(3)
    for i in range(3):
        Pm[i] = al * m[i] - c * mt * th[i]
    C = np.empty(3)  # N x u, conjugate to mu
    C[0], C[1], C[2] = N[1] * u[2] - N[2] * u[1], N[2] * u[0] - N[0] * u[2], N[0] * u[1] - N[1] * u[0]
    Ct = C[0] * th[0] + C[1] * th[1] + C[2] * th[2]
    X = np.empty(3)  # theta x C
    X[0], X[1], X[2] = th[1] * C[2] - th[2] * C[1], th[2] * C[0] - th[0] * C[2], th[0] * C[1] - th[1] * C[0]
    _gradient(M, N, C, Pm, X, tau, g)

    P = np.empty((3, 3))
    Sk = np.empty((3, 3))
    T = np.empty((3, 3))
    Vt = np.empty((3, 3))  # d(P u)/d theta
    Wt = np.empty((3, 3))  # d(P sv)/d theta
    Gt = np.empty((3, 3))  # second derivative of sv . P u in theta
    for i in range(3):
        for j in range(3):
            unit = 1.0 if i == j else 0.0
            P[i, j] = al * unit - c * th[i] * th[j]
            Vt[i, j] = 2.0 * (al1 * u[i] - c1 * B * th[i]) * th[j] - c * (B * unit + th[i] * u[j])
            Wt[i, j] = 2.0 * (al1 * sv[i] - c1 * A * th[i]) * th[j] - c * (A * unit + th[i] * sv[j])
            yi, yj = B * sv[i] + A * u[i], B * sv[j] + A * u[j]
            Gt[i, j] = (
                2.0 * unit * (al1 * S - c1 * A * B)
                + 4.0 * (al2 * S - c2 * A * B) * th[i] * th[j]
                - 2.0 * c1 * (th[i] * yj + yi * th[j])
                - c * (sv[i] * u[j] + u[i] * sv[j])
            )
    # rows of D: dv and dtheta as functions of (rho, mu, w)
    D = np.zeros((6, 9))
    VP = np.empty((3, 3))
    WP = np.empty((3, 3))
    _skew(u[0], u[1], u[2], Sk)
    _product(P, Sk, T)
    _product(Vt, P, VP)
    _product(Wt, P, WP)
    for i in range(3):
        for j in range(3):
            D[i, j], D[i, 3 + j], D[i, 6 + j], D[3 + i, 6 + j] = P[i, j], T[i, j], VP[i, j], P[i, j]
    KD = np.empty((6, 9))
    for i in range(6):
        for j in range(9):
            total = 0.0
            for k in range(6):
                total += K[i, k] * D[k, j]
            KD[i, j] = total
    Z = np.empty((9, 9))
    for i in range(9):
        for j in range(i, 9):
            total = 0.0
            for k in range(6):
                total += D[k, i] * KD[k, j]
            Z[i, j] = total
    # geometric parts: rho-mu, rho-w, mu-mu, mu-w, w-w
    Nu = N[0] * u[0] + N[1] * u[1] + N[2] * u[2]
    UW = np.empty((3, 3))
    _product(Sk, WP, UW)
    _skew(N[0], N[1], N[2], T)
    for i in range(3):
        for j in range(3):
            unit = 1.0 if i == j else 0.0
            Z[i, 3 + j] -= T[i, j]
            Z[i, 6 + j] += WP[i, j]
            if j >= i:
                Z[3 + i, 3 + j] += 0.5 * (N[i] * u[j] + u[i] * N[j]) - Nu * unit
            Z[3 + i, 6 + j] += 0.25 * tau * (C[i] * th[j] - Ct * unit) - UW[i, j]
    _skew(0.5 * Pm[0], 0.5 * Pm[1], 0.5 * Pm[2], T)
    for i in range(3):
        for j in range(3):
            Z[3 + i, 6 + j] += T[i, j]
    _product(Gt, P, UW)
    _product(P, UW, Gt)
    _skew(C[0], C[1], C[2], Sk)
    _product(Sk, P, UW)
    for i in range(3):
        for j in range(i, 3):
            # sym: -tau/2 [C] P - tau' (C x theta) theta^T + 2 alpha' theta m^T - c theta (P m)^T
            one = -0.5 * tau * UW[i, j] + tau1 * X[i] * th[j] + th[i] * (2.0 * al1 * m[j] - c * Pm[j])
            two = -0.5 * tau * UW[j, i] + tau1 * X[j] * th[i] + th[j] * (2.0 * al1 * m[i] - c * Pm[i])
            Z[6 + i, 6 + j] += Gt[i, j] + 0.5 * (one + two) - mt * (2.0 * c1 * th[i] * th[j] + c * P[i, j])
    _spread(M, th, tau, Z, H)
    return energy


@njit(cache=True, error_model="numpy")
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


@njit(cache=True, error_model="numpy")
def _spread(M, th, tau, Z, H):
    """Hessian (12, 12) from Z (9, 9; upper part) in (rho, mu, w)."""
    S = np.empty((3, 3))
    T = np.empty((3, 3))
    rr = np.empty((3, 3))
    rm = np.empty((3, 3))
    rw = np.empty((3, 3))
    mm = np.empty((3, 3))
    mw = np.empty((3, 3))
    ww = np.empty((3, 3))
    h = -0.5 * tau
    _skew(h * th[0], h * th[1], h * th[2], S)
    for i in range(3):
        for j in range(3):
            rr[i, j] = Z[min(i, j), max(i, j)]
            rm[i, j] = Z[i, 3 + j]
            rw[i, j] = Z[i, 6 + j]
            mm[i, j] = Z[3 + min(i, j), 3 + max(i, j)]
            mw[i, j] = Z[3 + i, 6 + j]
            ww[i, j] = Z[6 + min(i, j), 6 + max(i, j)]
    # mu = mean + S w
    _product(rm, S, T)
    for i in range(3):
        for j in range(3):
            rw[i, j] += T[i, j]
    _product(mm, S, T)
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
    _turned(M, rr, rr, T)
    _turned(M, rm, rm, T)
    _turned(M, rw, rw, T)
    _turned(M, mm, mm, T)
    _turned(M, mw, mw, T)
    _turned(M, ww, ww, T)
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
