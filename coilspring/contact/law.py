"""Penalty contact of a pair: one law for both models.

With the centres of a pair, g = cB - cA and h = |g|, the potential is ``K max(0, d - h)^(k+1)/(k+1)``.
Where sliding is off, a closed pair also has ``1/2 Kt |e|^2``, Kt = K d^(k-1), with
``e = (I - n0 n0^T)(g - g0)``, g0 and n0 being the vector and its direction where the pair touched first.

With Coulomb friction the slip of one sphere over the other is the arc ``l = d acos(n0 . n)``, n = g/h, so
that the force turns with the pair, and its size is that of return mapping (Simo & Hughes 1998, Computational
Inelasticity, chapter 2): ``Kt l`` up to a bound. Within a substep the bound is a line over what slides in it,
``b (1 + r s)``, so that the pair keeps a potential; the path follower renews b until the line meets the bound
``mu F`` of the normal force at the slip that is found. The rise r is no part of the law then, but of the
matrix (`coilspring.solver.tangential.friction`). What slid is taken off l when the substep is accepted:
`coilspring.contact.transitions`.
"""

import math
from typing import Any, NamedTuple, Self

import numpy as np

from coilspring.compiling.compiled import clear, clear_table, inlined

# What contact remembers of a pair.
PAIR_HISTORY = np.dtype(
    [
        ("closed", "?"),  # the pair is held
        ("vector", "f8", 3),  # g0, mm
        ("normal", "f8", 3),  # n0
        ("whole", "f8"),  # tangential stiffness, N/mm,
        ("stiffness", "f8"),  # and the same where hard contact just touches: softer
        ("bound", "f8"),  # of its tangential force before it slides in the substep at hand, N
        ("slid", "f8"),  # length it has slid, mm
        ("work", "f8"),  # that friction and releases have taken on the path, N mm
        ("rise", "f8"),  # r, 1/mm
        ("slip", "f8"),  # what it slides in this substep, or slid in the last one; negative: it sticks, mm
        ("fresh", "?"),  # it touched first in the substep at hand
        ("opening", "?"),  # it touches no more: what it holds tangentially is being released
        ("grazes", "?"),  # it has opened so and touches again: it gives way so that it just touches
        ("released", "f8"),  # share of its tangential stiffness that is taken away in the trial state,
        ("kept", "f8"),  # and that was left in the last accepted one
        (
            "before",
            "f8",
        ),  # how far it was stretched tangentially in that, along its slip now, mm,
        ("deep", "f8"),  # and how far one with friction penetrated, mm
        ("least", "f8"),  # share that is left to a grazing pair: with this it is pressed,
        ("most", "f8"),  # and with this it opens, in the substep at hand
        ("gap", "f8"),  # of such a pair, or one with friction, in the trial state, mm,
        ("sticking", "f8"),  # and the tangential force that would hold all of it, N
        ("steepness", "f8"),  # of the bound of one with friction, by how far it penetrates, N/mm
        ("cut", "f8"),  # share of the substep to try instead: to where it touches or opens
        ("growth", "f8"),  # rate at which the force of one that grazes grows, N
        ("held", "f8"),  # its tangential force, or the bound of it, in the last accepted state, N
        ("arms", "f8", 6),  # of wires: the material points that touched first, in their sections at rest, mm
        ("stride", "f8"),  # what a pair with friction slid in the substep before, mm,
        ("onward", "f8", 6),  # and how its reference moved with that: rad of n0, or mm of the arms
        ("wanted", "f8"),  # share of that by which the reference is to be ahead in the substep at hand,
        ("lead", "f8"),  # and by which it is;
        ("ahead", "f8"),  # part of that along the slide at hand, mm
    ],
    align=True,
)


class PairLaw(NamedTuple):
    """What holds the pairs of a model; in kernels arrays with these fields stand for it."""

    d: float  # distance of two centres that touch, mm
    kc: float  # penalty K of a pair, N/mm^k
    kt: float  # its tangential stiffness, N/mm
    k: float  # exponent
    mu: float  # coefficient of friction; infinite where pairs stick

    @classmethod
    def of(cls, data: Any) -> Self:
        """The law in a model's arrays."""
        return cls(*(getattr(data, name) for name in cls._fields))


NO_PAIRS = PairLaw(1.0, 1.0, 1.0, 1.0, 0.0)


@inlined
def tangential_stiffness(K: float, k: float, d: float) -> float:
    """Tangential stiffness of a pair, N/mm: K where the law is linear, whatever the units otherwise."""
    return K * d ** (k - 1.0)


