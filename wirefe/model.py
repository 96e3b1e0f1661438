"""The wire model of a scene: its data and the kernels that the path follower calls.

State: a row (x, y, z, q0..q3) for each node. Node 0 moves with the bottom end and is fixed; the last
row is the top end's reference point, from which the wire's last point stands off rigidly.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numba import njit

from coilspring.scene import Scene
from wirefe.beam import beam, deformation
from wirefe.chain import ChainPlan, eliminate, plan_chain, substitute
from wirefe.contact import lever, sphere_pair
from wirefe.mesh import WireMesh, mesh_wire, place_spheres, straight_stiffness, wire_section
from wirefe.rotations import exponential, quaternion_product, rotate

ROW = 7  # numbers of a node in the state
HELD_ALWAYS = (2, 3, 4)  # UZ, ROTX, ROTY of the top reference point


class WireModel(NamedTuple):
    """Arrays of one wire; free nodes are 1..elements, numbered from 0 in the matrix."""

    stiffness: np.ndarray  # (elements, 6, 6)
    strain0: np.ndarray  # (elements, 6) deformation measure at rest
    triads: np.ndarray  # (elements, 2, 4) quaternions of the end frames at rest
    arm: np.ndarray  # (3,) from the top reference point to the wire's last point
    force: np.ndarray  # (3,) dead load on the top reference point at time 1
    height: float  # of the top reference point at rest
    held: np.ndarray  # (6,) freedoms of the top reference point that are held
    carrier: np.ndarray  # (spheres,) node that carries each sphere
    offset: np.ndarray  # (spheres, 3) from its carrier at rest
    pairs: np.ndarray  # (pairs, 2)
    reach: float  # largest offset
    d: float
    kc: float
    k: float
    stick: bool
    element_block: np.ndarray  # (elements,) block of each element's coupling; -1 for the first
    element_flip: np.ndarray
    pair_block: np.ndarray  # (pairs,) block of each pair's coupling; -1 where one side is the ground
    pair_flip: np.ndarray
    plan: ChainPlan


def build_model(scene: Scene, elements_per_turn: int, pairs_per_turn: int) -> tuple[WireModel, WireMesh]:
    """Arrays of the wire model of `scene`, and its mesh."""
    mesh = mesh_wire(scene.spring, elements_per_turn)
    spheres = place_spheres(scene, mesh, elements_per_turn, pairs_per_turn)
    count = len(mesh.elements)
    coupled = np.concatenate((mesh.elements[1:], spheres.carrier[spheres.pairs])) - 1
    free = np.all(coupled >= 0, axis=1)
    touched = np.unique(coupled[count - 1 :])
    last = np.union1d(touched[touched >= 0], [count - 1])
    plan, found, turned = plan_chain(count, coupled[free], last)
    block = np.full(len(coupled), -1)
    flip = np.zeros(len(coupled), dtype=bool)
    block[free], flip[free] = found, turned
    held = np.zeros(6)
    held[list(HELD_ALWAYS)] = 1.0
    for name in scene.supports.top_held:
        held[{"ux": 0, "rotz": 5}[name]] = 1.0
    triads = np.stack((mesh.triads, mesh.triads), axis=1)
    model = WireModel(
        stiffness=straight_stiffness(wire_section(scene), mesh.lengths),
        strain0=_strain_at_rest(mesh, triads),
        triads=triads,
        arm=mesh.arm,
        force=np.array([*scene.load.force, 0.0]),
        height=scene.spring.active_height,
        held=held,
        carrier=spheres.carrier,
        offset=spheres.arm,
        pairs=np.ascontiguousarray(spheres.pairs),
        reach=float(np.linalg.norm(spheres.arm, axis=1).max()),
        d=scene.spring.wire_diameter,
        kc=spheres.stiffness,
        k=float(scene.contact.exponent),
        stick=scene.contact.sliding == "none",
        element_block=np.concatenate(([-1], block[: count - 1])),
        element_flip=np.concatenate(([False], flip[: count - 1])),
        pair_block=block[count - 1 :],
        pair_flip=flip[count - 1 :],
        plan=plan,
    )
    return model, mesh


def _strain_at_rest(mesh: WireMesh, triads: np.ndarray) -> np.ndarray:
    unit = np.array([1.0, 0.0, 0.0, 0.0])
    e0 = np.empty((len(mesh.elements), 6))
    for i, (a, b) in enumerate(mesh.elements):
        deformation(mesh.points[a], unit, mesh.points[b], unit, triads[i, 0], triads[i, 1], e0[i])
    return e0


def rest_state(mesh: WireMesh) -> np.ndarray:
    """State at rest, flat."""
    state = np.zeros((len(mesh.points), ROW))
    state[:, :3] = mesh.points
    state[-1, :3] = mesh.reference
    state[:, 3] = 1.0
    return state.ravel()


def load_vector(model: WireModel, mesh: WireMesh) -> np.ndarray:
    """Load at time 1 in the free freedoms, flat; held ones carry none."""
    load = np.zeros(mesh.freedoms.size)
    load[mesh.freedoms[:3, -1]] = model.force * (1.0 - model.held[:3])
    return load[6:]


def matrix_template(model: WireModel) -> np.ndarray:
    """Blocks of the matrix: the nodes' diagonal blocks first, then couplings and fill."""
    return np.zeros((model.plan.blocks, 6, 6))


