"""The helix law of a half coil: Love's helix in large deformation on its axis, wire theory across it.

    U = E(l) + (v - v0(l))^2 / (2 Csh) + (dtheta - dtheta0(l))^2 / (2 Cfl)     (B5)

E(l): wire of length s, at rest with torsion tau0 and curvature kappa0; u is the sine of the angle between
the normals of its sections and the plane of a coil, c = sqrt(1 - u^2), omega the winding angle per length::

    held:  e(u) = 1/2 GJ (omega u - tau0)^2 + 1/2 EI (omega c - kappa0)^2,  omega = pi / s
    free:  e(u) = 1/2 GJ EI (tau0 c - kappa0 u)^2 / (GJ u^2 + EI c^2)          (B6)
    f(u) = c^2 / GA + u^2 / EA      shear and stretch of the wire under an axial force
    F + 1/2 F^2 f'(u) = e'(u)       balance of moments of a section            (B7)
    l = s (u + F f(u))              solved for u                               (B8)
    E = s (e + 1/2 F^2 f),  E' = F,  E'' = F_u / l_u                           (B9)

Love (1927), articles 270 and 271, is the case without shear and stretch.
Csh, Cfl: lateral and bending flexibility of the wire, averaged over a turn, at x = (l/s)^2::

    Cfl = s b(x),  b = (1 - x) / (2 GJ) + (1 + x) / (2 EI)                     (B10)
    Csh = s [L^2 (1 - x)/2 (x/GJ + (1 - x)/EI) + (1 - x)/(2 EA) + (1 + x)/(2 GA)] + l^2 Cfl / 12   (B11)

with L the length of wire per radian. The last term spreads the bending over the half coil, which has
it in its middle.

v0, dtheta0: what the axial force alone does besides, by the angle alpha = asin(l/s) and the radius
rho = L cos(alpha) of the helix, chi = alpha - alpha0, from psi_1 to psi_2 counted from the beam's plane::

    dtheta0 = -m chi,  m = int (r / r_mean)^2 cos(psi) dpsi                    (B12)
    v0 = (cos psi_2 - cos psi_1) (rho - rho0) - (sin psi_1 + sin psi_2) / 2 chi l    (B13)

The wire turns about its own radius as its angle changes, and a node, which stands at the radius at rest from
the wire, moves as the coil grows. Where the wire is fixed the axis is so tilted and offset. The part
of the flexibilities that the length contributes is subtracted from Cfl and Csh. Derivation: docs/theory.md.
"""

import math
from dataclasses import dataclass

import numpy as np

from coilspring.compiling.compiled import inlined, kernel
from coilspring.errors import InputError
from coilspring.scene.material import Material
from coilspring.scene.solidwire import coil_section
from coilspring.scene.spring import Spring
from coilspring.words import shown
from equivbeam.element import Response
from equivbeam.halfcoils import HalfCoils, half_coils
from equivbeam.laws.haringx import KAX, haringx_stiffness

# columns of the table of parameters; B0.. and H0.. are the polynomials of (B10) and (B11) in x, G1.. the
# series of u - u0 in l/s - l0/s, from which (B8) is solved
RATE, S, PER_S, L0, GJ, EI, IGA, IEA, OMEGA, TAU0, KAPPA0, FREE, U0 = range(13)
B0, B1, H0, H1, H2, G1, G2, G3, U_LOW, U_HIGH, LOW, HIGH = range(13, 25)
# factors in (B12) and (B13): of chi, of rho - rho0 and of chi l
TILT, SWELL, TIP = 25, 26, 27
COLUMNS = 28

CLOSE = 1e-7  # step in u whose square is rounding: E and its derivatives are carried along it
MOST_STEPS = 30
SERIES_STEP = 0.05  # of the cosine, over which the series is differenced
SHRINK = 0.05  # of a range in which the law does not hold
# The law is followed until the wire is straight but for this cosine, or half the cosine at rest,
LEAST_COSINE = 0.2
LEAST_ROOT = 0.5  # and while (B7), which has no root under a force that shears the wire flat, is clear of it
STRAIGHT = 0.05  # cosine of the angle of a helix of 87 degrees
POINTS = 16  # of Gauss's rule for (B12)
MOST_TAKEN = 0.5  # share of a flexibility, at most, that the length contributes and that is subtracted


