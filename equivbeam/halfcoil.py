"""Half-coil element after Haringx: equations (1)-(9) of the paper, as the gradient of an energy.

With a = p2 - p1, theta_b the mean and dtheta the difference of the end rotations::

    t = (cos theta_b, sin theta_b),  n = (-sin theta_b, cos theta_b)
    l = a . n,  v = a . t
    U = 1/2 Kax (l - l0)^2 + 1/2 Ksh v^2 + 1/2 Kfl dtheta^2

whose gradient is (7)-(9) (with the misprint of (7) mended, see docs/theory.md). The element's
degrees of freedom are (x1, y1, theta1, x2, y2, theta2).
"""

from __future__ import annotations

import math

import numpy as np

from coilspring.compiled import kernel
from coilspring.material import Material
from coilspring.spring import Spring


def haringx_stiffness(spring: Spring, material: Material) -> np.ndarray:
    """Axial, shearing and bending stiffness of every half coil, shape (2 n, 3): N/mm, N/mm, N mm.

    Haringx (1948) with the paper's cos p; coil diameter and helix angle p are those in the middle
    of the half coil.
    """
    count = round(2 * spring.active_coils)
    middle = (np.arange(count) + 0.5) * math.pi
    D = 2.0 * spring.radius(middle)
    E, G, d = material.E, material.G, spring.wire_diameter
    cos_p = np.cos(np.arctan(spring.pitch / (math.pi * D)))
    kax = 2.0 * G * d**4 / (8.0 * D**3) * cos_p
    ksh = 2.0 * E * d**4 / (8.0 * D**3) * cos_p
    kfl = 2.0 * 4.0 * E * G * d**4 / (64.0 * D * (2.0 * G + E)) * cos_p
    return np.stack((kax, ksh, kfl), axis=1)


@kernel
def half_coil(x1, y1, th1, x2, y2, th2, kax, ksh, kfl, l0, g, K):
    """Energy of one half coil; fills its gradient `g` (6,) and Hessian `K` (6, 6)."""
    thb = 0.5 * (th1 + th2)
    c, s = math.cos(thb), math.sin(thb)
    ax, ay = x2 - x1, y2 - y1
    l = -ax * s + ay * c  # noqa: E741
    v = ax * c + ay * s
    dth = th2 - th1
    N = kax * (l - l0)
    T = ksh * v
    M = kfl * dth
    # first derivatives with respect to ax, ay, theta_b; dl/dtheta_b = -v, dv/dtheta_b = l
    lx, ly, lb = -s, c, -v
    vx, vy, vb = c, s, l
    fx = N * lx + T * vx
    fy = N * ly + T * vy
    fb = N * lb + T * vb
    g[0], g[1], g[2] = -fx, -fy, 0.5 * fb - M
    g[3], g[4], g[5] = fx, fy, 0.5 * fb + M
    # Hessian in (ax, ay, theta_b): material part and N l'' + T v''
    kxx = kax * lx * lx + ksh * vx * vx
    kxy = kax * lx * ly + ksh * vx * vy
    kyy = kax * ly * ly + ksh * vy * vy
    kxb = kax * lx * lb + ksh * vx * vb - N * c - T * s
    kyb = kax * ly * lb + ksh * vy * vb - N * s + T * c
    kbb = kax * lb * lb + ksh * vb * vb - N * l - T * v
    _scatter(kxx, kxy, kyy, kxb, kyb, 0.25 * kbb + kfl, 0.25 * kbb - kfl, K)
    return 0.5 * (N * (l - l0) + T * v + M * dth)


@kernel
def _scatter(kxx, kxy, kyy, kxb, kyb, same, cross, K):
    """6 x 6 matrix from the second derivatives in (ax, ay, theta_b) and the rotation terms."""
    for i in range(2):
        for j in range(2):
            sign = 1.0 if i == j else -1.0
            p, q = 3 * i, 3 * j
            K[p, q] = sign * kxx
            K[p, q + 1] = sign * kxy
            K[p + 1, q] = sign * kxy
            K[p + 1, q + 1] = sign * kyy
            K[p + 2, q + 2] = same if i == j else cross
            side = -0.5 if i == 0 else 0.5
            K[p, q + 2] = side * kxb
            K[p + 1, q + 2] = side * kyb
            side = -0.5 if j == 0 else 0.5
            K[p + 2, q] = side * kxb
            K[p + 2, q + 1] = side * kyb


@kernel
def paper_matrix(thb, kax, ksh, kfl, L, factor, K):
    """The paper's element matrix (section 2.3), which stands in for the tangent, turned by theta_b.

    Local axes are n (axial) and -t (transverse). ``Phi = factor Kfl / (Ksh L^2)``: 1 as printed,
    12 for the shear-flexible beam that the matrix is meant to be.
    """
    phi = factor * kfl / (ksh * L * L)
    a = 12.0 * kfl / (L * L * (1.0 + phi))
    b = 6.0 * kfl / (L * (1.0 + phi))
    near = kfl * (4.0 + phi) / (1.0 + phi)
    far = kfl * (2.0 - phi) / (1.0 + phi)
    c, s = math.cos(thb), math.sin(thb)
    # axial along n = (-s, c), transverse along -t = (-c, -s)
    kxx = kax * s * s + a * c * c
    kxy = -kax * s * c + a * s * c
    kyy = kax * c * c + a * s * s
    # a node's transverse force per unit rotation of either node is +-b along -t
    _scatter(kxx, kxy, kyy, 2.0 * b * c, 2.0 * b * s, near, far, K)