@njit(cache=True, error_model="numpy")
def _add_block(H, block, flip, K, p, q):
    """Add the coupling K[p:p+6, q:q+6] of a first and a second node."""
    B = H[block]
    for i in range(6):
        for j in range(6):
            if flip:
                B[i, j] += K[p + i, q + j]
            else:
                B[i, j] += K[q + i, p + j]


@njit(cache=True, error_model="numpy")
def _onto_reference(r, g, K, C):
    """Carry the second node's part of an element over to a point from which it stands off by r.

    dx2 = dX - r x phi; the second derivative adds the lever of the force.
    """
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
    fx, fy, fz = g[6], g[7], g[8]
    g[9] += r[1] * fz - r[2] * fy
    g[10] += r[2] * fx - r[0] * fz
    g[11] += r[0] * fy - r[1] * fx


@njit(cache=True, error_model="numpy")
def centre(model, state, sphere, c):
    """Centre of a sphere."""
    i = ROW * model.carrier[sphere]
    rotate(state[i + 3 : i + 7], model.offset[sphere], c)
    for j in range(3):
        c[j] += state[i + j]


@njit(cache=True, error_model="numpy")
def _add_elements(model, state, g, H):
    """Strain energy; adds its gradient and Hessian."""
    energy = 0.0
    ge = np.empty(12)
    Ke = np.empty((12, 12))
    x2 = np.empty(3)
    r = np.empty(3)
    C = np.empty((3, 3))
    count = model.stiffness.shape[0]
    for e in range(count):
        a, b = ROW * e, ROW * (e + 1)
        x2[:] = state[b : b + 3]
        if e == count - 1:
            rotate(state[b + 3 : b + 7], model.arm, r)
            x2 += r
        energy += beam(
            state[a : a + 3], state[a + 3 : a + 7], x2, state[b + 3 : b + 7],
            model.triads[e, 0], model.triads[e, 1], model.strain0[e], model.stiffness[e], ge, Ke,
        )  # fmt: skip
        if e == count - 1:
            _onto_reference(r, ge, Ke, C)
        for i in range(6):
            g[6 * e + i] += ge[6 + i]
            for j in range(6):
                H[e, i, j] += Ke[6 + i, 6 + j]
        if e > 0:
            for i in range(6):
                g[6 * e - 6 + i] += ge[i]
                for j in range(6):
                    H[e - 1, i, j] += Ke[i, j]
            _add_block(H, model.element_block[e], model.element_flip[e], Ke, 0, 6)
    return energy


