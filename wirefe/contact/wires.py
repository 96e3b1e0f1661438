"""Contact of wires: the gap is taken across both, and nothing resists sliding along them but friction.

Of a pair of stations, with w from the first to the second and tau the sum of their unit tangents,

    u = tau / |tau|,   s = w . u,   h n = w - s u,   |n| = 1,

h is the distance of two wires that are straight and parallel, or curved alike, whichever of their points
face each other. With b = u x n, sigma = s / |tau|, the motion of the facing points dv = dw - sigma dtau and

    alpha, beta, gamma = n, b, u . dv     and     delta, epsilon, lambda = n, b, u . dtau / |tau|,

    dh = alpha,   d2h = beta^2 / h - 2 gamma delta - h delta^2,   dn = b beta / h - u delta.

What sticks or rubs is the slip xi of the two material points that touched first, fixed to the sections: the
part of it across n, of the length rho, has the potential Psi of `coilspring.contact.law.tangential_law`.
With xi = z n + x b + y u, X = dxi in these directions and zeta = x beta / h - y delta,

    d(rho^2 / 2)  = x Yb + y Yu,   Yb = Xb - z beta / h,   Yu = Xu + z delta,
    d2(rho^2 / 2) = Yb^2 + Yu^2 - 2 Xn zeta - zeta^2 + 2 z x (alpha beta / h^2 + epsilon gamma / h
                    + delta epsilon) + 2 z y (epsilon beta / h - delta lambda).

All of it depends on the wires' motion relative to each other alone: forces and moments balance.
"""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np

from coilspring.compiling.compiled import arithmetic, clear_table, part
from coilspring.contact.kinematics import SLIGHT
from coilspring.contact.law import (
    first_touch,
    gave_way,
    goes_on,
    located_to,
    normal_law,
    opens_after,
    predicted_badly,
    renewed,
    slid,
    tangential_law,
    touches_again,
    touches_first,
)
from wirefe.contact.spheres import lever
from wirefe.contact.stations import ARMS, POSITION, ROTATION, SLOPES, TANGENT, arms_of, station
from wirefe.element.algebra import added, cross, dot, plus
from wirefe.element.poses import ROW, four, three
from wirefe.element.quaternions import conjugate, turned

# Rows of the linear forms above in the degrees of freedom of a pair's nodes: two of each station.
ALPHA, BETA, GAMMA, DELTA, EPSILON, LAMBDA, XN, XB, XU = range(9)
FRICTIONLESS, ALL, SLOTS = 4, 9, 4
COUPLINGS = ((0, 1), (0, 2), (0, 3), (1, 2), (1, 3), (2, 3))  # of these nodes
ROUNDS = 4  # to find a section's vector: rotations of its two nodes differ little


@arithmetic
def placed(contact, state):
    """Positions and tangents of all stations, shape (stations, 6)."""
    points = np.empty((contact.attached.size, 6))
    for k in range(contact.attached.size):
        parts, node, out = contact.parts[k], contact.attached[k], points[k]
        out[0], out[1], out[2] = station(parts, state, node, POSITION, ARMS)
        out[3], out[4], out[5] = station(parts, state, node, TANGENT, SLOPES)
    return points


@arithmetic
def gap(contact, points, m):
    """h, n, u, s and |tau| of a pair."""
    a, b = points[contact.pairs[m, 0]], points[contact.pairs[m, 1]]
    w, tau = plus(three(b, 0), -1.0, three(a, 0)), plus(three(b, 3), 1.0, three(a, 3))
    length = math.sqrt(dot(tau, tau))
    u = (tau[0] / length, tau[1] / length, tau[2] / length)
    s = dot(w, u)
    across = plus(w, -s, u)
    h = math.sqrt(dot(across, across))
    return h, (across[0] / h, across[1] / h, across[2] / h), u, s, length


@arithmetic
def across(contact, points, m):
    """Vector across the gap of a pair, of the length of the gap and d."""
    h, n, _, _, _ = gap(contact, points, m)
    h += contact.clearance[m]
    return h * n[0], h * n[1], h * n[2]


