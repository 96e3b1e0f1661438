"""Residual, matrix and motion of the wire model: the kernels that the path follower calls."""

import math

import numpy as np

from coilspring.compiling.compiled import arithmetic, clear, inlined, kernel, lent, shaped
from coilspring.contact.kinematics import OVERLAP_ALLOWED, approach, spheres
from coilspring.contact.pairs import accept, update
from coilspring.solver.interface import FIXED
from wirefe.chain import add_block, add_gradient, add_nodes, eliminate, substitute
from wirefe.contact.overlap import wire_overlap
from wirefe.contact.rates import sphere_gradient, sphere_rates, wire_gradient, wire_rates
from wirefe.contact.spheres import add_spheres, between
from wirefe.contact.stations import of_wires
from wirefe.contact.unlisted import touch_unlisted
from wirefe.contact.wireforces import add_wires
from wirefe.contact.wirehistory import standing, wires
from wirefe.contact.wires import across, placed
from wirefe.element.algebra import dot
from wirefe.element.beam import beams, onto_reference
from wirefe.element.poses import ROW, four, three
from wirefe.element.retraction import Move, close, place, spin_between, turn_along
from wirefe.element.rotations import turned
from wirefe.model import view_contact, view_elements, view_held, view_plan, view_stations


@arithmetic
def _vectors(contact, state):
    """Vectors between the centres of spheres, or across the gaps of wires, of all pairs, shape (pairs, 3)."""
    w = np.empty((contact.pairs.shape[0], 3))
    if of_wires(contact.parts):
        points = placed(contact, state)
        for m in range(contact.pairs.shape[0]):
            w[m, 0], w[m, 1], w[m, 2] = across(contact, points, m)
        return w
    for m in range(contact.pairs.shape[0]):
        w[m, 0], w[m, 1], w[m, 2] = between(contact, state, m)[0]
    return w


@arithmetic
def _scatter(chain, state, ge, Ke, g, H):
    """Add the gradients and Hessians of the elements, the last one's carried over to its node."""
    last = len(ge) - 1
    r = turned(four(state, ROW * last + ROW + 3), three(chain.arm, 0))
    onto_reference(r, ge[last], Ke[last:])
    for e in range(len(ge)):
        add_gradient(g, e, e + 1, ge[e])
    for e in range(len(Ke)):
        add_nodes(H, e, e + 1, Ke[e])
        add_block(H, chain.block[e], chain.flip[e], Ke[e])


@inlined
def hold(held, g, H):
    """Take the held dofs out: nothing but FIXED in their rows and columns."""
    for m in range(held.dof.size):
        g[held.dof[m]] = 0.0
    if len(H) == 0:
        return
    for m in range(held.block.size):
        B = H[held.block[m]]
        i = held.place[m]
        for j in range(6):
            if held.row[m]:
                B[i, j] = 0.0
            else:
                B[j, i] = 0.0
    for m in range(held.dof.size):
        n, i = held.dof[m] // 6, held.dof[m] % 6
        for j in range(6):
            H[n, i, j] = H[n, j, i] = 0.0
        H[n, i, i] = FIXED