@njit(cache=True, error_model="numpy")
def _side(f, Hg, r, sign, g, K, p, J, C):
    """Gradient and own Hessian block of one carrier, at p = 0 or 6; J (3, 6) is its dg/dq."""
    J[:] = 0.0
    for i in range(3):
        J[i, i] = sign
    J[0, 4], J[0, 5], J[1, 3] = sign * r[2], -sign * r[1], -sign * r[2]
    J[1, 5], J[2, 3], J[2, 4] = sign * r[0], sign * r[1], -sign * r[0]
    lever(f, r, C)
    for i in range(6):
        g[p + i] = J[0, i] * f[0] + J[1, i] * f[1] + J[2, i] * f[2]
    for i in range(3):
        for j in range(3):
            K[p + 3 + i, p + 3 + j] = sign * C[i, j]


@njit(cache=True, error_model="numpy")
def pair_matrix(f, Hg, ra, rb, g, K, Ja, Jb, C):
    """Gradient (12,) and Hessian (12, 12) of a pair in its carriers' freedoms; ra, rb as turned now."""
    K[:] = 0.0
    _side(f, Hg, ra, -1.0, g, K, 0, Ja, C)
    _side(f, Hg, rb, 1.0, g, K, 6, Jb, C)
    for i in range(12):
        for j in range(12):
            total = 0.0
            for k in range(3):
                for l in range(3):  # noqa: E741
                    left = Ja[k, i] if i < 6 else Jb[k, i - 6]
                    right = Ja[l, j] if j < 6 else Jb[l, j - 6]
                    total += left * Hg[k, l] * right
            K[i, j] += total


@njit(cache=True, error_model="numpy")
def _add_pairs(model, memory, state, g, H):
    """Contact energy; adds its gradient and Hessian. Only pairs that touch are scattered."""
    energy = 0.0
    ca, cb, w, f = np.empty(3), np.empty(3), np.empty(3), np.empty(3)
    Hg, C = np.empty((3, 3)), np.empty((3, 3))
    Ja, Jb = np.empty((3, 6)), np.empty((3, 6))
    ge, Ke = np.empty(12), np.empty((12, 12))
    for m in range(model.pairs.shape[0]):
        A, B = model.pairs[m, 0], model.pairs[m, 1]
        centre(model, state, A, ca)
        centre(model, state, B, cb)
        h2 = 0.0
        for i in range(3):
            w[i] = cb[i] - ca[i]
            h2 += w[i] * w[i]
        if h2 >= model.d * model.d and memory[m, 0] == 0.0:
            continue
        energy += sphere_pair(w, math.sqrt(h2), model.d, model.kc, model.k, memory[m], f, Hg)
        a, b = model.carrier[A], model.carrier[B]
        for i in range(3):
            ca[i] -= state[ROW * a + i]
            cb[i] -= state[ROW * b + i]
        pair_matrix(f, Hg, ca, cb, ge, Ke, Ja, Jb, C)
        for side in range(2):
            n = (a if side == 0 else b) - 1
            if n >= 0:
                for i in range(6):
                    g[6 * n + i] += ge[6 * side + i]
                    for j in range(6):
                        H[n, i, j] += Ke[6 * side + i, 6 * side + j]
        if model.pair_block[m] >= 0:
            _add_block(H, model.pair_block[m], model.pair_flip[m], Ke, 0, 6)
    return energy


@njit(cache=True, error_model="numpy")
def _hold(model, g, H):
    """Take the held freedoms of the top out: no force, rows and columns of the unit matrix.

    The top is eliminated last, so that all its couplings have its freedoms as rows.
    """
    top = model.stiffness.shape[0] - 1
    for i in range(6):
        if model.held[i] > 0.0:
            g[6 * top + i] = 0.0
            H[top, i, :] = 0.0
            H[top, :, i] = 0.0
            H[top, i, i] = 1.0
            H[model.element_block[top], i, :] = 0.0
            for m in range(model.pairs.shape[0]):
                if model.carrier[model.pairs[m, 1]] == top + 1 and model.pair_block[m] >= 0:
                    H[model.pair_block[m], i, :] = 0.0