@arithmetic
def section_turned(contact, state, k, v):
    """A vector fixed to the section of a station, at rest `v`, as turned now."""
    i, share = ROW * contact.attached[k], contact.parts[k, ROTATION]
    low = turned(four(state, i + 3), v)
    if share == 0.0:
        return low
    return plus(plus(low, -share, low), share, turned(four(state, i + ROW + 3), v))


@arithmetic
def section_at_rest(contact, state, k, v):
    """The vector at rest that `section_turned` makes `v`."""
    i, share = ROW * contact.attached[k], contact.parts[k, ROTATION]
    rest = (0.0, 0.0, 0.0)
    for _ in range(ROUNDS):
        left = plus(v, -1.0, section_turned(contact, state, k, rest))
        low = turned(conjugate(four(state, i + 3)), left)
        if share != 0.0:
            low = plus(plus(low, -share, low), share, turned(conjugate(four(state, i + ROW + 3)), left))
        rest = plus(rest, 1.0, low)
    return rest


@arithmetic
def touching_points(contact, points, state, m, back, out):
    """Write to `out` (6,) the material points of both stations, in their sections at rest, that face each
    other half way between them now, less a slip `back` (3)."""
    h, n, u, s, _ = gap(contact, points, m)
    half = plus((0.5 * h * n[0], 0.5 * h * n[1], 0.5 * h * n[2]), 0.5 * s, u)
    half = plus(half, -0.5, back)
    a = section_at_rest(contact, state, contact.pairs[m, 0], half)
    b = section_at_rest(contact, state, contact.pairs[m, 1], (-half[0], -half[1], -half[2]))
    out[0], out[1], out[2] = a
    out[3], out[4], out[5] = b


@arithmetic
def slip(contact, points, state, m, arms):
    """Vector xi between the material points whose places in the sections at rest are `arms` (6,)."""
    a, b = contact.pairs[m, 0], contact.pairs[m, 1]
    xa = plus(three(points[a], 0), 1.0, section_turned(contact, state, a, three(arms, 0)))
    xb = plus(three(points[b], 0), 1.0, section_turned(contact, state, b, three(arms, 3)))
    return plus(xb, -1.0, xa)


@part
def _tangential_slip(contact, points, state, m, row):
    """Length of the part of a pair's slip across n, and that part."""
    _, n, _, _, _ = gap(contact, points, m)
    way = slip(contact, points, state, m, row.arms)
    way = plus(way, -dot(way, n), n)
    return math.sqrt(dot(way, way)), way


@part
def _touch(contact, states, m, row):
    """See `coilspring.contact.kinematics`; `states` are the accepted, the predicted and the trial one, with
    their stations."""
    there, d = np.empty((3, 6)), contact.d - contact.clearance[m]
    v = np.empty((3, 3))
    for i in range(3):
        state, points = states[i]
        h, n, _, _, _ = gap(contact, points, m)
        v[i, 0], v[i, 1], v[i, 2] = h * n[0], h * n[1], h * n[2]
        touching_points(contact, points, state, m, (0.0, 0.0, 0.0), there[i])
    predicted = v[1, 0] ** 2 + v[1, 1] ** 2 + v[1, 2] ** 2 < d * d
    far = 1 if predicted else 2
    at, other = first_touch(v[0], v[far], d), first_touch(v[0], v[2], d)
    doubt, apart = np.zeros(3), 0.0
    for i in range(6):
        way = there[2, i] - there[0, i]
        row.arms[i] = there[0, i] + at * (there[far, i] - there[0, i])
        left = there[0, i] + other * way - row.arms[i] if predicted else (1.0 - at) * way
        doubt[i % 3] += left if i < 3 else -left
    for i in range(3):
        apart += doubt[i] * doubt[i]
        row.normal[i] = v[2, i]
    touches_first(row, at, math.sqrt(apart), located_to(contact.mu) * d)


