"""Residual, matrix and motion of the wire model: the kernels that the path follower calls."""

from __future__ import annotations

import math

import numpy as np

from coilspring.compiled import clear, kernel, part
from coilspring.pairlaw import BOUND, ON, hold, pair_potential
from wirefe.beam import beams
from wirefe.chain import eliminate, substitute
from wirefe.contact import lever, pair_matrix
from wirefe.model import ROW, view_contact, view_elements, view_held, view_plan
from wirefe.retraction import Way, close, place, spin_between, turn_along
from wirefe.rotations import rotate

SLIGHT = 1e-7  # wire diameters of penetration: its force is the least that friction bounds are compared with
TOUCH = 0.003  # wire diameters by which a pair may penetrate where a prediction closes it
NEAR = 1.5  # wire diameters between centres, within which a pair's motion in a substep is watched


@part
def _add_gradient(g, a, b, ge):
    """Add a gradient (12,) at two nodes."""
    for i in range(6):
        g[6 * a + i] += ge[i]
        g[6 * b + i] += ge[6 + i]


@part
def _add_nodes(H, a, b, Ke):
    """Add a Hessian's (12, 12) diagonal blocks at two nodes."""
    for i in range(6):
        for j in range(6):
            H[a, i, j] += Ke[i, j]
            H[b, i, j] += Ke[6 + i, 6 + j]


@part
def _add_block(H, block, flip, K):
    """Add the coupling K[:6, 6:] of a first and a second node."""
    B = H[block]
    for i in range(6):
        for j in range(6):
            if flip:
                B[i, j] += K[i, 6 + j]
            else:
                B[i, j] += K[6 + i, j]


@part
def _onto_reference(r, g):
    """Carry the second node's part of a gradient over to a point from which it stands off by r."""
    fx, fy, fz = g[6], g[7], g[8]
    g[9] += r[1] * fz - r[2] * fy
    g[10] += r[2] * fx - r[0] * fz
    g[11] += r[0] * fy - r[1] * fx


@part
def _hessian_onto_reference(r, g, K, C):
    """The same for the Hessian: dx2 = dX - r x phi; the second derivative adds the lever of the force."""
    lever(g[6:9], r, C)
    for i in range(12):
        kx, ky, kz = K[i, 6], K[i, 7], K[i, 8]
        K[i, 9] += r[1] * kz - r[2] * ky
        K[i, 10] += r[2] * kx - r[0] * kz
        K[i, 11] += r[0] * ky - r[1] * kx
    for j in range(12):
        kx, ky, kz = K[6, j], K[7, j], K[8, j]
        K[9, j] += r[1] * kz - r[2] * ky
        K[10, j] += r[2] * kx - r[0] * kz
        K[11, j] += r[0] * ky - r[1] * kx
    for i in range(3):
        for j in range(3):
            K[9 + i, 9 + j] += C[i, j]


@part
def centre(contact, state, sphere, c):
    """Centre of a sphere."""
    i = ROW * contact.carrier[sphere]
    rotate(state[i + 3 : i + 7], contact.offset[sphere], c)
    for j in range(3):
        c[j] += state[i + j]


@part
def _add_elements(chain, state, g, H):
    """Strain energy; adds its gradient and Hessian: gather, compute, scatter."""
    count = chain.stiffness.shape[0]
    ends, turns = np.empty((count, 2, 3)), np.empty((count, 2, 4))
    for e in range(count):
        for side in range(2):
            a = ROW * (e + side)
            for i in range(4):
                if i < 3:
                    ends[e, side, i] = state[a + i]
                turns[e, side, i] = state[a + 3 + i]
    r, C = np.empty(3), np.empty((3, 3))
    rotate(turns[count - 1, 1], chain.arm, r)
    for i in range(3):
        ends[count - 1, 1, i] += r[i]
    wanted = len(H) > 0
    ge, Ke = np.empty((count, 12)), np.empty((count if wanted else 0, 12, 12))
    energy = beams(ends, turns, chain.triads, chain.strain0, chain.stiffness, ge, Ke)
    if wanted:
        _hessian_onto_reference(r, ge[count - 1], Ke[count - 1], C)
    _onto_reference(r, ge[count - 1])
    for e in range(count):
        _add_gradient(g, e, e + 1, ge[e])
    for e in range(len(Ke)):
        _add_nodes(H, e, e + 1, Ke[e])
        _add_block(H, chain.block[e], chain.flip[e], Ke[e])
    return energy