@njit(cache=True, error_model="numpy")
def assemble(model, anchor, clearance, memory, state, time, g, H):
    """Total potential, gradient and matrix; see `coilspring.newton` for the contract."""
    g[:] = 0.0
    H[:] = 0.0
    energy = _add_elements(model, state, g, H)
    count = model.pairs.shape[0]
    if count > 0 and 2.0 * _bound(model, anchor, state) < clearance:
        count = 0
    if count > 0:
        energy += _add_pairs(model, memory, state, g, H)
    top = model.stiffness.shape[0]
    for i in range(3):
        g[6 * top - 6 + i] -= time * model.force[i]
        rest = model.height if i == 1 else 0.0
        energy -= time * model.force[i] * (state[ROW * top + i] - rest)
    _hold(model, g, H)
    return energy, count


@njit(cache=True, error_model="numpy")
def factor(model, F):
    """Block LDL^T in place; returns the negative pivots."""
    return eliminate(model.plan, F)


@njit(cache=True, error_model="numpy")
def solve(model, F, b):
    """Back substitution in place."""
    substitute(model.plan, F, b)


@njit(cache=True, error_model="numpy")
def retract(model, state, step, factor, out):
    """Positions add; rotations are turned by the exponential of their spin."""
    turn = np.empty(4)
    out[:ROW] = state[:ROW]
    for n in range(step.size // 6):
        p, s = 6 * n, ROW * (n + 1)
        for i in range(3):
            out[s + i] = state[s + i] + factor * step[p + i]
        exponential(factor * step[p + 3], factor * step[p + 4], factor * step[p + 5], turn)
        quaternion_product(turn, state[s + 3 : s + 7], out[s + 3 : s + 7])
        norm = 0.0
        for i in range(3, 7):
            norm += out[s + i] ** 2
        for i in range(3, 7):
            out[s + i] /= math.sqrt(norm)


@njit(cache=True, error_model="numpy")
def _bound(model, a, b):
    """Bound on how far any point of the wire's nodes or any sphere moved between two states."""
    most = 0.0
    last = a.size - ROW
    for s in range(ROW, a.size, ROW):
        way = math.sqrt((a[s] - b[s]) ** 2 + (a[s + 1] - b[s + 1]) ** 2 + (a[s + 2] - b[s + 2]) ** 2)
        if s == last:
            same, other = 0.0, 0.0
            for i in range(3, 7):
                same += (a[s + i] - b[s + i]) ** 2
                other += (a[s + i] + b[s + i]) ** 2
            # |R r - R' r| <= 2 sin(angle/2) |r| <= 2 |q - q'| |r|
            way += 2.0 * math.sqrt(min(same, other)) * model.reach
        most = max(most, way)
    return most


@njit(cache=True, error_model="numpy")
def _vector(model, state, m, c, w):
    """Vector between the centres of a pair, and its length."""
    centre(model, state, model.pairs[m, 1], w)
    centre(model, state, model.pairs[m, 0], c)
    for i in range(3):
        w[i] -= c[i]
    return math.sqrt(w[0] ** 2 + w[1] ** 2 + w[2] ** 2)


@njit(cache=True, error_model="numpy")
def motion(model, a, b):
    """See `coilspring.newton`: bound on the way of any point, and the largest pair motion over d."""
    most = 0.0
    c, v, w = np.empty(3), np.empty(3), np.empty(3)
    for m in range(model.pairs.shape[0]):
        near = min(_vector(model, a, m, c, v), _vector(model, b, m, c, w))
        if near < 1.5 * model.d:
            most = max(most, math.sqrt((v[0] - w[0]) ** 2 + (v[1] - w[1]) ** 2 + (v[2] - w[2]) ** 2))
    return _bound(model, a, b), most / model.d


@njit(cache=True, error_model="numpy")
def commit(model, state, memory):
    """Update the contact memory with an accepted state; returns the least gap of all pairs.

    A pair that has just closed is remembered with its vector g0 and direction n0, one that has
    opened is forgotten.
    """
    least = np.inf
    c, w = np.empty(3), np.empty(3)
    for m in range(model.pairs.shape[0]):
        h = _vector(model, state, m, c, w)
        least = min(least, h - model.d)
        if not model.stick:
            continue
        if h >= model.d:
            memory[m, 0] = 0.0
        elif memory[m, 0] == 0.0:
            memory[m, 0] = 1.0
            for i in range(3):
                memory[m, 1 + i] = w[i]
                memory[m, 4 + i] = w[i] / h
    return least
