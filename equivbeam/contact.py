"""Contact between the circles in which the wire meets the working plane, (10), (11), (13).

The force of a pair, (12), is `coilspring.contact.law.normal_law`; its moments follow (13).
"""

import math

from coilspring.compiling.compiled import inlined


@inlined
def circle_centre(x, y, theta, ox, oy):
    """Centre of a circle attached to a node: the node's position and the turned offset."""
    c, s = math.cos(theta), math.sin(theta)
    return x + c * ox - s * oy, y + s * ox + c * oy


@inlined
def pair_forces(f, H, rax, ray, rbx, rby, g, K):
    """Gradient (6,) and Hessian (6, 6) in the dofs of the two nodes from those in the vector g (3,).

    `ra`, `rb` are the vectors from each node to its circle's centre, as turned now.
    """
    # dg/dq, one row per degree of freedom: -(I, r_A') and +(I, r_B') with r' = (-ry, rx)
    jx = (-1.0, 0.0, ray, 1.0, 0.0, -rby)
    jy = (0.0, -1.0, -rax, 0.0, 1.0, rbx)
    for i in range(6):
        g[i] = jx[i] * f[0] + jy[i] * f[1]
        hx = jx[i] * H[0, 0] + jy[i] * H[1, 0]
        hy = jx[i] * H[0, 1] + jy[i] * H[1, 1]
        for j in range(6):
            K[i, j] = hx * jx[j] + hy * jy[j]
    # second derivative of the centres: c'' = -r
    K[2, 2] += f[0] * rax + f[1] * ray
    K[5, 5] -= f[0] * rbx + f[1] * rby


@inlined
def circle_overlap(centres, attached, state, d):
    """By how much circles of diameter d overlap, at most, and beyond those one turn apart; mm.

    All pairs are compared but those of one node. Two of one side that have changed places along the
    axis, with less than a diameter across it, have passed through each other: they overlap by what
    they do side by side.
    """
    whole, pairs = -d, 0.0
    for a in range(len(centres)):
        for b in range(a + 1, len(centres)):
            x, y = centres[b, 0] - centres[a, 0], centres[b, 1] - centres[a, 1]
            if attached[a] == attached[b] or (abs(y) >= d and b != a + 2):
                continue
            depth = d - math.sqrt(x * x + y * y)
            if b == a + 2:
                pairs = max(pairs, depth)
                turn = 0.5 * (state[3 * attached[a] + 2] + state[3 * attached[b] + 2])
                c, s = math.cos(turn), math.sin(turn)
                if y * c - x * s < 0.0:
                    depth = d - abs(x * c + y * s)
            whole = max(whole, depth)
    return whole, whole - pairs