@part
def _add_pairs(contact, memory, state, g, H):
    """Contact energy; adds its gradient and Hessian. Only pairs that touch are scattered."""
    energy = 0.0
    ca, cb, w, e, f = np.empty(3), np.empty(3), np.empty(3), np.empty(3), np.empty(3)
    Hg, C = np.empty((3, 3)), np.empty((3, 3))
    J, ge, Ke = np.empty((3, 12)), np.empty(12), np.empty((12, 12))
    for m in range(contact.pairs.shape[0]):
        A, B = contact.pairs[m, 0], contact.pairs[m, 1]
        centre(contact, state, A, ca)
        centre(contact, state, B, cb)
        h2 = 0.0
        for i in range(3):
            w[i] = cb[i] - ca[i]
            h2 += w[i] * w[i]
        if h2 >= contact.d * contact.d and memory[m, ON] == 0.0:
            continue
        energy += pair_potential(w, math.sqrt(h2), contact.d, contact.kc, contact.k, memory[m], e, f, Hg)
        a, b = contact.carrier[A], contact.carrier[B]
        for i in range(3):
            ca[i] -= state[ROW * a + i]
            cb[i] -= state[ROW * b + i]
        pair_matrix(f, Hg, ca, cb, ge, Ke, J, C)
        _add_gradient(g, a, b, ge)
        if len(H) > 0:
            _add_nodes(H, a, b, Ke)
            _add_block(H, contact.block[m], contact.flip[m], Ke)
    return energy


@part
def _hold(held, H):
    """Take the held freedoms out: rows and columns of the unit matrix."""
    for m in range(held.block.size):
        B = H[held.block[m]]
        i = held.place[m]
        for j in range(6):
            if held.row[m]:
                B[i, j] = 0.0
            else:
                B[j, i] = 0.0
    for m in range(held.freedom.size):
        n, i = held.freedom[m] // 6, held.freedom[m] % 6
        for j in range(6):
            H[n, i, j] = H[n, j, i] = 0.0
        H[n, i, i] = 1.0