@inlined
def _wound(rows, i, u):
    """(B6): e, e', e'' at the sine u."""
    gj, ei, t0, k0 = rows[i, GJ], rows[i, EI], rows[i, TAU0], rows[i, KAPPA0]
    cc = 1.0 - u * u
    c = math.sqrt(cc)
    sec = 1.0 / c
    if rows[i, FREE] == 0.0:
        w = rows[i, OMEGA]
        dt, dk = w * u - t0, w * c - k0
        bend = ei * dk * sec
        e = 0.5 * (gj * dt * dt + ei * dk * dk)
        return e, w * (gj * dt - bend * u), w * (gj * w + (ei * w * u * u - bend) * sec * sec)
    m, m1, m2 = t0 * c - k0 * u, -t0 * u * sec - k0, -t0 * sec**3
    a, a1, a2 = gj * u * u + ei * cc, 2.0 * (gj - ei) * u, 2.0 * (gj - ei)
    p, p1, p2 = m * m, 2.0 * m * m1, 2.0 * (m1 * m1 + m * m2)
    q = p / a  # e = 1/2 GJ EI p / a
    q1 = (p1 - q * a1) / a
    q2 = (p2 - 2.0 * q1 * a1 - q * a2) / a
    return 0.5 * gj * ei * q, 0.5 * gj * ei * q1, 0.5 * gj * ei * q2


@inlined
def _section(rows, i, u):
    """(B7)-(B9) at the sine u: l / s, its rate in u, and E / s, F, F_u."""
    e, e1, e2 = _wound(rows, i, u)
    d = rows[i, IEA] - rows[i, IGA]
    f, f1 = rows[i, IGA] + d * u * u, 2.0 * d * u
    root = math.sqrt(1.0 + 2.0 * f1 * e1)
    F = 2.0 * e1 / (1.0 + root)
    F_u = (e2 - F * F * d) / root
    return u + F * f, 1.0 + F_u * f + F * f1, e + 0.5 * F * F * f, F, F_u


@inlined
def axial(rows, i, l):  # noqa: E741
    """E, E', E'' at the length l; beyond the range of the law a parabola of the same curvature."""
    if rows[i, RATE] > 0.0:
        N = rows[i, RATE] * (l - rows[i, L0])
        return 0.5 * N * (l - rows[i, L0]), N, rows[i, RATE]
    s, per = rows[i, S], rows[i, PER_S]
    y = min(max(l, rows[i, LOW]), rows[i, HIGH]) * per  # has a root between the limits of u
    z = y - rows[i, U0]
    u = rows[i, U0] + z * (rows[i, G1] + z * (rows[i, G2] + z * rows[i, G3]))
    E = F = k = rest = 0.0
    for _ in range(MOST_STEPS):
        u = min(max(u, rows[i, U_LOW]), rows[i, U_HIGH])
        at, slope, E, F, F_u = _section(rows, i, u)
        u_l = 1.0 / slope
        step, k = (y - at) * u_l, F_u * u_l * per
        rest = l - s * at  # what is left of the length
        if abs(step) < CLOSE:
            break
        u += step
    return s * E + (F + 0.5 * k * rest) * rest, F + k * rest, k


@kernel
def set_range(rows):
    """Set the sines and lengths between which the law holds, and the series in G1.."""
    for i in range(len(rows)):
        u0 = rows[i, U0]
        cosine = min(LEAST_COSINE, 0.5 * math.sqrt(1.0 - u0 * u0))
        _set_series(rows, i, SERIES_STEP * cosine)
        for side in range(2):
            u = math.sqrt(1.0 - cosine * cosine) * (1.0 if side == 1 else -1.0)
            at, slope, _, F, F_u = _section(rows, i, u)
            # the root is of 1 + 2 f' e' = (1 + F f')^2, not a number where it has none
            while not (
                1.0 + 2.0 * F * u * (rows[i, IEA] - rows[i, IGA]) >= LEAST_ROOT
                and F_u > 0.0
                and slope > 0.0
                and abs(at) < 1.0
            ):
                u += SHRINK * (u0 - u)
                at, slope, _, F, F_u = _section(rows, i, u)
            rows[i, U_LOW + side], rows[i, LOW + side] = u, rows[i, S] * at


@inlined
def _set_series(rows, i, h):
    """Inverse of the series of (B8) at rest, whose second and third term are by differences over `h`."""
    u0 = rows[i, U0]
    _, first, _, _, _ = _section(rows, i, u0)
    _, ahead, _, _, _ = _section(rows, i, u0 + h)
    _, behind, _, _, _ = _section(rows, i, u0 - h)
    second, third = 0.5 * (ahead - behind) / h / first, (ahead - 2.0 * first + behind) / (h * h) / first
    rows[i, G1] = 1.0 / first
    rows[i, G2] = -0.5 * second / first**2
    rows[i, G3] = (0.5 * second * second - third / 6.0) / first**3


@inlined
def _square(rows, i, l):  # noqa: E741
    """x = (l/s)^2 and its derivatives; beyond the range it tends to 1 (or 0) without leaving [0, 1]."""
    curve = 2.0 * rows[i, PER_S] * rows[i, PER_S]
    if rows[i, LOW] <= l <= rows[i, HIGH]:
        return 0.5 * curve * l * l, curve * l, curve
    end = min(max(l, rows[i, LOW]), rows[i, HIGH])
    far = 1.0 if end * (l - end) > 0.0 else 0.0
    x, x1 = 0.5 * curve * end * end, curve * end
    rate = abs(x1 / (far - x))
    decay = math.exp(-rate * abs(l - end))
    x1 *= decay
    return far - (far - x) * decay, x1, -math.copysign(rate, l - end) * x1


