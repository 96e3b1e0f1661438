"""Half-coil element: what every law shares, the paper's equations (1)-(9) but for their stiffnesses.

With a = p2 - p1, theta_b the mean and dtheta the difference of the end rotations::

    t = (cos theta_b, sin theta_b),  n = (-sin theta_b, cos theta_b)
    l = a . n,  v = a . t                                                      (B1)

a law is an energy U(l, v, dtheta). Its gradient in the element's degrees of freedom (x1, y1, theta1,
x2, y2, theta2) is (7)-(9), with the misprint of (7) mended (see docs/theory.md), for any law.
"""

import math
from typing import NamedTuple

from coilspring.compiling.compiled import inlined


class Response(NamedTuple):
    """Energy of a half coil and its derivatives; no built-in law couples v with dtheta."""

    U: float
    N: float  # dU/dl, axial force
    T: float  # dU/dv, transverse force
    M: float  # dU/d(dtheta), bending moment
    N_l: float
    N_v: float
    N_m: float  # the suffix m stands for dtheta
    T_v: float
    M_m: float
    T_m: float


@inlined
def measures(x1, y1, th1, x2, y2, th2):
    """Cosine and sine of the mean rotation, length, shear and relative rotation of a half coil."""
    thb = 0.5 * (th1 + th2)
    c, s = math.cos(thb), math.sin(thb)
    ax, ay = x2 - x1, y2 - y1
    return c, s, ay * c - ax * s, ax * c + ay * s, th2 - th1


@inlined
def measures_at(state, e):
    """`measures` of the element between the nodes e and e + 1 of a state."""
    i = 3 * e
    return measures(state[i], state[i + 1], state[i + 2], state[i + 3], state[i + 4], state[i + 5])


@inlined
def gradient(r, c, s, l, v, g):  # noqa: E741
    """Gradient `g` (6,) of a half coil in its degrees of freedom, from its response `r`."""
    fx = r.T * c - r.N * s
    fy = r.N * c + r.T * s
    fb = r.T * l - r.N * v
    g[0], g[1], g[2] = -fx, -fy, 0.5 * fb - r.M
    g[3], g[4], g[5] = fx, fy, 0.5 * fb + r.M


@inlined
def hessian(r, c, s, l, v, K):  # noqa: E741
    """Hessian `K` (6, 6) of a half coil in its degrees of freedom, from its response `r`."""
    N, T = r.N, r.T
    # first derivatives with respect to ax, ay, theta_b; dl/dtheta_b = -v, dv/dtheta_b = l
    lx, ly, lb = -s, c, -v
    vx, vy, vb = c, s, l
    # Hessian in (ax, ay, theta_b): material part and N l'' + T v''
    Nx, Ny, Nb = r.N_l * lx + r.N_v * vx, r.N_l * ly + r.N_v * vy, r.N_l * lb + r.N_v * vb
    Tx, Ty, Tb = r.N_v * lx + r.T_v * vx, r.N_v * ly + r.T_v * vy, r.N_v * lb + r.T_v * vb
    kxx = Nx * lx + Tx * vx
    kxy = Nx * ly + Tx * vy
    kyy = Ny * ly + Ty * vy
    kxb = Nx * lb + Tx * vb - N * c - T * s
    kyb = Ny * lb + Ty * vb - N * s + T * c
    kbb = Nb * lb + Tb * vb - N * l - T * v
    _scatter(kxx, kxy, kyy, 0.5 * kxb, 0.5 * kyb, 0.25 * kbb + r.M_m, 0.25 * kbb - r.M_m, K)
    if r.N_m != 0.0 or r.T_m != 0.0:
        _scatter_relative(r.N_m * lx + r.T_m * vx, r.N_m * ly + r.T_m * vy, r.N_m * lb + r.T_m * vb, K)


@inlined
def _scatter(kxx, kxy, kyy, kxb, kyb, same, cross, K):
    """6 x 6 matrix from the second derivatives in (ax, ay), with a node's rotation, and of the rotations."""
    for i in range(2):
        for j in range(2):
            sign = 1.0 if i == j else -1.0
            p, q = 3 * i, 3 * j
            K[p, q] = sign * kxx
            K[p, q + 1] = sign * kxy
            K[p + 1, q] = sign * kxy
            K[p + 1, q + 1] = sign * kyy
            K[p + 2, q + 2] = same if i == j else cross
            side = -1.0 if i == 0 else 1.0
            K[p, q + 2] = side * kxb
            K[p + 1, q + 2] = side * kyb
            side = -1.0 if j == 0 else 1.0
            K[p + 2, q] = side * kxb
            K[p + 2, q + 1] = side * kyb


@inlined
def _scatter_relative(kxm, kym, kbm, K):
    """Add the second derivatives in dtheta with ax, ay and theta_b."""
    for i in range(2):
        for j in range(2):
            p, q = 3 * i, 3 * j
            sign = 1.0 if i == j else -1.0
            K[p, q + 2] += sign * kxm
            K[p + 1, q + 2] += sign * kym
            K[p + 2, q] += sign * kxm
            K[p + 2, q + 1] += sign * kym
    K[2, 2] -= kbm
    K[5, 5] += kbm


@inlined
def paper_matrix(c, s, kax, ksh, kfl, L, factor, K):
    """The paper's element matrix (section 2.3), which stands in for the tangent, turned by theta_b.

    Local axes are n (axial) and -t (transverse). ``Phi = factor Kfl / (Ksh L^2)``: 1 as printed,
    12 for the shear-flexible beam that the matrix is meant to be. `c`, `s` belong to theta_b.
    """
    phi = factor * kfl / (ksh * L * L)
    a = 12.0 * kfl / (L * L * (1.0 + phi))
    b = 6.0 * kfl / (L * (1.0 + phi))
    near = kfl * (4.0 + phi) / (1.0 + phi)
    far = kfl * (2.0 - phi) / (1.0 + phi)
    # axial along n = (-s, c), transverse along -t = (-c, -s)
    kxx = kax * s * s + a * c * c
    kxy = -kax * s * c + a * s * c
    kyy = kax * c * c + a * s * s
    # a node's transverse force per unit rotation of either node is +-b along -t
    _scatter(kxx, kxy, kyy, b * c, b * s, near, far, K)
