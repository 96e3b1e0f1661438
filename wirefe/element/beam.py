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

import numpy as np

from coilspring.compiling.compiled import arithmetic, kernel
from wirefe.element.algebra import added, block, cross, lever, mixed, plus, product, put, skew
from wirefe.element.elastic import elastic, stiffness
from wirefe.element.hessian import LANES, give, hessian_tables, hessians
from wirefe.element.measure import deformed, forces, strain, stretched
from wirefe.element.poses import three
from wirefe.element.rotations import turned


@kernel
def deformations(state, arm, triads, e):
    """Deformation measures (v, theta) of all elements, shape (n, 6), before e0 is taken off."""
    for n in range(len(triads)):
        _, q, f, th, u = strain(state, n, triads, arm)
        e[n, 0], e[n, 1], e[n, 2] = stretched(q, f, th, u)
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
    energy, A, now = 0.0, np.empty((6, 6)), np.empty((6, 6))
    given, found = hessian_tables(min(len(H), 1))
    for n in range(len(triads)):
        shape = strain(state, n, triads, arm)
        M, q, f, th, u = shape
        work, s, v, y = elastic(deformed(q, f, th, u, e0[n]), K[n], Q, n, A)
        energy += work
        _, N, _, Pm, C, X = forces(q, f, th, u, v, y)
        _gradient(M, N, C, Pm, X, f[3], g[n])
        if n < len(H):
            stiffness(K[n], Q, n, s, A, now)
            give(given, n % LANES, shape, v, y, now)
            if n % LANES == LANES - 1 or n == len(H) - 1:
                hessians(given, found, H[n - n % LANES : n + 1])
    return energy


@kernel
def end_forces(states, arm, triads, e0, K, Q, g):
    """Fill the gradients g (states, n, 12) of all elements: what acts on their ends; see `beams`."""
    A = np.empty((6, 6))
    for i in range(len(states)):
        for n in range(len(triads)):
            M, q, f, th, u = strain(states[i], n, triads, arm)
            _, _, v, y = elastic(deformed(q, f, th, u, e0[n]), K[n], Q, n, A)
            _, N, _, Pm, C, X = forces(q, f, th, u, v, y)
            _gradient(M, N, C, Pm, X, f[3], g[i, n])


@arithmetic
def _gradient(M, N, C, Pm, X, tau, g):
    """Gradient (12,) from the forces in the half-way frame `M`."""
    force, mean, bend = turned(M, N), turned(M, C), turned(M, plus(Pm, 0.5 * tau, X))
    g[0], g[1], g[2] = -force[0], -force[1], -force[2]
    g[6], g[7], g[8] = force[0], force[1], force[2]
    g[3], g[4], g[5] = mixed(0.5, mean, -1.0, bend)
    g[9], g[10], g[11] = mixed(0.5, mean, 1.0, bend)


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
