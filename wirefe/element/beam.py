"""Two-node beam element with the logarithm on SE(3) as deformation measure.

The end frames are R1, R2 (node rotation times the element's own end triad), r = x2 - x1. With
``theta = log(R1^T R2)``, the frame half way ``M = R1 exp(theta/2)`` and ``u = M^T r``,

    P(theta) = alpha I - c theta theta^T,  alpha = (theta/2) / sin(theta/2) = 1 + c theta^2
    v = P u,   e = (v, theta) - e0,   eta = e - 1/2 Q(e, e),   energy = 1/2 eta^T K eta

eta are amplitudes of strains of a curved piece that make e to second order (`wirefe.element.curved`); Q = 0
where it is straight. (v, theta) is the logarithm of the relative pose (Sonneville, Cardona & Bruls 2014,
CMAME 268, eq. 14 ff., written here in the half-way frame, in which P is symmetric). A rigid motion leaves it
unchanged, and K may be any stiffness of a piece of wire. Variations use spatial spins phi_i of the nodes:

    rho = M^T (dx2 - dx1),  w = M^T (phi2 - phi1),  mu = M^T (phi1 + phi2)/2 - tau/2 theta x w
    dtheta = P w,   du = rho + u x mu,   tau = tan(theta/4)/theta

The Hessian is that along the exponential map, hence symmetric; docs/theory.md derives it.
"""

import math
from typing import Any, NamedTuple

import numpy as np

from coilspring.compiling.compiled import arithmetic, kernel
from wirefe.element.algebra import (
    added,
    block,
    cross,
    diagonal,
    dot,
    lever,
    mixed,
    outer,
    plus,
    product,
    put,
    scaled,
    skew,
    transposed,
)
from wirefe.element.elastic import elastic, stiffness
from wirefe.element.poses import pose, three
from wirefe.element.rotations import conjugate, matrix, stretch_functions, times, turned


class Strain(NamedTuple):
    """How an element is deformed; vectors and matrices are tuples, which stay in registers."""

    M: Any  # half-way frame, a quaternion
    q: Any  # theta^2
    f: Any  # `stretch_functions`
    th: Any  # theta
    u: Any


class Forces(NamedTuple):
    """Forces of an element, conjugate to the variations."""

    s: Any  # dU/dv
    N: Any  # to u
    m: Any  # to theta
    Pm: Any  # to w
    C: Any  # N x u, to mu
    X: Any  # theta x C


class Blocks(NamedTuple):
    """Blocks of a Hessian in (rho, mu, w)."""

    rr: Any
    rm: Any
    rw: Any
    mm: Any
    mw: Any
    ww: Any


@arithmetic
def _strain(state, n, triads, arm):
    """`Strain` of the n-th element; relative rotations reach to 180 degrees.

    The wire's end stands off from the last node by `arm`.
    """
    last = n == len(triads) - 1
    p1, p2, M, u, _ = pose(state, n, triads[n], three(arm, 0) if last else (0.0, 0.0, 0.0))
    # cos a, and sin a times the axis, which is the same in R1, M and R2; a = theta/2
    h = times(conjugate(p1), p2)
    sin_a = math.sqrt(h[1] * h[1] + h[2] * h[2] + h[3] * h[3])
    a = math.atan2(sin_a, h[0])
    twice = 2.0 * a / sin_a if sin_a > 0.0 else 2.0
    q = 4.0 * a * a
    th = (twice * h[1], twice * h[2], twice * h[3])
    return Strain(M, q, stretch_functions(q, a, sin_a, h[0]), th, u)


@arithmetic
def _stretched(q, f, th, x):
    """P x."""
    return mixed(1.0 + f[0] * q, x, -f[0] * dot(th, x), th)


@kernel
def deformations(state, arm, triads, e):
    """Deformation measures (v, theta) of all elements, shape (n, 6), before e0 is taken off."""
    for n in range(len(triads)):
        _, q, f, th, u = _strain(state, n, triads, arm)
        e[n, 0], e[n, 1], e[n, 2] = _stretched(q, f, th, u)
        e[n, 3], e[n, 4], e[n, 5] = th


