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

The Hessian of a pair is L^T Q L, with the linear forms L in the dofs of its nodes and their quadratic form Q.
Pairs between the same nodes follow one another: their forms are put side by side, and multiplied at once.
"""

import math
from typing import Any, NamedTuple

import numpy as np

from coilspring.compiling.compiled import arithmetic, clear_table
from coilspring.contact.law import normal_law, tangential_law
from wirefe.contact.stations import ARMS, POSITION, ROTATION, SLOPES, TANGENT
from wirefe.contact.wires import gap, placed, slip, touches
from wirefe.element.algebra import added, cross, dot, lever, mixed, plus
from wirefe.element.poses import ROW, four, three, three_of
from wirefe.element.rotations import turned

# The linear forms above in the degrees of freedom of a pair's nodes: two of each station.
ALPHA, BETA, GAMMA, DELTA, EPSILON, LAMBDA, XN, XB, XU = range(9)
FRICTIONLESS, ALL, SLOTS = 4, 9, 4
DOFS, MOST = 6 * SLOTS, 64  # and how many forms stand side by side at most
COUPLINGS = ((0, 1), (0, 2), (0, 3), (1, 2), (1, 3), (2, 3))  # of these nodes


class Frame(NamedTuple):
    """Directions of a pair, and its forms."""

    n: Any
    b: Any
    u: Any
    sigma: Any
    length: Any  # |tau|
    count: Any  # of its forms,
    column: Any  # and the first of them


class Station(NamedTuple):
    """A station of a pair."""

    k: Any  # of all stations
    arm: Any  # material point of its section that touched first
    first: Any  # slot of its nodes: 0 of the station that w leads away from, else 2


class Forces(NamedTuple):
    """Forces of a pair on the motions dv, dtau and dxi."""

    gap: Any
    tangent: Any
    slip: Any


class Forms(NamedTuple):
    """Forms of pairs between the same nodes, two slots of each station, and of the pair at hand:"""

    L: Any  # (DOFS, MOST)
    QL: Any  # (DOFS, MOST)
    Q: Any  # (ALL, ALL) quadratic form
    arms: Any  # (SLOTS, 9) rv, q, x of each node
    K: Any  # scratch: (6, 6)


@arithmetic
def _node(contact, m, slot):
    """Node of a slot of a pair, -1 where a station moves with one node alone."""
    k = contact.pairs[m, slot // 2]
    if slot % 2 == 0:
        return contact.attached[k]
    return contact.attached[k] + 1 if contact.parts[k, ROTATION] != 0.0 else -1


@arithmetic
def _alike(contact, m, n):
    """Whether two pairs are between the same nodes."""
    same = True
    for slot in range(SLOTS):
        same = same and _node(contact, m, slot) == _node(contact, n, slot)
    return same


@arithmetic
def _put(L, k, slot, c, r, direction):
    """The form k, ``direction . (c dx + phi x r)``, in the six dofs of a node."""
    i = 6 * slot
    L[i, k], L[i + 1, k], L[i + 2, k] = c * direction[0], c * direction[1], c * direction[2]
    L[i + 3, k], L[i + 4, k], L[i + 5, k] = cross(r, direction)


@arithmetic
def _node_forms(L, slot, c, e, r, q, x, frame):
    """Forms of a node; it moves w by c dx + phi x r, tau by e dx + phi x q and xi by c dx + phi x x."""
    n, b, u, sigma, length, count, column = frame
    cv, rv = c - sigma * e, plus(r, -sigma, q)
    e, q = e / length, (q[0] / length, q[1] / length, q[2] / length)
    _put(L, column + ALPHA, slot, cv, rv, n)
    _put(L, column + BETA, slot, cv, rv, b)
    _put(L, column + GAMMA, slot, cv, rv, u)
    _put(L, column + DELTA, slot, e, q, n)
    if count > FRICTIONLESS:
        _put(L, column + EPSILON, slot, e, q, b)
        _put(L, column + LAMBDA, slot, e, q, u)
        _put(L, column + XN, slot, c, x, n)
        _put(L, column + XB, slot, c, x, b)
        _put(L, column + XU, slot, c, x, u)


@arithmetic
def put_pair(contact, state, m, arms, frame, forces, forms, g):
    """Add the gradient of a pair's nodes, and fill its columns of `Forms` unless these are empty.

    `arms` (6,) are the material points that touched first, in the sections of both stations.
    """
    low = Station(contact.pairs[m, 0], three(arms, 0), 0)
    high = Station(contact.pairs[m, 1], three(arms, 3), 2)
    _put_station(contact, state, low, frame, forces, forms, g)
    _put_station(contact, state, high, frame, forces, forms, g)


@arithmetic
def _put_station(contact, state, station, frame, forces, forms, g):
    """The same of one station."""
    k, rho, first = station
    L, arms = forms.L, forms.arms
    node, parts, sign = contact.attached[k], contact.parts, -1.0 if first == 0 else 1.0
    for slot in range(1 if parts[k, ROTATION] == 0.0 else 2):
        c, e, turn = parts[k, POSITION], parts[k, TANGENT], parts[k, ROTATION]
        if slot == 0:
            c, e, turn = 1.0 - c, -e, 1.0 - turn
        p, i = four(state, ROW * (node + slot) + 3), first + slot
        r = turned(p, three_of(parts, k, ARMS + 3 * slot))
        q = turned(p, three_of(parts, k, SLOPES + 3 * slot))
        x = plus(r, turn, turned(p, rho)) if frame.count > FRICTIONLESS else r
        c, r, x = sign * c, (sign * r[0], sign * r[1], sign * r[2]), (sign * x[0], sign * x[1], sign * x[2])
        cv, rv = c - frame.sigma * e, plus(r, -frame.sigma, q)
        _add_gradient(g, 6 * (node + slot), cv, rv, forces.gap)
        if frame.count > FRICTIONLESS:
            _add_gradient(g, 6 * (node + slot), e, q, forces.tangent)
            _add_gradient(g, 6 * (node + slot), c, x, forces.slip)
        if len(L) > 0:
            _node_forms(L, i, c, e, r, q, x, frame)
            arms[i, 0], arms[i, 1], arms[i, 2] = rv
            arms[i, 3], arms[i, 4], arms[i, 5] = q
            arms[i, 6], arms[i, 7], arms[i, 8] = x


@arithmetic
def _add_gradient(g, p, c, r, F):
    """Add the force F, by which a node of which the dofs begin at p moves something by c dx + phi x r."""
    x, y, z = cross(r, F)
    g[p], g[p + 1], g[p + 2] = g[p] + c * F[0], g[p + 1] + c * F[1], g[p + 2] + c * F[2]
    g[p + 3], g[p + 4], g[p + 5] = g[p + 3] + x, g[p + 4] + y, g[p + 5] + z


@arithmetic
def _add(Q, i, j, value):
    """Add ``2 value x_i x_j``, or ``value x_i^2``, to a quadratic form."""
    Q[i, j] += value
    if i != j:
        Q[j, i] += value


@arithmetic
def _normal(F, slope, h, Q):
    """Hessian (forms, forms) of the normal potential in the forms."""
    _add(Q, ALPHA, ALPHA, slope)
    _add(Q, BETA, BETA, -F / h)
    _add(Q, GAMMA, DELTA, F)
    _add(Q, DELTA, DELTA, F * h)


@arithmetic
def _tangential(ratio, more, xi, h, Q):
    """The same of the tangential one: by its force over the slip's length and, over that again, the rate of
    this ratio."""
    z, x, y = xi
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


@arithmetic
def tangential_forces(normal, ratio, xi, h, frame):
    """`Forces` of a pair, from its `normal` one and the tangential one over the slip's length."""
    across = ratio * xi[0] * xi[2] / frame.length
    return Forces(
        plus(normal, -ratio * xi[0] * xi[1] / h, frame.b),
        (across * frame.n[0], across * frame.n[1], across * frame.n[2]),
        mixed(ratio * xi[1], frame.b, ratio * xi[2], frame.u),
    )