@inlined
def winding(rows, i, l):  # noqa: E741
    """chi and rho - rho0 at the length l, each with its derivatives; beyond the range straight lines."""
    per, slant = rows[i, PER_S], 1.0 / rows[i, OMEGA]
    end = min(max(l, rows[i, LOW]), rows[i, HIGH])
    y, y0 = end * per, rows[i, L0] * per
    c, c0 = math.sqrt(1.0 - y * y), math.sqrt(1.0 - y0 * y0)
    rate = per / c
    bend = rate * rate / c if l == end else 0.0
    chi = math.asin(y * c0 - y0 * c) + (l - end) * rate
    return chi, rate, y * bend, slant * (c - c0 - (l - end) * y * rate), -slant * y * rate, -slant * bend


@inlined
def helix_response(rows, i, l, v, dth):  # noqa: E741
    """Response of one half coil: (B5)."""
    E, N, N_l = axial(rows, i, l)
    x, x1, x2 = _square(rows, i, l)
    h1 = rows[i, H1] + 2.0 * rows[i, H2] * x
    ksh = 1.0 / (rows[i, H0] + x * (rows[i, H1] + x * rows[i, H2]))
    kfl = 1.0 / (rows[i, B0] + x * rows[i, B1])
    # v0 and -dtheta0 and their derivatives in l
    chi, chi1, chi2, rho, rho1, rho2 = winding(rows, i, l)
    m, swell, tip = rows[i, TILT], rows[i, SWELL], rows[i, TIP]
    m1, m2 = m * chi1, m * chi2
    v1, v2 = swell * rho1 + tip * (chi + l * chi1), swell * rho2 + tip * (2.0 * chi1 + l * chi2)
    v -= swell * rho + tip * chi * l
    dth += m * chi
    # derivatives of the flexibilities in l, and with K = 1/C: K' = -C' K^2, K'' = (2 C'^2 K - C'') K^2
    C1, C2 = h1 * x1, 2.0 * rows[i, H2] * x1 * x1 + h1 * x2
    D1, D2 = rows[i, B1] * x1, rows[i, B1] * x2
    T, M = ksh * v, kfl * dth
    N_v, N_m = -ksh * (C1 * T + v1), kfl * (m1 - D1 * M)
    N -= 0.5 * (C1 * T * T + D1 * M * M) + T * v1 - M * m1
    N_l += (C1 * C1 * ksh - 0.5 * C2) * T * T + (D1 * D1 * kfl - 0.5 * D2) * M * M
    N_l += ksh * v1 * (v1 + 2.0 * C1 * T) - T * v2 + kfl * m1 * (m1 - 2.0 * D1 * M) + M * m2
    return Response(E + 0.5 * (T * v + M * dth), N, T, M, N_l, N_v, N_m, ksh, kfl, 0.0)


@dataclass(frozen=True)
class Refinements:
    """What the helix law has beyond Haringx's: each can be left out, to see what it is worth.

    Attributes
    ----------
    large : axial law of a helix in large deformation, else Haringx's constant stiffness; `held`, `taper`
        and `ends` refine this law.
    held : the ends of a half coil do not turn about the axis, as the scenes have it; else they are free.
    shear, stretch : transverse shear and stretch of the wire.
    taper : radius of a half coil of a cone by its axial flexibility, else that in its middle.
    lateral : lateral and bending flexibility by wire theory, else Haringx's; `spread` and `current`
        refine it.
    spread : bending acts all along the half coil, else in its middle.
    current : lateral and bending flexibility at the current angle of the helix, else at rest.
    ends : the axial force turns and sets off the axis where the wire is held, and in the half coils of a
        cone: (B12) and (B13); goes with `held`.
    """

    large: bool = True
    held: bool = True
    shear: bool = True
    stretch: bool = True
    taper: bool = True
    lateral: bool = True
    spread: bool = True
    current: bool = True
    ends: bool = True

    def __post_init__(self) -> None:
        for name, value in vars(self).items():
            if not isinstance(value, bool):
                raise InputError(f"refinements.{name} must be true or false, got {shown(value)}")


def helix_rows(spring: Spring, material: Material, refinements: Refinements) -> np.ndarray:
    """Parameters of every half coil, shape (2 n, `COLUMNS`)."""
    on, at = refinements, half_coils(spring)
    rows = _wound_rows(spring, material, on, at)
    stiffness = haringx_stiffness(spring, material)
    rows[:, RATE] = 0.0 if on.large else stiffness[:, KAX]
    if not on.lateral:
        rows[:, H0], rows[:, B0] = 1.0 / stiffness[:, 1], 1.0 / stiffness[:, 2]
    set_range(rows)
    if on.ends and on.large and on.held:
        _set_ends(rows, spring, at)
    return rows


