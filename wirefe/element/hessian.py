"""Hessians of elements, of several at a time; see `wirefe.element.beam` for the symbols.

The numbers of `LANES` elements stand side by side, so that one instruction of the processor treats those of
four: three times as fast as one after the other. The compiler sees this where the place of a number is its
row times a constant, and the number of elements is not one.
"""

from typing import Any, NamedTuple

import numpy as np

from coilspring.compiling.compiled import arithmetic, zeros
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
from wirefe.element.measure import forces
from wirefe.element.rotations import matrix

LANES, WIDTH = 8, 4  # elements side by side, and how many of them an instruction treats
# Rows of what is given: of `Strain` (M, q, f, theta, u), the forces dU/dv and dU/dtheta, and the stiffness.
TURN, SQUARE, STRETCH, ANGLE, CHORD, FORCE, STIFF = 0, 4, 5, 10, 13, 16, 22
GIVEN, FOUND = 49, 54  # rows


class Blocks(NamedTuple):
    """Blocks of a Hessian in (rho, mu, w)."""

    rr: Any
    rm: Any
    rw: Any
    mm: Any
    mw: Any
    ww: Any


@arithmetic
def _three(table, i, n):
    """Three rows of the n-th element."""
    return table[LANES * i + n], table[LANES * (i + 1) + n], table[LANES * (i + 2) + n]


@arithmetic
def _four(table, i, n):
    """Four rows."""
    return *_three(table, i, n), table[LANES * (i + 3) + n]


@arithmetic
def _nine(table, i, n):
    """A matrix, in nine rows."""
    return *_three(table, i, n), *_three(table, i + 3, n), *_three(table, i + 6, n)


@arithmetic
def _put_three(table, i, n, a):
    """Write three rows."""
    table[LANES * i + n], table[LANES * (i + 1) + n], table[LANES * (i + 2) + n] = a


@arithmetic
def _put_nine(table, i, n, A):
    """Write a matrix into nine rows."""
    p = LANES * i + n
    table[p], table[p + LANES], table[p + 2 * LANES] = A[0], A[1], A[2]
    table[p + 3 * LANES], table[p + 4 * LANES], table[p + 5 * LANES] = A[3], A[4], A[5]
    table[p + 6 * LANES], table[p + 7 * LANES], table[p + 8 * LANES] = A[6], A[7], A[8]


@arithmetic
def hessian_tables(wanted):
    """Tables of what is given of elements and found of their Hessians, empty unless wanted."""
    return zeros(wanted * GIVEN * LANES), np.empty(wanted * FOUND * LANES)


@arithmetic
def give(given, n, strain, v, y, K):
    """Give what the n-th Hessian is made of."""
    M, q, f, th, u = strain
    _put_nine(given, TURN, n, (*M, q, f[0], f[1], f[2], f[3]))
    given[LANES * (STRETCH + 4) + n] = f[4]
    _put_three(given, ANGLE, n, th)
    _put_three(given, CHORD, n, u)
    _put_three(given, FORCE, n, v)
    _put_three(given, FORCE + 3, n, y)
    _put_nine(given, STIFF, n, block(K, 0, 0))
    _put_nine(given, STIFF + 9, n, block(K, 0, 3))
    _put_nine(given, STIFF + 18, n, block(K, 3, 3))


@arithmetic
def hessians(given, found, H):
    """Fill the Hessians H (n, 12, 12) of the elements given last. What an instruction treats beyond them is
    zero, or of elements before, and not read."""
    for n in range((len(H) + WIDTH - 1) // WIDTH * WIDTH):
        _hessian(given, n, found)
    for n in range(len(H)):
        _put_ends(found, n, H[n])


@arithmetic
def _put_ends(found, n, H):
    """Write the blocks of a Hessian (12, 12)."""
    rr, left, right = _nine(found, 0, n), _nine(found, 9, n), _nine(found, 18, n)
    put(H, 0, 0, rr)
    put(H, 6, 6, rr)
    put(H, 6, 0, scaled(-1.0, rr))
    put(H, 0, 3, left)
    put(H, 6, 3, scaled(-1.0, left))
    put(H, 6, 9, right)
    put(H, 0, 9, scaled(-1.0, right))
    put(H, 3, 3, _nine(found, 27, n))
    put(H, 9, 9, _nine(found, 36, n))
    put(H, 3, 9, _nine(found, 45, n))


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
    q, f = given[LANES * SQUARE + n], (*_four(given, STRETCH, n), given[LANES * (STRETCH + 4) + n])
    th, u = _three(given, ANGLE, n), _three(given, CHORD, n)
    s, N, m, Pm, C, X = forces(q, f, th, u, _three(given, FORCE, n), _three(given, FORCE + 3, n))
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
    M = matrix(_four(given, TURN, n))
    _spread(M, skew(th, -0.5 * tau), Blocks(rr, rm, rw, mm, mw, ww), found, n)


@arithmetic
def _material(P, T, V, given, n):
    """Blocks of D^T K D: dv = P rho + T mu + V w, dtheta = P w."""
    stiff, mutual, last = _nine(given, STIFF, n), _nine(given, STIFF + 9, n), _nine(given, STIFF + 18, n)
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
    _put_nine(found, 0, n, rr)
    _put_nine(found, 9, n, added(rw, -0.5, rm))
    _put_nine(found, 18, n, added(rw, 0.5, rm))
    _put_nine(found, 27, n, added(added(same, -0.5, mw), -0.5, turn))
    _put_nine(found, 36, n, added(added(same, 0.5, mw), 0.5, turn))
    _put_nine(found, 45, n, added(added(apart, 0.5, mw), -0.5, turn))