@kernel
def assemble(reals, ints, accepted, least_gap, history, state, g, flat):
    """Strain and contact energy, gradient and matrix; see `coilspring.solver.interface` for the contract."""
    accepted, history, state, g, flat = lent(accepted), lent(history), lent(state), lent(g), lent(flat)
    contact = view_contact(reals, ints)
    H = shaped(flat, (flat.size // 36, 6, 6))
    clear(g)
    clear(flat)
    chain = view_elements(reals, ints)
    elements = len(chain.triads)
    ge, Ke = np.empty((elements, 12)), np.empty((elements if len(H) > 0 else 0, 12, 12))
    energy = beams(state, chain.arm, chain.triads, chain.strain0, chain.stiffness, chain.second, ge, Ke)
    _scatter(chain, state, ge, Ke, g, H)
    count = contact.pairs.shape[0]
    if count > 0 and least_gap > 0.0 and 2.0 * _bound(contact, accepted, state) < least_gap:
        count = 0
    if count > 0:
        if of_wires(contact.parts):
            energy += add_wires(contact, history, state, g, H)
        else:
            energy += add_spheres(contact, history, state, g, H)
    hold(view_held(ints), g, H)
    return energy, count


@kernel
def factor(reals, ints, flat):
    """Block LDL^T in place; returns the number of negative pivots and the least pivot."""
    flat = lent(flat)
    return eliminate(view_plan(ints), shaped(flat, (flat.size // 36, 6, 6)))


@kernel
def solve(reals, ints, flat, b):
    """Back substitution in place."""
    flat, b = lent(flat), lent(b)
    substitute(view_plan(ints), shaped(flat, (flat.size // 36, 6, 6)), b)


@kernel
def retract(reals, ints, state, step, factor, before, second, out):
    """See `coilspring.solver.interface`; its deformations move the wire (`wirefe.element.retraction`)."""
    state, step, before, out = lent(state), lent(step), lent(before), lent(out)
    move = Move(before, step, factor, second)
    chain = view_elements(reals, ints)
    place(chain.triads, chain.arm, state, move, out)
    close(view_held(ints).placed, chain.arm, state, move, out)


@kernel
def work(reals, ints, load, a, b):
    """Work of a dead load between two states: of forces, and of moments about one axis each."""
    load, a, b = lent(load), lent(a), lent(b)
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
def rotate(reals, ints, a, b, v):
    """See the interface: forces and moments, or motions and spins, turned with their nodes."""
    a, b, v = lent(a), lent(b), lent(v)
    held = view_held(ints)
    p = v.size - 6
    top = three(v, p)
    turn_along(a, b, v)
    if held.placed.size > held.dof.size:
        v[p], v[p + 1], v[p + 2] = top  # what fixes the top does not turn with it
    for m in range(held.dof.size):
        v[held.dof[m]] = 0.0


@inlined
def _bound(contact, a, b):
    """Bound on how far any point of the wire's nodes or any contact point moved between two states."""
    most = 0.0
    last = a.size - ROW
    for s in range(0, a.size, ROW):
        distance = math.sqrt((a[s] - b[s]) ** 2 + (a[s + 1] - b[s + 1]) ** 2 + (a[s + 2] - b[s + 2]) ** 2)
        arm = contact.reach if s == last else contact.span
        if arm > 0.0:
            same, other = 0.0, 0.0
            for i in range(3, 7):
                same += (a[s + i] - b[s + i]) ** 2
                other += (a[s + i] + b[s + i]) ** 2
            # |R r - R' r| <= 2 sin(angle/2) |r| <= 2 |q - q'| |r|
            distance += 2.0 * math.sqrt(min(same, other)) * arm
        most = max(most, distance)
    return most


@kernel
def displacement_bound(reals, ints, a, b, least):
    """See the interface: bound on all motion, pair motion, share of it before the first touch."""
    a, b = lent(a), lent(b)
    contact = view_contact(reals, ints)
    distance = _bound(contact, a, b)
    if contact.pairs.shape[0] == 0 or distance <= least:
        return distance, 0.0, 1.0
    most, free = approach(_vectors(contact, a), _vectors(contact, b), contact.d, contact.mu)
    return distance, most / contact.d, free


@kernel
def update_history(reals, ints, state, history):
    """See `coilspring.contact.pairs`; minus infinity: wires touch that are no pair."""
    state, history = lent(state), lent(history)
    contact = view_contact(reals, ints)
    if contact.pairs.shape[0] > 0 and touch_unlisted(contact, state):
        return -np.inf
    if of_wires(contact.parts):
        return accept(wires(), contact, standing(contact, state), history)
    return accept(spheres(), contact, _vectors(contact, state), history)


@kernel
def update_pairs(reals, ints, accepted, predicted, state, history):
    """See `coilspring.contact.pairs.update`."""
    accepted, predicted, state, history = lent(accepted), lent(predicted), lent(state), lent(history)
    contact = view_contact(reals, ints)
    if contact.mu == 0.0:
        return 0.0
    if of_wires(contact.parts):
        there = standing(contact, accepted), standing(contact, predicted), standing(contact, state)
        return update(wires(), contact, there, history)
    places = _vectors(contact, accepted), _vectors(contact, predicted), _vectors(contact, state)
    return update(spheres(), contact, places, history)


@kernel
def pair_rates(reals, ints, state, motion, history, rates):
    """See `coilspring.solver.interface`."""
    state, motion, history = lent(state), lent(motion), lent(history)
    contact = view_contact(reals, ints)
    if of_wires(contact.parts):
        wire_rates(contact, state, motion, history, rates)
    else:
        sphere_rates(contact, state, motion, history, rates)


@kernel
def length_gradient(reals, ints, state, history, pair, g):
    """See `coilspring.solver.interface`."""
    state, history, g = lent(state), lent(history), lent(g)
    contact, held = view_contact(reals, ints), view_held(ints)
    clear(g)
    if of_wires(contact.parts):
        length = wire_gradient(contact, state, history[pair], pair, g)
    else:
        length = sphere_gradient(contact, state, history[pair], pair, g)
    for m in range(held.dof.size):
        g[held.dof[m]] = 0.0
    return length


@kernel
def overlap(reals, ints, state):
    """See `coilspring.solver.interface`: of the whole wire, and beyond the deepest contact pair."""
    state = lent(state)
    contact = view_contact(reals, ints)
    whole = wire_overlap(view_stations(reals, ints), state)
    if whole <= OVERLAP_ALLOWED * contact.d:
        return whole, whole
    nearest = contact.d
    vectors = _vectors(contact, state)
    for m in range(vectors.shape[0]):
        w = three(vectors[m], 0)
        nearest = min(nearest, math.sqrt(dot(w, w)))
    return whole, whole - (contact.d - nearest)
