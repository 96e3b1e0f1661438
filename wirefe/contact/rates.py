"""How gaps and tangential lengths of pairs change with a motion of the nodes, and the lengths' gradients.

The derivatives of `wirefe.contact.wireforces` in the motion (dx, phi) of each node; of spheres those of the
vector between their centres, see `coilspring.contact.rates`.
"""

import math

import numpy as np

from coilspring.compiling.compiled import arithmetic, inlined
from coilspring.contact.rates import GAP_RATE, LENGTH_RATE, length_gradient, pair_rate
from wirefe.contact.spheres import between
from wirefe.contact.stations import ARMS, POSITION, ROTATION, SLOPES, TANGENT
from wirefe.contact.wireforces import ALL, MOST, SLOTS, Forms, Frame, put_pair, tangential_forces
from wirefe.contact.wires import between_sections, gap_of
from wirefe.element.algebra import cross, dot, plus
from wirefe.element.poses import ROW, four, three, three_of
from wirefe.element.rotations import turned


@inlined
def sphere_rates(contact, state, motion, history, rates):
    """Fill the rates of pairs of spheres."""
    w, dw, t = np.empty(3), np.empty(3), np.empty(3)
    for m in range(rates.shape[0]):
        v, ra, rb = between(contact, state, m)
        a, b = contact.attached[contact.pairs[m, 0]], contact.attached[contact.pairs[m, 1]]
        w[0], w[1], w[2] = v
        dw[0], dw[1], dw[2] = plus(_carried(motion, b, 1.0, rb), -1.0, _carried(motion, a, 1.0, ra))
        pair_rate(w, dw, history[m], contact, t, rates[m])


@inlined
def sphere_gradient(contact, state, row, m, g):
    """Add the gradient of the tangential length of a pair of spheres; returns the length."""
    w, t = np.empty(3), np.empty(3)
    v, ra, rb = between(contact, state, m)
    w[0], w[1], w[2] = v
    length = length_gradient(w, math.sqrt(dot(v, v)), row, contact, t)
    F = three(t, 0)
    for side in range(2):
        p, sign = 6 * contact.attached[contact.pairs[m, side]], 2.0 * side - 1.0
        moment = cross(rb if side == 1 else ra, F)
        for i in range(3):
            g[p + i] += sign * F[i]
            g[p + 3 + i] += sign * moment[i]
    return length


@arithmetic
def _carried(motion, node, share, r):
    """Rate of what moves with a node by a share of its displacement, and by the arm r."""
    x = cross(three(motion, 6 * node + 3), r)
    return plus(x, share, three(motion, 6 * node))


@arithmetic
def _station(contact, state, k):
    """Point and tangent of a station."""
    parts, i = contact.parts, ROW * contact.attached[k]
    p, x = four(state, i + 3), three(state, i)
    point = plus(turned(p, three_of(parts, k, ARMS)), 1.0 - parts[k, POSITION], x)
    tangent = plus(turned(p, three_of(parts, k, SLOPES)), -parts[k, TANGENT], x)
    if parts[k, ROTATION] == 0.0:
        return point, tangent
    p, x = four(state, i + ROW + 3), three(state, i + ROW)
    point = plus(plus(point, 1.0, turned(p, three_of(parts, k, ARMS + 3))), parts[k, POSITION], x)
    return point, plus(plus(tangent, 1.0, turned(p, three_of(parts, k, SLOPES + 3))), parts[k, TANGENT], x)


@arithmetic
def _station_rate(contact, state, motion, k, arm):
    """Rates of a station's point, of its tangent, and of a vector fixed to its section, at rest `arm`."""
    parts, node = contact.parts, contact.attached[k]
    p, share = four(state, ROW * node + 3), parts[k, ROTATION]
    point = _carried(motion, node, 1.0 - parts[k, POSITION], turned(p, three_of(parts, k, ARMS)))
    tangent = _carried(motion, node, -parts[k, TANGENT], turned(p, three_of(parts, k, SLOPES)))
    fixed = _carried(motion, node, 0.0, turned(p, arm))
    if share == 0.0:
        return point, tangent, fixed
    p, node = four(state, ROW * node + ROW + 3), node + 1
    there = _carried(motion, node, parts[k, POSITION], turned(p, three_of(parts, k, ARMS + 3)))
    along = _carried(motion, node, parts[k, TANGENT], turned(p, three_of(parts, k, SLOPES + 3)))
    other = _carried(motion, node, 0.0, turned(p, arm))
    return plus(point, 1.0, there), plus(tangent, 1.0, along), plus(plus(fixed, -share, fixed), share, other)


@arithmetic
def _facing(contact, state, m):
    """w and tau of a pair."""
    x, t = _station(contact, state, contact.pairs[m, 0])
    y, other = _station(contact, state, contact.pairs[m, 1])
    return plus(y, -1.0, x), plus(t, 1.0, other)


@arithmetic
def _slip_in(xi, n, b, u):
    """Parts of a vector along n, b and u."""
    return dot(xi, n), dot(xi, b), dot(xi, u)


@arithmetic
def wire_rates(contact, state, motion, history, rates):
    """Fill the rates of pairs of wires that are held; of others they are zero."""
    for m in range(rates.shape[0]):
        row = history[m]
        rates[m, GAP_RATE], rates[m, LENGTH_RATE] = 0.0, 0.0
        if not row.closed:
            continue
        w, tau = _facing(contact, state, m)
        h, n, u, s, length = gap_of(w, tau)
        first = _station_rate(contact, state, motion, contact.pairs[m, 0], three(row.arms, 0))
        second = _station_rate(contact, state, motion, contact.pairs[m, 1], three(row.arms, 3))
        dw, dtau = plus(second[0], -1.0, first[0]), plus(second[1], 1.0, first[1])
        dv = plus(dw, -s / length, dtau)
        rates[m, GAP_RATE] = dot(n, dv)
        b = cross(u, n)
        z, x, y = _slip_in(plus(w, 1.0, between_sections(contact, state, m, row.arms)), n, b, u)
        _, Xb, Xu = _slip_in(plus(plus(dw, 1.0, second[2]), -1.0, first[2]), n, b, u)
        Yb, Yu = Xb - z * dot(b, dv) / h, Xu + z * dot(n, dtau) / length
        rho = math.sqrt(x * x + y * y)
        rates[m, LENGTH_RATE] = (x * Yb + y * Yu) / rho if rho > 0.0 else math.sqrt(Yb * Yb + Yu * Yu)


@arithmetic
def wire_gradient(contact, state, row, m, g):
    """Add the gradient of the tangential length of a pair of wires; returns the length."""
    w, tau = _facing(contact, state, m)
    h, n, u, s, length = gap_of(w, tau)
    b, none = cross(u, n), (0.0, 0.0, 0.0)
    xi = _slip_in(plus(w, 1.0, between_sections(contact, state, m, row.arms)), n, b, u)
    rho = math.sqrt(xi[1] ** 2 + xi[2] ** 2)
    frame = Frame(n, b, u, s / length, length, ALL, 0)
    forces = tangential_forces(none, 1.0 / rho if rho > 0.0 else 0.0, xi, h, frame)
    L = np.empty((0, MOST))
    forms = Forms(L, L, L, np.empty((SLOTS, 9)), L)
    put_pair(contact, state, m, row.arms, frame, forces, forms, g)
    return rho
