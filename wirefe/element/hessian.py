"""Gradients and Hessians of elements, of several at a time; see `wirefe.element.beam` for the symbols."""

from typing import Any, NamedTuple

from coilspring.compiling.compiled import arithmetic
from wirefe.element.algebra import (
    added,
    block,
    diagonal,
    dot,
    mixed,
    outer,
    plus,
    product,
    put,
    scaled,
    skew,
    transposed,
)
from wirefe.element.lanes import LANES, get_four, get_nine, get_three, put_nine, put_three, wide
from wirefe.element.measure import ANGLE, CHORD, MEASURED, SQUARE, STRETCH, TURN, forces
from wirefe.element.rotations import matrix, turned

# Rows of what is given besides what is measured: the forces dU/dv and dU/dtheta, and the stiffness.
FORCE, STIFF = MEASURED, MEASURED + 6
GIVEN, FOUND = MEASURED + 33, 54  # rows


class Blocks(NamedTuple):
    """Blocks of a Hessian in (rho, mu, w)."""

    rr: Any
    rm: Any
    rw: Any
    mm: Any
    mw: Any
    ww: Any


@arithmetic
def give_forces(given, n, v, y):
    """Give what the n-th gradient is made of."""
    put_three(given, FORCE, n, v)
    put_three(given, FORCE + 3, n, y)


@arithmetic
def give_stiffness(given, n, K):
    """Give what the n-th Hessian is made of besides."""
    put_nine(given, STIFF, n, block(K, 0, 0))
    put_nine(given, STIFF + 9, n, block(K, 0, 3))
    put_nine(given, STIFF + 18, n, block(K, 3, 3))


@arithmetic
def _given(given, n):
    """Numbers of an element: theta^2, `stretch_functions`, theta, and its forces."""
    q, f = given[LANES * SQUARE + n], (*get_four(given, STRETCH, n), given[LANES * (STRETCH + 4) + n])
    th, u = get_three(given, ANGLE, n), get_three(given, CHORD, n)
    acting = forces(q, f, th, u, get_three(given, FORCE, n), get_three(given, FORCE + 3, n))
    return q, f, th, u, acting


@arithmetic
def gradients(given, found, g):
    """Fill the gradients g (n, 12) of the elements given last."""
    for n in range(wide(len(g))):
        _gradient(given, n, found)
    for n in range(len(g)):
        force = get_three(found, 0, n)
        g[n, 0], g[n, 1], g[n, 2] = -force[0], -force[1], -force[2]
        g[n, 3], g[n, 4], g[n, 5] = get_three(found, 3, n)
        g[n, 6], g[n, 7], g[n, 8] = force
        g[n, 9], g[n, 10], g[n, 11] = get_three(found, 6, n)


@arithmetic
def _gradient(given, n, found):
    """One gradient: the force on the second end, and the moments on the first and the second."""
    _, f, _, _, acting = _given(given, n)
    M = get_four(given, TURN, n)
    mean, bend = turned(M, acting.C), turned(M, plus(acting.Pm, 0.5 * f[3], acting.X))
    put_three(found, 0, n, turned(M, acting.N))
    put_three(found, 3, n, mixed(0.5, mean, -1.0, bend))
    put_three(found, 6, n, mixed(0.5, mean, 1.0, bend))


@arithmetic
def hessians(given, found, H):
    """Fill the Hessians H (n, 12, 12) of the elements given last."""
    for n in range(wide(len(H))):
        _hessian(given, n, found)
    for n in range(len(H)):
        _put_ends(found, n, H[n])


@arithmetic
def _put_ends(found, n, H):
    """Write the blocks of a Hessian (12, 12)."""
    rr, left, right = get_nine(found, 0, n), get_nine(found, 9, n), get_nine(found, 18, n)
    put(H, 0, 0, rr)
    put(H, 6, 6, rr)
    put(H, 6, 0, scaled(-1.0, rr))
    put(H, 0, 3, left)
    put(H, 6, 3, scaled(-1.0, left))
    put(H, 6, 9, right)
    put(H, 0, 9, scaled(-1.0, right))
    put(H, 3, 3, get_nine(found, 27, n))
    put(H, 9, 9, get_nine(found, 36, n))
    put(H, 3, 9, get_nine(found, 45, n))


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
def _hessian(given, n, found):
    """One Hessian: blocks in the half-way frame's (rho, mu, w), then in the dofs of the ends."""
    q, f, th, u, (s, N, m, Pm, C, X) = _given(given, n)
    c, c1, tau, tau1 = f[0], f[1], f[3], f[4]
    P, V, W, G = _derivatives(q, f, th, u, s)
    S = skew(u, 1.0)
    rr, rm, rw, mm, mw, ww = _material(P, product(P, S), V, given, n)
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
    M = matrix(get_four(given, TURN, n))
    _spread(M, skew(th, -0.5 * tau), Blocks(rr, rm, rw, mm, mw, ww), found, n)


@arithmetic
def _material(P, T, V, given, n):
    """Blocks of D^T K D: dv = P rho + T mu + V w, dtheta = P w."""
    stiff, mutual, last = (
        get_nine(given, STIFF, n),
        get_nine(given, STIFF + 9, n),
        get_nine(given, STIFF + 18, n),
    )
    slide = product(stiff, T)
    force = added(product(stiff, V), 1.0, product(mutual, P))
    moment = added(product(transposed(mutual), V), 1.0, product(last, P))
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
def _spread(M, S, blocks, found, n):
    """Blocks of the Hessian in the ends' dofs from those in (rho, mu, w): mu = mean + S w."""
    rr, rm, rw, mm, mw, ww = blocks
    T = product(mm, S)
    rw = added(rw, 1.0, product(rm, S))
    half = product(transposed(S), added(mw, 0.5, T))
    ww = added(added(ww, 1.0, half), 1.0, transposed(half))
    mw = added(mw, 1.0, T)
    Mt = transposed(M)
    rr, rm, rw = product(M, product(rr, Mt)), product(M, product(rm, Mt)), product(M, product(rw, Mt))
    mm, mw, ww = product(M, product(mm, Mt)), product(M, product(mw, Mt)), product(M, product(ww, Mt))
    turn = transposed(mw)
    same, apart = added(ww, 0.25, mm), added(scaled(0.25, mm), -1.0, ww)
    put_nine(found, 0, n, rr)
    put_nine(found, 9, n, added(rw, -0.5, rm))
    put_nine(found, 18, n, added(rw, 0.5, rm))
    put_nine(found, 27, n, added(added(same, -0.5, mw), -0.5, turn))
    put_nine(found, 36, n, added(added(same, 0.5, mw), 0.5, turn))
    put_nine(found, 45, n, added(added(apart, 0.5, mw), -0.5, turn))