@arithmetic
def beams(state, arm, triads, e0, K, Q, g, H):
    """Energy of all elements; fills their gradients g (n, 12) and Hessians H (n, 12, 12), if not empty.

    Freedoms of an element are (x1, phi1, x2, phi2) with spatial spins phi, x its ends.

    Parameters
    ----------
    state : a row for each node, see `wirefe.element.poses`.
    arm : (3,) from the last node to the last element's end, at rest.
    triads : (n, 2, 4) end frames at rest, unit quaternions.
    e0 : (n, 6) deformation measures at rest.
    K : (n, 6, 6) stiffnesses in eta, symmetric.
    Q : (n, 6, 36), symmetric in its last two sixes; (0, 6, 36) where eta = e.
    """
    energy, A, KA, now = 0.0, np.empty((6, 6)), np.empty((6, 6)), np.empty((6, 6))
    for n in range(len(triads)):
        strain = _strain(state, n, triads, arm)
        M, q, f, th, u = strain
        work, s, v, y = elastic(_deformed(q, f, th, u, e0[n]), K[n], Q, n, A)
        energy += work
        forces = _forces(q, f, th, u, v, y)
        _gradient(M, forces.N, forces.C, forces.Pm, forces.X, f[3], g[n])
        if n < len(H):
            stiffness(K[n], Q, n, s, A, KA, now)
            _hessian(strain, forces, now, H[n])
    return energy


@kernel
def end_forces(state, arm, triads, e0, K, Q, g):
    """Fill the gradients g (n, 12) of all elements: what acts on their ends; see `beams`."""
    A = np.empty((6, 6))
    for n in range(len(triads)):
        M, q, f, th, u = _strain(state, n, triads, arm)
        _, _, v, y = elastic(_deformed(q, f, th, u, e0[n]), K[n], Q, n, A)
        forces = _forces(q, f, th, u, v, y)
        _gradient(M, forces.N, forces.C, forces.Pm, forces.X, f[3], g[n])


@arithmetic
def _deformed(q, f, th, u, e0):
    """e of one element."""
    v = _stretched(q, f, th, u)
    return v[0] - e0[0], v[1] - e0[1], v[2] - e0[2], th[0] - e0[3], th[1] - e0[4], th[2] - e0[5]


@arithmetic
def _forces(q, f, th, u, s, y):
    """`Forces` of one element from dU/dv and dU/dtheta."""
    c, c1 = f[0], f[1]
    al, al1 = 1.0 + c * q, c1 * q + c
    A, B, S = dot(th, s), dot(th, u), dot(s, u)
    m = plus(y, 2.0 * (al1 * S - c1 * A * B), th)
    m = plus(m, -c, mixed(B, s, A, u))
    N = mixed(al, s, -c * A, th)
    C = cross(N, u)
    return Forces(s, N, m, _stretched(q, f, th, m), C, cross(th, C))


@arithmetic
def _gradient(M, N, C, Pm, X, tau, g):
    """Gradient (12,) from the forces in the half-way frame `M`."""
    force, mean, bend = turned(M, N), turned(M, C), turned(M, plus(Pm, 0.5 * tau, X))
    g[0], g[1], g[2] = -force[0], -force[1], -force[2]
    g[6], g[7], g[8] = force[0], force[1], force[2]
    g[3], g[4], g[5] = mixed(0.5, mean, -1.0, bend)
    g[9], g[10], g[11] = mixed(0.5, mean, 1.0, bend)


@arithmetic
def _derivatives(q, f, th, u, s):
    """P, d(P u)/dtheta P, d(P s)/dtheta P, and P times the second derivative of s . P u times P."""
    c, c1, c2 = f[0], f[1], f[2]
    al1, al2 = c1 * q + c, c2 * q + 2.0 * c1
    A, B, S = dot(th, s), dot(th, u), dot(s, u)
    P = diagonal(outer(-c, th, th), 1.0 + c * q)
    V = added(outer(2.0, mixed(al1, u, -c1 * B, th), th), -c, diagonal(outer(1.0, th, u), B))
    W = added(outer(2.0, mixed(al1, s, -c1 * A, th), th), -c, diagonal(outer(1.0, th, s), A))
    y = mixed(B, s, A, u)
    # half of the latter: 2 (al2 S - c2 A B) theta theta^T - 2 c1 theta y^T - c s u^T + ...
    half = outer(2.0, th, mixed(al2 * S - c2 * A * B, th, -c1, y))
    half = diagonal(added(half, 1.0, outer(-c, s, u)), al1 * S - c1 * A * B)
    G = product(P, product(added(half, 1.0, transposed(half)), P))
    return P, product(V, P), product(W, P), G