@kernel
def assemble(reals, ints, anchor, clearance, memory, state, g, flat):
    """Strain and contact energy, gradient and matrix; see `coilspring.kernelset` for the contract."""
    contact = view_contact(reals, ints)
    H = flat.reshape((flat.size // 36, 6, 6))
    clear(g)
    clear(flat)
    energy = _add_elements(view_elements(reals, ints), state, g, H)
    count = contact.pairs.shape[0]
    if count > 0 and clearance > 0.0 and 2.0 * _bound(contact.reach, anchor, state) < clearance:
        count = 0
    if count > 0:
        energy += _add_pairs(contact, memory, state, g, H)
    held = view_held(ints)
    for m in range(held.freedom.size):
        g[held.freedom[m]] = 0.0
    if len(H) > 0:
        _hold(held, H)
    return energy, count


@kernel
def factor(reals, ints, flat):
    """Block LDL^T in place; returns the number of negative pivots and the least pivot."""
    return eliminate(view_plan(ints), flat.reshape((flat.size // 36, 6, 6)))


@kernel
def solve(reals, ints, flat, b):
    """Back substitution in place."""
    substitute(view_plan(ints), flat.reshape((flat.size // 36, 6, 6)), b)


@kernel
def retract(reals, ints, state, step, factor, before, second, out):
    """See `coilspring.kernelset`; the deformations of the wire are what moves (`wirefe.retraction`)."""
    way = Way(before, step, factor, second)
    chain = view_elements(reals, ints)
    place(chain.triads, chain.arm, state, way, out)
    close(view_held(ints).freedom, chain.arm, state, way, out)


@kernel
def work(reals, ints, load, a, b):
    """Work of a dead load between two states: of forces, and of moments about one axis each."""
    total = 0.0
    for n in range(load.size // 6):
        p = 6 * n
        x, y, z = load[p], load[p + 1], load[p + 2]
        if x != 0.0 or y != 0.0 or z != 0.0:
            s = ROW * n
            total += x * (b[s] - a[s]) + y * (b[s + 1] - a[s + 1]) + z * (b[s + 2] - a[s + 2])
        x, y, z = load[p + 3], load[p + 4], load[p + 5]
        if x != 0.0 or y != 0.0 or z != 0.0:
            v = spin_between(a, b, n)
            total += x * v[0] + y * v[1] + z * v[2]
    return total


@kernel
def carry(reals, ints, a, b, v):
    """See `coilspring.kernelset`: forces and moments, or motions and spins, turned with their nodes."""
    turn_along(a, b, v)
    held = view_held(ints).freedom
    for m in range(held.size):
        v[held[m]] = 0.0


@part
def _bound(reach, a, b):
    """Bound on how far any point of the wire's nodes or any sphere moved between two states."""
    most = 0.0
    last = a.size - ROW
    for s in range(0, a.size, ROW):
        way = math.sqrt((a[s] - b[s]) ** 2 + (a[s + 1] - b[s + 1]) ** 2 + (a[s + 2] - b[s + 2]) ** 2)
        if s == last:
            same, other = 0.0, 0.0
            for i in range(3, 7):
                same += (a[s + i] - b[s + i]) ** 2
                other += (a[s + i] + b[s + i]) ** 2
            # |R r - R' r| <= 2 sin(angle/2) |r| <= 2 |q - q'| |r|
            way += 2.0 * math.sqrt(min(same, other)) * reach
        most = max(most, way)
    return most


@part
def _vector(contact, state, m, c, w):
    """Vector between the centres of a pair, and its length."""
    centre(contact, state, contact.pairs[m, 1], w)
    centre(contact, state, contact.pairs[m, 0], c)
    for i in range(3):
        w[i] -= c[i]
    return math.sqrt(w[0] ** 2 + w[1] ** 2 + w[2] ** 2)


@kernel
def motion(reals, ints, a, b, least):
    """See `coilspring.kernelset`: bound on all motion, largest pair motion, share of the way to the first touch.

    A pair counts if it comes near anywhere between the states: spheres must not pass through each other.
    """
    contact = view_contact(reals, ints)
    most, free, way = 0.0, 1.0, _bound(contact.reach, a, b)
    if way <= least:
        return way, most, free
    inner = (contact.d * (1.0 - TOUCH)) ** 2
    c, v, w = np.empty(3), np.empty(3), np.empty(3)
    for m in range(contact.pairs.shape[0]):
        before = _vector(contact, a, m, c, v)
        _vector(contact, b, m, c, w)
        square, along, end = 0.0, 0.0, 0.0
        for i in range(3):
            square += (w[i] - v[i]) ** 2
            along -= v[i] * (w[i] - v[i])
            end += w[i] ** 2
        if before >= contact.d and end < inner:
            # first x with |v + x (w - v)|^2 = inner
            root = math.sqrt(max(along**2 - square * (before**2 - inner), 0.0))
            free = min(free, (along - root) / square)
        if square <= most * most:
            continue
        x = min(max(along / square, 0.0), 1.0)
        near = 0.0
        for i in range(3):
            near += (v[i] + x * (w[i] - v[i])) ** 2
        if near < (NEAR * contact.d) ** 2:
            most = math.sqrt(square)
    return way, most / contact.d, free


@part
def _is_pair(pairs, A, B):
    for m in range(pairs.shape[0]):  # noqa: SIM110
        if pairs[m, 0] == A and pairs[m, 1] == B:
            return True
    return False


@part
def _stray(contact, state):
    """Whether spheres touch that are no pair; looked for once they may have come near."""
    if 2.0 * _bound(contact.reach, contact.home, state) < contact.apart:
        return False
    count = contact.carrier.size
    centres = np.empty((count, 3))
    for A in range(count):
        centre(contact, state, A, centres[A])
    for A in range(count):
        for B in range(A + contact.near + 1, count):
            y = centres[B, 1] - centres[A, 1]
            if abs(y) >= contact.d:
                continue
            square = (centres[B, 0] - centres[A, 0]) ** 2 + y * y + (centres[B, 2] - centres[A, 2]) ** 2
            if square >= contact.d**2 or contact.carrier[A] == contact.carrier[B]:
                continue
            if not _is_pair(contact.pairs, A, B):
                return True
    return False


@kernel
def commit(reals, ints, state, memory):
    """Update the contact memory with an accepted state; returns the least gap of all pairs.

    A pair that touches is remembered where there is friction, one that has opened is forgotten. Minus
    infinity says that spheres touch which are no pair.
    """
    contact = view_contact(reals, ints)
    if contact.pairs.shape[0] > 0 and _stray(contact, state):
        return -np.inf
    least = np.inf
    c, w, e = np.empty(3), np.empty(3), np.empty(3)
    for m in range(contact.pairs.shape[0]):
        h = _vector(contact, state, m, c, w)
        least = min(least, h - contact.d)
        if contact.mu == 0.0:
            continue
        if h < contact.d:
            hold(w, h, contact.kc, memory[m], e)
        else:
            memory[m, ON] = 0.0
    return least


@kernel
def renew(reals, ints, state, memory):
    """Renew the bounds of the tangential forces; see `coilspring.kernelset`."""
    contact = view_contact(reals, ints)
    change = 0.0
    if contact.mu == 0.0:
        return change
    most = contact.mu * contact.kc * (SLIGHT * contact.d) ** contact.k
    c, w = np.empty(3), np.empty(3)
    for m in range(contact.pairs.shape[0]):
        if memory[m, ON] == 0.0:
            continue
        bound = contact.mu
        if bound < np.inf:
            h = _vector(contact, state, m, c, w)
            bound *= contact.kc * max(contact.d - h, 0.0) ** contact.k
            change = max(change, abs(bound - memory[m, BOUND]))
            most = max(most, bound)
        memory[m, BOUND] = bound
    return change / most if change > 0.0 else 0.0
