"""Forces of wires in contact: nothing resists sliding along them but friction.

With u, s, h, n of `wirefe.contact.wires`, b = u x n, sigma = s / |tau|, the motion of the facing points
dv = dw - sigma dtau and

    alpha, beta, gamma = n, b, u . dv     and     delta, epsilon, lambda = n, b, u . dtau / |tau|,

    dh = alpha,   d2h = beta^2 / h - 2 gamma delta - h delta^2,   dn = b beta / h - u delta.

The part of the slip xi across n, of the length rho, has the potential Psi of
`coilspring.contact.law.tangential_law`. With xi = z n + x b + y u, X = dxi in these directions and
zeta = x beta / h - y delta,

    d(rho^2 / 2)  = x Yb + y Yu,   Yb = Xb - z beta / h,   Yu = Xu + z delta,
    d2(rho^2 / 2) = Yb^2 + Yu^2 - 2 Xn zeta - zeta^2 + 2 z x (alpha beta / h^2 + epsilon gamma / h
                    + delta epsilon) + 2 z y (epsilon beta / h - delta lambda).

All of it depends on the wires' motion relative to each other alone: forces and moments balance.
"""

import math
from typing import Any, NamedTuple

import numpy as np

from coilspring.compiling.compiled import arithmetic, clear_table
from coilspring.contact.law import normal_law, tangential_law
from wirefe.contact.stations import ARMS, POSITION, ROTATION, SLOPES, TANGENT
from wirefe.contact.wires import gap, placed, slip, touches
from wirefe.element.algebra import added, cross, dot, lever, plus
from wirefe.element.poses import ROW, four, three, three_of
from wirefe.element.rotations import turned

# Rows of the linear forms above in the degrees of freedom of a pair's nodes: two of each station.
ALPHA, BETA, GAMMA, DELTA, EPSILON, LAMBDA, XN, XB, XU = range(9)
FRICTIONLESS, ALL, SLOTS = 4, 9, 4
COUPLINGS = ((0, 1), (0, 2), (0, 3), (1, 2), (1, 3), (2, 3))  # of these nodes


class Frame(NamedTuple):
    """Directions of a pair, and how many forms it needs."""

    n: Any
    b: Any
    u: Any
    sigma: Any
    length: Any  # |tau|
    count: Any


class Forms(NamedTuple):
    """Forms of the nodes of a pair: two slots of each station."""

    L: Any  # (ALL, SLOTS, 6)
    arms: Any  # (SLOTS, 9) rv, q, x of each node
    nodes: Any  # (SLOTS,) their numbers, -1 where there is none
    M: Any  # scratch: (ALL, 6)
    K: Any  # and (6, 6)


@arithmetic
def _put(L, k, slot, c, r, direction):
    """The form k, ``direction . (c dx + phi x r)``, in the six dofs of a node."""
    L[k, slot, 0], L[k, slot, 1], L[k, slot, 2] = c * direction[0], c * direction[1], c * direction[2]
    L[k, slot, 3], L[k, slot, 4], L[k, slot, 5] = cross(r, direction)


@arithmetic
def _node_forms(L, slot, c, e, r, q, x, frame):
    """Forms of a node; it moves w by c dx + phi x r, tau by e dx + phi x q and xi by c dx + phi x x."""
    n, b, u, sigma, length, count = frame
    cv, rv = c - sigma * e, plus(r, -sigma, q)
    e, q = e / length, (q[0] / length, q[1] / length, q[2] / length)
    _put(L, ALPHA, slot, cv, rv, n)
    _put(L, BETA, slot, cv, rv, b)
    _put(L, GAMMA, slot, cv, rv, u)
    _put(L, DELTA, slot, e, q, n)
    if count > FRICTIONLESS:
        _put(L, EPSILON, slot, e, q, b)
        _put(L, LAMBDA, slot, e, q, u)
        _put(L, XN, slot, c, x, n)
        _put(L, XB, slot, c, x, b)
        _put(L, XU, slot, c, x, u)


