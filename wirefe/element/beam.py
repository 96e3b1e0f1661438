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

from coilspring.compiling.compiled import arithmetic, kernel, zeros
from wirefe.element.algebra import added, block, cross, lever, product, put, skew
from wirefe.element.elastic import elastic, stiffness
from wirefe.element.hessian import FOUND, GIVEN, give_forces, give_stiffness, gradients, hessians
from wirefe.element.lanes import LANES, get_three
from wirefe.element.measure import MEASURED, STRAIN, measure
from wirefe.element.poses import three


@kernel
def deformations(state, arm, triads, e):
    """Deformation measures (v, theta) of all elements, shape (n, 6), before e0 is taken off."""
    table = np.empty(MEASURED * LANES)
    for begin in range(0, len(triads), LANES):
        size = min(LANES, len(triads) - begin)
        measure(table, state, triads, arm, begin, size)
        for n in range(size):
            for i in range(6):
                e[begin + n, i] = table[LANES * (STRAIN + i) + n]


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
    table, found = zeros(GIVEN * LANES), np.empty(FOUND * LANES)
    for begin in range(0, len(triads), LANES):
        size = min(LANES, len(triads) - begin)
        measure(table, state, triads, arm, begin, size)
        for n in range(size):
            e = begin + n
            work, s, v, y = elastic(_less(table, n, e0[e]), K[e], Q, e, A)
            energy += work
            give_forces(table, n, v, y)
            if e < len(H):
                stiffness(K[e], Q, e, s, A, now)
                give_stiffness(table, n, now)
        gradients(table, found, g[begin : begin + size])
        if begin < len(H):
            hessians(table, found, H[begin : begin + size])
    return energy


@arithmetic
def _less(table, n, e0):
    """e of an element."""
    v, theta = get_three(table, STRAIN, n), get_three(table, STRAIN + 3, n)
    return v[0] - e0[0], v[1] - e0[1], v[2] - e0[2], theta[0] - e0[3], theta[1] - e0[4], theta[2] - e0[5]


@kernel
def end_forces(states, arm, triads, e0, K, Q, g):
    """Fill the gradients g (states, n, 12) of all elements: what acts on their ends; see `beams`."""
    for i in range(len(states)):
        beams(states[i], arm, triads, e0, K, Q, g[i], np.empty((0, 12, 12)))


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
