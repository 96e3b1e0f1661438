"""A contact pair of spheres in the degrees of freedom of their nodes; its law is `coilspring.contact.law`."""

from __future__ import annotations

from coilspring.compiling.compiled import arithmetic
from wirefe.element.algebra import added, block, cross, diagonal, dot, outer, product, put, scaled, skew
from wirefe.element.poses import three


@arithmetic
def lever(f, r):
    """Second derivative of f . exp(phi) r in the spin phi: 1/2 (f r^T + r f^T) - (f . r) I."""
    return diagonal(added(outer(0.5, f, r), 1.0, outer(0.5, r, f)), -dot(f, r))


@arithmetic
def pair_matrix(f, Hg, ra, rb, g, K):
    """Gradient (12,) and Hessian (12, 12) of a pair in the dofs of its nodes; `ra`, `rb` as turned now.

    `f` and `Hg` are those in the vector from one centre to the other, whose change is
    dxb - rb x phib - dxa + ra x phia.
    """
    F, A = three(f, 0), block(Hg, 0, 0)
    g[0], g[1], g[2] = -F[0], -F[1], -F[2]
    g[3], g[4], g[5] = cross(F, ra)
    g[6], g[7], g[8] = F[0], F[1], F[2]
    g[9], g[10], g[11] = cross(rb, F)
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
    turned = added(block(H, 9, 9), 1.0, product(block(H, 9, 6), R))
    put(H, 9, 9, added(added(turned, -1.0, product(R, moved)), 1.0, lever(F, r)))
    put(H, 6, 9, moved)
    put(H, 0, 9, added(block(H, 0, 9), 1.0, product(block(H, 0, 6), R)))
    put(H, 3, 9, added(block(H, 3, 9), 1.0, product(block(H, 3, 6), R)))