@inlined
def normal_law(penetration, K, k):
    """Energy, normal force and its derivative by the penetration (>= 0): F = K penetration^k, (12).

    The one place of the law: kernels compile it, and what reads forces off states calls it as plain Python.
    """
    power = penetration ** (k - 1.0) if k != 1.0 else 1.0  # a power takes as long as a pair besides
    F = K * penetration * power
    return F * penetration / (k + 1.0), F, K * k * power


@inlined
def stretch(g, row, e):
    """Tangential vector e = (I - n0 n0^T)(g - g0) of a held pair; returns its length."""
    along, square = 0.0, 0.0
    for i in range(3):
        along += row.normal[i] * (g[i] - row.vector[i])
    for i in range(3):
        e[i] = g[i] - row.vector[i] - along * row.normal[i]
        square += e[i] * e[i]
    return math.sqrt(square)


@inlined
def arc(g, h, row, t):
    """Angle from n0 to the direction n of g; `t` is the unit vector along which it grows, or zero.

    Both directions are rounded, and t must be perpendicular to n to the last digit: hard contact slides by
    angles of 1e-11, and what is left of n in t would be a negative stiffness.
    """
    square, along, sine = 0.0, 0.0, 0.0
    for i in range(3):
        t[i] = g[i] / h - row.normal[i]
        square += t[i] * t[i]
        along += t[i] * g[i] / h
    for i in range(3):
        t[i] -= along * g[i] / h
        sine += t[i] * t[i]
    sine = math.sqrt(sine)
    for i in range(3):
        t[i] = t[i] / sine if sine > 0.0 else 0.0
    return 2.0 * math.asin(min(0.5 * math.sqrt(square), 1.0))


@inlined
def tangential_law(length, row):
    """Energy, force and its derivative of a held pair at a slip of the length given, from its reference."""
    K = row.stiffness * (1.0 - row.released)
    force, slope, energy = K * length, K, 0.5 * K * length**2
    if force > row.bound:
        rise = row.bound * row.rise
        slip = (force - row.bound) / (K + rise)
        force = row.bound + rise * slip
        slope = K * rise / (K + rise)
        energy = 0.5 * force**2 / K + (row.bound + 0.5 * rise * slip) * slip
    return energy, force, slope


@inlined
def rate_by_bound(length, row):
    """Derivative of the force of a pair that slides by its bound."""
    K, rise = row.stiffness * (1.0 - row.released), row.bound * row.rise
    return (1.0 + row.rise * length) * (K / (K + rise)) ** 2


@inlined
def _add_stuck(g, row, e, f, H):
    """Energy of a pair that sticks; adds its gradient and Hessian."""
    length = stretch(g, row, e)
    energy, force, slope = tangential_law(length, row)
    ratio = force / length if length > 0.0 else slope
    more = (slope - ratio) / length**2 if length > 0.0 else 0.0
    for i in range(3):
        f[i] += ratio * e[i]
        H[i, i] += ratio
        for j in range(3):
            H[i, j] += more * e[i] * e[j] - ratio * row.normal[i] * row.normal[j]
    return energy


@inlined
def _add_friction(g, h, d, row, t, f, H):
    """Energy of a pair with a bounded tangential force; adds its gradient and Hessian."""
    angle = arc(g, h, row, t)
    energy, force, slope = tangential_law(d * angle, row)
    # force over the tangent of the angle
    across = force / math.tan(angle) if angle > 0.0 else slope * d
    force, across, slope = force * d / h, across * d / h**2, slope * (d / h) ** 2
    for i in range(3):
        f[i] += force * t[i]
        H[i, i] += across
        for j in range(3):
            n = g[i] * g[j] / h**2
            H[i, j] += (
                (slope - across) * t[i] * t[j] - across * n - force * (g[i] * t[j] + t[i] * g[j]) / h**2
            )
    return energy


@inlined
def pair_potential(g, h, law, row, e, f, H):
    """Energy of a pair as a function of g; fills its gradient f (3,) and Hessian H (3, 3).

    `law` is a `PairLaw`, `row` the pair's record of the contact history; `e` is scratch (3,).
    """
    energy = 0.0
    clear(f)
    clear_table(H)
    if law.d > h:
        energy, F, slope = normal_law(law.d - h, law.kc, law.k)
        turn = F / h
        for i in range(3):
            ni = g[i] / h
            f[i] = -F * ni
            H[i, i] = -turn
            for j in range(3):
                H[i, j] += (slope + turn) * ni * g[j] / h
    if row.closed:
        if row.bound == math.inf and not row.grazes:
            energy += _add_stuck(g, row, e, f, H)
        else:
            energy += _add_friction(g, h, law.d, row, e, f, H)
    return energy