@part
def remember_wires(contact, state, history):
    """See `coilspring.contact.kinematics.remember`."""
    least, points = np.inf, placed(contact, state)
    here = (state, points)
    for m in range(history.shape[0]):
        row = history[m]
        h, n, _, _, _ = gap(contact, points, m)
        gap_left = h + contact.clearance[m] - contact.d
        least = min(least, gap_left)
        if not (row.closed or gap_left < 0.0):
            continue
        if not row.closed:
            _touch(contact, (here, here, here), m, row)
        row.fresh = False
        row.normal[0], row.normal[1], row.normal[2] = n
        length, way = _tangential_slip(contact, points, state, m, row)
        left = length
        if contact.mu == np.inf:
            left = gave_way(length, contact.kt, row, gap_left)
            if goes_on(row, left, contact.kt, gap_left, contact.d):
                least = min(least, 0.0)
        elif slid(length, contact.kt, row, gap_left):
            left = row.bound / contact.kt
        if left < length:
            share = left / length
            touching_points(
                contact, points, state, m, (share * way[0], share * way[1], share * way[2]), row.arms
            )
    return least


@part
def update_wires(contact, accepted, predicted, state, history):
    """See `coilspring.contact.kinematics.update_pairs`."""
    points, before = placed(contact, state), placed(contact, accepted)
    ahead = placed(contact, predicted)
    states = ((accepted, before), (predicted, ahead), (state, points))
    least_bound = min(contact.mu, 1.0)
    change, most = 0.0, least_bound * normal_law(SLIGHT * contact.d, contact.kc, contact.k)[1]
    for m in range(history.shape[0]):
        row = history[m]
        h, _, _, _, _ = gap(contact, points, m)
        d = contact.d - contact.clearance[m]
        if row.opening:
            far, _, _, _, _ = gap(contact, before, m)
            touches_again(row, far, h, d)
        elif row.creeps:
            length, _ = _tangential_slip(contact, points, state, m, row)
            row.gap, row.sticking = h - d, contact.kt * length
        if row.opening or row.creeps or not (row.closed or h < d):
            continue
        new = not row.closed
        if new:
            _touch(contact, states, m, row)
        length, way = _tangential_slip(contact, points, state, m, row)
        if new:
            change = max(change, contact.kt * length)
        elif row.fresh and gap(contact, ahead, m)[0] < d:
            _, expected = _tangential_slip(contact, ahead, predicted, m, row)
            error = plus(way, -1.0, expected)
            predicted_badly(row, math.sqrt(dot(error, error)), located_to(contact.mu) * d)
        normal = normal_law(max(d - h, 0.0), contact.kc, contact.k)[1]
        most = max(most, least_bound * normal)
        if contact.mu == np.inf:
            far, _, _, _, _ = gap(contact, before, m)
            opens_after(row, far, gap(contact, ahead, m)[0], h, d)
        else:
            change = max(change, renewed(length, contact.mu * normal, contact.kt, row))
    return change / most if change > 0.0 else 0.0


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


@arithmetic
def _put(row, c, r, direction):
    """A form ``direction . (c dx + phi x r)`` in the six dofs of a node."""
    row[0], row[1], row[2] = c * direction[0], c * direction[1], c * direction[2]
    row[3], row[4], row[5] = cross(r, direction)


@arithmetic
def _node_forms(L, slot, c, e, r, q, x, frame):
    """Forms of a node; it moves w by c dx + phi x r, tau by e dx + phi x q and xi by c dx + phi x x."""
    n, b, u, sigma, length, count = frame
    cv, rv = c - sigma * e, plus(r, -sigma, q)
    e, q = e / length, (q[0] / length, q[1] / length, q[2] / length)
    _put(L[ALPHA, slot], cv, rv, n)
    _put(L[BETA, slot], cv, rv, b)
    _put(L[GAMMA, slot], cv, rv, u)
    _put(L[DELTA, slot], e, q, n)
    if count > FRICTIONLESS:
        _put(L[EPSILON, slot], e, q, b)
        _put(L[LAMBDA, slot], e, q, u)
        _put(L[XN, slot], c, x, n)
        _put(L[XB, slot], c, x, b)
        _put(L[XU, slot], c, x, u)


