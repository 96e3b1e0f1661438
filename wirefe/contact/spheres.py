"""Contact of spheres that move with nodes; the law of a pair is `coilspring.contact.law`."""

import math

import numpy as np

from coilspring.compiling.compiled import arithmetic
from coilspring.contact.law import pair_potential
from wirefe.chain import add_block, add_gradient, add_nodes
from wirefe.element.algebra import added, block, cross, dot, lever, plus, product, put, scaled, skew
from wirefe.element.poses import ROW, four, three
from wirefe.element.rotations import turned


@arithmetic
def pair_matrix(f, Hg, ra, rb, g, K):
    """Gradient (12,) and Hessian (12, 12) of a pair in the dofs of its nodes, left out where `K` is empty;
    `ra`, `rb` as turned now.

    `f` and `Hg` are those in the vector from one centre to the other, whose change is
    dxb - rb x phib - dxa + ra x phia.
    """
    F, A = three(f, 0), block(Hg, 0, 0)
    g[0], g[1], g[2] = -F[0], -F[1], -F[2]
    g[3], g[4], g[5] = cross(F, ra)
    g[6], g[7], g[8] = F[0], F[1], F[2]
    g[9], g[10], g[11] = cross(rb, F)
    if len(K) == 0:
        return
    Ra, Rb = skew(ra, -1.0), skew(rb, -1.0)
    Ba, Bb = product(A, Ra), product(A, Rb)
    put(K, 0, 0, A)
    put(K, 6, 6, A)
    put(K, 6, 0, scaled(-1.0, A))
    put(K, 0, 3, Ba)
    put(K, 6, 3, scaled(-1.0, Ba))
    put(K, 0, 9, scaled(-1.0, Bb))
    put(K, 6, 9, Bb)
    # skew matrices: their transposes are their opposites
    put(K, 3, 3, added(product(skew(ra, 1.0), Ba), -1.0, lever(F, ra)))
    put(K, 9, 9, added(product(skew(rb, 1.0), Bb), 1.0, lever(F, rb)))
    put(K, 3, 9, product(Ra, Bb))


@arithmetic
def centre(contact, state, sphere):
    """Centre of a sphere, and its arm from its node as turned now."""
    i = ROW * contact.attached[sphere]
    r = turned(four(state, i + 3), three(contact.parts[sphere], 0))
    return plus(three(state, i), 1.0, r), r


@arithmetic
def between(contact, state, m):
    """Vector between the centres of a pair, and their arms from their nodes as turned now."""
    a, ra = centre(contact, state, contact.pairs[m, 0])
    b, rb = centre(contact, state, contact.pairs[m, 1])
    return plus(b, -1.0, a), ra, rb


@arithmetic
def add_spheres(contact, history, state, g, H):
    """Contact energy of spheres; adds its gradient and Hessian. Only pairs that touch are scattered."""
    energy = 0.0
    w, e, f, Hg = np.empty(3), np.empty(3), np.empty(3), np.empty((3, 3))
    ge, Ke = np.empty(12), np.empty((12 if len(H) > 0 else 0, 12))
    for m in range(contact.pairs.shape[0]):
        v, ra, rb = between(contact, state, m)
        h2 = dot(v, v)
        if h2 >= contact.d * contact.d and not history[m].closed:
            continue
        w[0], w[1], w[2] = v
        energy += pair_potential(w, math.sqrt(h2), contact, history[m], e, f, Hg)
        pair_matrix(f, Hg, ra, rb, ge, Ke)
        a, b = contact.attached[contact.pairs[m, 0]], contact.attached[contact.pairs[m, 1]]
        add_gradient(g, a, b, ge)
        if len(H) > 0:
            add_nodes(H, a, b, Ke)
            add_block(H, contact.block[m], contact.flip[m], Ke)
    return energy