@arithmetic
def _levers(arms, slot, forces):
    """Second derivative of what a node's arms do under the forces on them."""
    A = added(lever(forces.gap, three_of(arms, slot, 0)), 1.0, lever(forces.tangent, three_of(arms, slot, 3)))
    return added(A, 1.0, lever(forces.slip, three_of(arms, slot, 6)))


@arithmetic
def _put_products(forms, column, count):
    """Fill the columns Q L of the pair at hand; rows of slots without a node are not read."""
    L, QL, Q, _, _ = forms
    if count == FRICTIONLESS:
        # slope alpha^2 - F/h beta^2 + 2 F gamma delta + F h delta^2
        alpha, beta, both, delta = Q[ALPHA, ALPHA], Q[BETA, BETA], Q[GAMMA, DELTA], Q[DELTA, DELTA]
        for i in range(DOFS):
            p, q = L[i, column + GAMMA], L[i, column + DELTA]
            QL[i, column + ALPHA] = alpha * L[i, column + ALPHA]
            QL[i, column + BETA] = beta * L[i, column + BETA]
            QL[i, column + GAMMA], QL[i, column + DELTA] = both * q, both * p + delta * q
        return
    for i in range(DOFS):
        for k in range(count):
            value = 0.0
            for l in range(count):  # noqa: E741
                value += Q[k, l] * L[i, column + l]
            QL[i, column + k] = value