@arithmetic
def _station_forms(contact, state, k, rho, frame, forms, first):
    """Fill the `Forms` of a station's nodes.

    The slots are `first` (0 for the pair's first station, which w leads away from) and the next one.
    """
    L, arms, nodes = forms
    node, parts, sign = contact.attached[k], contact.parts[k], -1.0 if first == 0 else 1.0
    r0, r1 = arms_of(parts, state, node, ARMS)
    q0, q1 = arms_of(parts, state, node, SLOPES)
    nodes[first + 1] = -1
    for slot in range(1 if parts[ROTATION] == 0.0 else 2):
        c, e, turn, r, q = parts[POSITION], parts[TANGENT], parts[ROTATION], r1, q1
        if slot == 0:
            c, e, turn, r, q = 1.0 - c, -e, 1.0 - turn, r0, q0
        x = plus(r, turn, turned(four(state, ROW * (node + slot) + 3), rho))
        r, x = (sign * r[0], sign * r[1], sign * r[2]), (sign * x[0], sign * x[1], sign * x[2])
        _node_forms(L, first + slot, sign * c, e, r, q, x, frame)
        a = arms[first + slot]
        a[0], a[1], a[2] = plus(r, -frame[3], q)
        a[3], a[4], a[5] = q
        a[6], a[7], a[8] = x
        nodes[first + slot] = node + slot


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
    """The same of the tangential one, with its force and slope at the length `rho` of the slip.

    Returns the force over the length.
    """
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
def _levers(arms, slot, f):
    """Second derivative of what a node's arms do under the forces f (9,) on them."""
    A = lever(three(f, 0), three(arms[slot], 0))
    A = added(A, 1.0, lever(three(f, 3), three(arms[slot], 3)))
    return added(A, 1.0, lever(three(f, 6), three(arms[slot], 6)))


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
def _add_hessian(contact, m, nodes, L, Q, count, H):
    """Add L^T Q L, block by block of the pair's nodes."""
    M, K = np.empty((ALL, 6)), np.empty((6, 6))
    for j in range(SLOTS):
        if nodes[j] < 0:
            continue
        _forms_hessian(L, Q, M, count, j)
        for i in range(j + 1):
            if nodes[i] < 0:
                continue
            clear_table(K)
            for k in range(count):
                for r in range(6):
                    x = L[k, i, r]
                    for c in range(6):
                        K[r, c] += x * M[k, c]
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
    arms, f, nodes = np.empty((SLOTS, 9)), np.empty((1, 9)), np.empty(SLOTS, np.int64)
    forms = Forms(L, arms, nodes)
    for m in range(contact.pairs.shape[0]):
        h, n, u, s, length = gap(contact, points, m)
        row, depth = history[m], contact.d - h - contact.clearance[m]
        if depth <= 0.0 and not row.closed:
            continue
        b, count = cross(u, n), ALL if row.closed else FRICTIONLESS
        frame = Frame(n, b, u, s / length, length, count)
        _station_forms(contact, state, contact.pairs[m, 0], three(row.arms, 0), frame, forms, 0)
        _station_forms(contact, state, contact.pairs[m, 1], three(row.arms, 3), frame, forms, 2)
        clear_table(G)
        clear_table(Q)
        clear_table(f)
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
            stored, force, slope = tangential_law(rho, contact.kt, row)
            energy += stored
            ratio = _tangential(force, slope, xi, rho, h, G[0], Q)
            on_gap = plus(on_gap, -ratio * xi[0] * xi[1] / h, b)
            across = ratio * xi[0] * xi[2] / length
            on_tangent = (across * n[0], across * n[1], across * n[2])
            on_slip = plus((0.0, 0.0, 0.0), ratio * xi[1], b)
            on_slip = plus(on_slip, ratio * xi[2], u)
        _add_gradient(nodes, L, G[0], count, g)
        if len(H) > 0:
            f[0, 0], f[0, 1], f[0, 2] = on_gap
            f[0, 3], f[0, 4], f[0, 5] = on_tangent
            f[0, 6], f[0, 7], f[0, 8] = on_slip
            _add_hessian(contact, m, nodes, L, Q, count, H)
            for slot in range(SLOTS):
                if nodes[slot] >= 0:
                    B, A = H[nodes[slot]], _levers(arms, slot, f[0])
                    for i in range(3):
                        for j in range(3):
                            B[3 + i, 3 + j] += A[3 * i + j]
    return energy