@arithmetic
def _station_forms(contact, state, k, rho, frame, forms, first):
    """Fill the `Forms` of a station's nodes.

    The slots are `first` (0 for the pair's first station, which w leads away from) and the next one.
    """
    L, arms, nodes, _, _ = forms
    node, parts, sign = contact.attached[k], contact.parts, -1.0 if first == 0 else 1.0
    nodes[first + 1] = -1
    for slot in range(1 if parts[k, ROTATION] == 0.0 else 2):
        c, e, turn = parts[k, POSITION], parts[k, TANGENT], parts[k, ROTATION]
        if slot == 0:
            c, e, turn = 1.0 - c, -e, 1.0 - turn
        p = four(state, ROW * (node + slot) + 3)
        r = turned(p, three_of(parts, k, ARMS + 3 * slot))
        q = turned(p, three_of(parts, k, SLOPES + 3 * slot))
        x = plus(r, turn, turned(p, rho))
        r, x = (sign * r[0], sign * r[1], sign * r[2]), (sign * x[0], sign * x[1], sign * x[2])
        _node_forms(L, first + slot, sign * c, e, r, q, x, frame)
        i = first + slot
        arms[i, 0], arms[i, 1], arms[i, 2] = plus(r, -frame[3], q)
        arms[i, 3], arms[i, 4], arms[i, 5] = q
        arms[i, 6], arms[i, 7], arms[i, 8] = x
        nodes[i] = node + slot


@arithmetic
def _add(Q, i, j, value):
    """Add ``2 value x_i x_j``, or ``value x_i^2``, to a quadratic form."""
    Q[i, j] += value
    if i != j:
        Q[j, i] += value


@arithmetic
def _normal(F, slope, h, G, Q):
    """Gradient (forms,) and Hessian (forms, forms) of the normal potential in the forms."""
    G[ALPHA] -= F
    _add(Q, ALPHA, ALPHA, slope)
    _add(Q, BETA, BETA, -F / h)
    _add(Q, GAMMA, DELTA, F)
    _add(Q, DELTA, DELTA, F * h)


@arithmetic
def _tangential(force, slope, xi, rho, h, G, Q):
    """The same of the tangential one, by its force and slope at the slip's length; returns force / rho."""
    z, x, y = xi
    ratio = force / rho if rho > 0.0 else slope
    more = (slope - ratio) / rho**2 if rho > 0.0 else 0.0
    G[BETA] -= ratio * x * z / h
    G[DELTA] += ratio * y * z
    G[XB] += ratio * x
    G[XU] += ratio * y
    change = (-x * z / h, y * z, x, y)  # of rho^2 / 2
    forms = (BETA, DELTA, XB, XU)
    for i in range(4):
        for j in range(4):
            Q[forms[i], forms[j]] += more * change[i] * change[j]
    _add(Q, XB, XB, ratio)
    _add(Q, XB, BETA, -ratio * z / h)
    _add(Q, BETA, BETA, ratio * (z * z - x * x) / h**2)
    _add(Q, XU, XU, ratio)
    _add(Q, XU, DELTA, ratio * z)
    _add(Q, DELTA, DELTA, ratio * (z * z - y * y))
    _add(Q, XN, BETA, -ratio * x / h)
    _add(Q, XN, DELTA, ratio * y)
    _add(Q, BETA, DELTA, ratio * x * y / h)
    _add(Q, ALPHA, BETA, ratio * z * x / h**2)
    _add(Q, EPSILON, GAMMA, ratio * z * x / h)
    _add(Q, DELTA, EPSILON, ratio * z * x)
    _add(Q, EPSILON, BETA, ratio * z * y / h)
    _add(Q, DELTA, LAMBDA, -ratio * z * y)
    return ratio


@arithmetic
def _levers(arms, slot, on_gap, on_tangent, on_slip):
    """Second derivative of what a node's arms do under the forces on them."""
    A = added(lever(on_gap, three_of(arms, slot, 0)), 1.0, lever(on_tangent, three_of(arms, slot, 3)))
    return added(A, 1.0, lever(on_slip, three_of(arms, slot, 6)))


@arithmetic
def _add_gradient(nodes, L, G, count, g):
    """Add the gradient of the forms' coefficients `G` (9,)."""
    for i in range(SLOTS):
        if nodes[i] >= 0:
            for r in range(6):
                value = 0.0
                for k in range(count):
                    value += G[k] * L[k, i, r]
                g[6 * nodes[i] + r] += value


@arithmetic
def _forms_hessian(L, Q, M, count, j):
    """The rows Q L of the node j, into M (forms, 6)."""
    for k in range(count):
        for c in range(6):
            M[k, c] = 0.0
        for l in range(count):  # noqa: E741
            q = Q[k, l]
            if q != 0.0:
                for c in range(6):
                    M[k, c] += q * L[l, j, c]