@arithmetic
def _hessian(strain, forces, K, H):
    """Hessian (12, 12): blocks in the half-way frame's (rho, mu, w), then in the dofs of the ends."""
    M, q, f, th, u = strain
    s, N, m, Pm, C, X = forces
    c, c1, tau, tau1 = f[0], f[1], f[3], f[4]
    P, V, W, G = _derivatives(q, f, th, u, s)
    S = skew(u, 1.0)
    rr, rm, rw, mm, mw, ww = _material(P, product(P, S), V, K)
    # what the forces do along the second derivatives
    rm = added(rm, -1.0, skew(N, 1.0))
    rw = added(rw, 1.0, W)
    half = outer(0.5, N, u)
    mm = diagonal(added(added(mm, 1.0, half), 1.0, transposed(half)), -dot(N, u))
    mw = added(added(mw, -1.0, product(S, W)), 1.0, skew(Pm, 0.5))
    mw = diagonal(added(mw, 0.25 * tau, outer(1.0, C, th)), -0.25 * tau * dot(C, th))
    # half of -tau/2 [C] P + tau' X theta^T + theta (2 alpha' m - c P m - 2 c' (m . theta) theta)^T
    half = added(outer(0.5 * tau1, X, th), -0.25 * tau, product(skew(C, 1.0), P))
    bend = plus(mixed(c + c1 * q, m, -0.5 * c, Pm), -c1 * dot(m, th), th)
    half = added(half, 1.0, outer(1.0, th, bend))
    ww = added(added(ww, 1.0, half), 1.0, transposed(half))
    ww = added(added(ww, 1.0, G), -c * dot(m, th), P)
    _spread(matrix(M), skew(th, -0.5 * tau), Blocks(rr, rm, rw, mm, mw, ww), H)


@arithmetic
def _material(P, T, V, K):
    """Blocks of D^T K D: dv = P rho + T mu + V w, dtheta = P w."""
    stiff, mutual = block(K, 0, 0), block(K, 0, 3)
    slide = product(stiff, T)
    force = added(product(stiff, V), 1.0, product(mutual, P))
    moment = added(product(transposed(mutual), V), 1.0, product(block(K, 3, 3), P))
    Tt = transposed(T)
    ww = added(product(transposed(V), force), 1.0, product(P, moment))
    return Blocks(
        product(P, product(stiff, P)),
        product(P, slide),
        product(P, force),
        product(Tt, slide),
        product(Tt, force),
        ww,
    )


@arithmetic
def _spread(M, S, blocks, H):
    """Hessian (12, 12) of the ends' dofs from the blocks in (rho, mu, w): mu = mean + S w."""
    rr, rm, rw, mm, mw, ww = blocks
    T = product(mm, S)
    rw = added(rw, 1.0, product(rm, S))
    half = product(transposed(S), added(mw, 0.5, T))
    ww = added(added(ww, 1.0, half), 1.0, transposed(half))
    mw = added(mw, 1.0, T)
    Mt = transposed(M)
    rr, rm, rw = product(M, product(rr, Mt)), product(M, product(rm, Mt)), product(M, product(rw, Mt))
    mm, mw, ww = product(M, product(mm, Mt)), product(M, product(mw, Mt)), product(M, product(ww, Mt))
    put(H, 0, 0, rr)
    put(H, 6, 6, rr)
    put(H, 6, 0, scaled(-1.0, rr))
    left, right = added(rw, -0.5, rm), added(rw, 0.5, rm)
    put(H, 0, 3, left)
    put(H, 6, 3, scaled(-1.0, left))
    put(H, 6, 9, right)
    put(H, 0, 9, scaled(-1.0, right))
    turn = transposed(mw)
    same, apart = added(ww, 0.25, mm), added(scaled(0.25, mm), -1.0, ww)
    put(H, 3, 3, added(added(same, -0.5, mw), -0.5, turn))
    put(H, 9, 9, added(added(same, 0.5, mw), 0.5, turn))
    put(H, 3, 9, added(added(apart, 0.5, mw), -0.5, turn))


@arithmetic
def onto_reference(r, g, K):
    """Carry an element's gradient (12,) and Hessian (1, 12, 12), or none, from its second end over to a node
    from which that stands off by `r`: dx = dX - r x phi, and the lever of the force."""
    F = three(g, 6)
    x, y, z = cross(r, F)
    g[9], g[10], g[11] = g[9] + x, g[10] + y, g[11] + z
    if len(K) == 0:
        return
    R, H = skew(r, -1.0), K[0]
    moved = added(block(H, 6, 9), 1.0, product(block(H, 6, 6), R))
    own = added(block(H, 9, 9), 1.0, product(block(H, 9, 6), R))
    put(H, 9, 9, added(added(own, -1.0, product(R, moved)), 1.0, lever(F, r)))
    put(H, 6, 9, moved)
    put(H, 0, 9, added(block(H, 0, 9), 1.0, product(block(H, 0, 6), R)))
    put(H, 3, 9, added(block(H, 3, 9), 1.0, product(block(H, 3, 6), R)))