@arithmetic
def _product_row(L, QL, i, j, count, K, r):
    """Row of a block: the numbers of many forms are multiplied four at a time, and summed in registers."""
    t0, t1, t2, t3, t4, t5 = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    for k in range(count):
        x = L[i, k]
        t0 += x * QL[j, k]
        t1 += x * QL[j + 1, k]
        t2 += x * QL[j + 2, k]
        t3 += x * QL[j + 3, k]
        t4 += x * QL[j + 4, k]
        t5 += x * QL[j + 5, k]
    K[r, 0], K[r, 1], K[r, 2], K[r, 3], K[r, 4], K[r, 5] = t0, t1, t2, t3, t4, t5


@arithmetic
def _add_hessian(contact, m, forms, count, H):
    """Add L^T Q L of `count` forms, block by block of the nodes of the pair m and of those alike."""
    for j in range(SLOTS):
        b = _node(contact, m, j)
        for i in range(j + 1):
            a = _node(contact, m, i)
            if a < 0 or b < 0:
                continue
            for r in range(6):
                _product_row(forms.L, forms.QL, 6 * i + r, 6 * j, count, forms.K, r)
            if a == b:
                _add_table(H[a], forms.K, True)
            entry = len(COUPLINGS) * m + i + j - (1 if i == 0 else 0)
            if i != j:
                B = H[a] if a == b else H[contact.block[entry]]
                _add_table(B, forms.K, a != b and contact.flip[entry])


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
    energy, points, whole = 0.0, placed(contact, state), len(H) > 0
    size, none = DOFS if whole else 0, (0.0, 0.0, 0.0)
    L, QL, Q = np.empty((size, MOST)), np.empty((size, MOST)), np.empty((ALL, ALL))
    forms = Forms(L, QL, Q, np.empty((SLOTS, 9)), np.empty((6, 6)))
    first, column = 0, 0  # pair of the forms that are to be added yet, and their number
    for m in range(contact.pairs.shape[0]):
        row = history[m]
        if not (row.closed or touches(contact, points, m)):
            continue
        h, n, u, s, length = gap(contact, points, m)
        b, count = cross(u, n), ALL if row.closed else FRICTIONLESS
        if column > 0 and not (column + count <= MOST and _alike(contact, first, m)):
            _add_hessian(contact, first, forms, column, H)
            column = 0
        first = m if column == 0 else first
        frame = Frame(n, b, u, s / length, length, count, column)
        depth = contact.d - h - contact.rest_overlap[m]
        K = contact.weights[m] * contact.kc
        stored, F, slope = normal_law(depth, K, contact.k) if depth > 0.0 else none
        energy += stored
        forces = Forces((-F * n[0], -F * n[1], -F * n[2]), none, none)
        if whole:
            clear_table(Q)
            _normal(F, slope, h, Q)
        if row.closed:
            vector = slip(contact, points, state, m, row.arms)
            xi = (dot(vector, n), dot(vector, b), dot(vector, u))
            rho = math.sqrt(xi[1] ** 2 + xi[2] ** 2)
            stored, force, slope = tangential_law(rho, row)
            energy += stored
            ratio = force / rho if rho > 0.0 else slope
            forces = tangential_forces(forces.gap, ratio, xi, h, frame)
            if whole:
                _tangential(ratio, (slope - ratio) / rho**2 if rho > 0.0 else 0.0, xi, h, Q)
        put_pair(contact, state, m, row.arms, frame, forces, forms, g)
        if whole:
            _put_products(forms, column, count)
            _add_levers(contact, m, forms.arms, forces, H)
            column += count
    if column > 0:
        _add_hessian(contact, first, forms, column, H)
    return energy


@arithmetic
def _add_levers(contact, m, arms, forces, H):
    """Add what the arms of a pair's nodes do to their own blocks."""
    for slot in range(SLOTS):
        node = _node(contact, m, slot)
        if node >= 0:
            A = _levers(arms, slot, forces)
            for i in range(3):
                for j in range(3):
                    H[node, 3 + i, 3 + j] += A[3 * i + j]