@arithmetic
def _product_row(L, i, r, M, count, K):
    """Row r of K = L_i^T M, M (forms, 6): summed in registers."""
    t0, t1, t2, t3, t4, t5 = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    for k in range(count):
        x = L[k, i, r]
        t0 += x * M[k, 0]
        t1 += x * M[k, 1]
        t2 += x * M[k, 2]
        t3 += x * M[k, 3]
        t4 += x * M[k, 4]
        t5 += x * M[k, 5]
    K[r, 0], K[r, 1], K[r, 2], K[r, 3], K[r, 4], K[r, 5] = t0, t1, t2, t3, t4, t5


@arithmetic
def _add_hessian(contact, m, forms, Q, count, H):
    """Add L^T Q L, block by block of the pair's nodes."""
    L, _, nodes, M, K = forms
    for j in range(SLOTS):
        if nodes[j] < 0:
            continue
        _forms_hessian(L, Q, M, count, j)
        for i in range(j + 1):
            if nodes[i] < 0:
                continue
            for r in range(6):
                _product_row(L, i, r, M, count, K)
            same = nodes[i] == nodes[j]
            if same:
                _add_table(H[nodes[i]], K, True)
            entry = len(COUPLINGS) * m + i + j - (1 if i == 0 else 0)
            if i != j:
                B = H[nodes[i]] if same else H[contact.block[entry]]
                _add_table(B, K, not same and contact.flip[entry])


@arithmetic
def _add_table(B, K, upright):
    """Add K, or its transpose, to B."""
    for r in range(6):
        for c in range(6):
            if upright:
                B[r, c] += K[r, c]
            else:
                B[c, r] += K[r, c]


@arithmetic
def add_wires(contact, history, state, g, H):
    """Contact energy of the wires; adds its gradient and Hessian. Only pairs that touch, or stick, are."""
    energy, points = 0.0, placed(contact, state)
    L, Q, G = np.empty((ALL, SLOTS, 6)), np.empty((ALL, ALL)), np.empty((1, ALL))
    arms, nodes = np.empty((SLOTS, 9)), np.empty(SLOTS, np.int64)
    forms = Forms(L, arms, nodes, np.empty((ALL, 6)), np.empty((6, 6)))
    for m in range(contact.pairs.shape[0]):
        row = history[m]
        if not (row.closed or touches(contact, points, m)):
            continue
        h, n, u, s, length = gap(contact, points, m)
        depth = contact.d - h - contact.clearance[m]
        b, count = cross(u, n), ALL if row.closed else FRICTIONLESS
        frame = Frame(n, b, u, s / length, length, count)
        _station_forms(contact, state, contact.pairs[m, 0], three(row.arms, 0), frame, forms, 0)
        _station_forms(contact, state, contact.pairs[m, 1], three(row.arms, 3), frame, forms, 2)
        clear_table(G)
        clear_table(Q)
        F = 0.0
        if depth > 0.0:
            stored, F, slope = normal_law(depth, contact.kc, contact.k)
            energy += stored
            _normal(F, slope, h, G[0], Q)
        on_gap, on_tangent, on_slip = (-F * n[0], -F * n[1], -F * n[2]), (0.0, 0.0, 0.0), (0.0, 0.0, 0.0)
        if row.closed:
            way = slip(contact, points, state, m, row.arms)
            xi = (dot(way, n), dot(way, b), dot(way, u))
            rho = math.sqrt(xi[1] ** 2 + xi[2] ** 2)
            stored, force, slope = tangential_law(rho, row)
            energy += stored
            ratio = _tangential(force, slope, xi, rho, h, G[0], Q)
            on_gap = plus(on_gap, -ratio * xi[0] * xi[1] / h, b)
            across = ratio * xi[0] * xi[2] / length
            on_tangent = (across * n[0], across * n[1], across * n[2])
            on_slip = plus((0.0, 0.0, 0.0), ratio * xi[1], b)
            on_slip = plus(on_slip, ratio * xi[2], u)
        _add_gradient(nodes, L, G[0], count, g)
        if len(H) > 0:
            _add_hessian(contact, m, forms, Q, count, H)
            for slot in range(SLOTS):
                if nodes[slot] >= 0:
                    B, A = H[nodes[slot]], _levers(arms, slot, on_gap, on_tangent, on_slip)
                    for i in range(3):
                        for j in range(3):
                            B[3 + i, 3 + j] += A[3 * i + j]
    return energy