def _set_ends(rows: np.ndarray, spring: Spring, at: HalfCoils) -> None:
    """Set the factors in (B12) and (B13); subtract from the flexibilities what the length contributes."""
    x, weight = np.polynomial.legendre.leggauss(POINTS)
    phi = at.middles[:, None] + 0.5 * math.pi * x
    square = (spring.radius(phi) / radii(spring, at, taper=True)[:, None]) ** 2
    m = 0.5 * math.pi * ((square * np.cos(phi + spring.start_phase)) @ weight)
    psi = at.phases + spring.start_phase
    rows[:, SWELL] = np.diff(np.cos(psi))
    # the wire's shear and stretch, which leave its angle as it is, are in the length
    rows[:, TILT], rows[:, TIP] = rows[:, G1] * m, -0.5 * rows[:, G1] * (np.sin(psi[:-1]) + np.sin(psi[1:]))
    for i, row in enumerate(rows):
        length, x = row[L0], row[U0] ** 2
        _, turn, _, _, growth, _ = winding(rows, i, length)
        coupling = row[SWELL] * growth + row[TIP] * length * turn
        soft = 1.0 / axial(rows, i, length)[2]
        shear, bending = row[H0] + x * (row[H1] + x * row[H2]), row[B0] + x * row[B1]
        row[H0] -= min(coupling**2 * soft, MOST_TAKEN * shear)
        row[B0] -= min((row[TILT] * turn) ** 2 * soft, MOST_TAKEN * bending)


def _wound_rows(spring: Spring, material: Material, on: Refinements, at: HalfCoils) -> np.ndarray:
    """Parameters of the half coils by wire theory; the range is not set."""
    radius = radii(spring, at, on.taper)
    c = at.lengths / math.pi
    slant = np.hypot(radius, c)  # L, wire length per radian
    wire = coil_section(spring, material, radius / slant**2)
    if (radius / slant).min() < STRAIGHT:  # the law is one of coils
        least = min(min(section.mean_diameter) for section in spring.coils)
        most = math.pi * least * spring.active_coils / STRAIGHT
        raise InputError(
            f"spring.active_height must be below about {most:.3g} with law helix, so that the wire is "
            f"coiled, got {spring.active_height!r}"
        )
    rows = np.zeros((radius.size, COLUMNS))
    rows[:, S], rows[:, PER_S], rows[:, L0] = math.pi * slant, 1.0 / (math.pi * slant), at.lengths
    rows[:, GJ], rows[:, EI] = wire.GJ, wire.EI
    rows[:, IGA], rows[:, IEA] = on.shear / wire.GA, on.stretch / wire.EA
    rows[:, OMEGA], rows[:, TAU0], rows[:, KAPPA0] = 1.0 / slant, c / slant**2, radius / slant**2
    rows[:, FREE], rows[:, U0] = not on.held, c / slant
    if on.lateral:
        _set_lateral(rows, slant, on)
    return rows


def radii(spring: Spring, at: HalfCoils, taper: bool) -> np.ndarray:
    """Radius of the wire between nodes: in the middle, or the one whose cube is the mean of r^3.

    The mean is Simpson's, exact unless two sections meet there.
    """
    middle = spring.radius(at.middles)
    if not taper:
        return middle
    cubes = spring.radius(at.phases) ** 3
    return np.cbrt((cubes[:-1] + 4.0 * middle**3 + cubes[1:]) / 6.0)


def _set_lateral(rows: np.ndarray, slant: np.ndarray, on: Refinements) -> None:
    """Coefficients of (B10) and (B11); at rest, where they do not follow the angle, constants."""
    s, x = rows[:, S], rows[:, U0] ** 2
    J, I, G, A = 1.0 / rows[:, GJ], 1.0 / rows[:, EI], rows[:, IGA], rows[:, IEA]  # noqa: E741
    h, q = 0.5 * slant**2, on.spread * s**2 / 12.0
    rows[:, B0], rows[:, B1] = 0.5 * s * (J + I), 0.5 * s * (I - J)
    rows[:, H0] = s * (h * I + 0.5 * (A + G))
    rows[:, H1] = s * (h * (J - 2.0 * I) + 0.5 * (G - A) + 0.5 * q * (J + I))
    rows[:, H2] = s * (I - J) * (h + 0.5 * q)
    if not on.current:
        rows[:, B0] += x * rows[:, B1]
        rows[:, H0] += x * (rows[:, H1] + x * rows[:, H2])
        rows[:, [B1, H1, H2]] = 0.0
