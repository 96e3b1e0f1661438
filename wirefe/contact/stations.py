"""Stations along the wire: points and tangents of it anywhere between the nodes, whatever the mesh.

With x, R of a node, X its place at rest and T(P) = x + R (P - X), the wire between the points A and B of two
nodes a and b is the cubic along the turned tangents of the wire at rest: at the share s between them

    (1 - s) Ta(P) + s Tb(P) - s (1 - s)^2 (Tb(A) - Ta(A)) + s^2 (1 - s) (Tb(B) - Ta(B)),

a sum of both positions and of an arm turned with each. So is its derivative along the wire, the tangent. A
vector fixed to the wire's section at s turns with (1 - s) Ra + s Rb.
"""

import numpy as np

from coilspring.compiling.compiled import arithmetic, inlined, kernel
from coilspring.scene.spring import Spring
from wirefe.element.algebra import applied, plus
from wirefe.element.poses import ROW, four, three, three_of
from wirefe.element.rotations import cross_rows, matrix, turned
from wirefe.mesh import WireMesh

# What a station takes of its two nodes, by columns: the second node's share of the position, of the tangent,
# of the section's rotation; then arms (3) of the position and of the tangent, of the first and second node.
POSITION, TANGENT, ROTATION, ARMS, SLOPES, WIDTH = 0, 1, 2, 3, 9, 15
SAME = 1e-9  # of an element: so near to a node a station is at it


def carried(spring: Spring, mesh: WireMesh, phases: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Node at or below the wire at some phases, and what the station there takes of it and of the next one,
    shape (phases, 15). End turns that are rigid move with their node alone."""
    rest = spring.points(phases)
    node, position = carried_points(mesh, phases, rest)
    whole, s, A, B, a, b = _neighbours(mesh, phases, node)
    tangent = spring.tangents(phases)
    length = np.linalg.norm(tangent, axis=1, keepdims=True)
    step = mesh.phases[1] - mesh.phases[0]
    per_length = np.where((whole == s[:, 0])[:, None], 1.0 / (step * length), 0.0)
    dlow, dhigh = (1.0 - s) * (1.0 - 3.0 * s) * per_length, s * (2.0 - 3.0 * s) * per_length
    along = tangent / length
    position[:, TANGENT : TANGENT + 1] = per_length - dlow + dhigh
    slopes = (
        (1.0 - s) * along - per_length * (rest - a) + dlow * (A - a) - dhigh * (B - a),
        s * along + per_length * (rest - b) - dlow * (A - b) + dhigh * (B - b),
    )
    return node, np.concatenate((position, *slopes), axis=1)


def carried_points(mesh: WireMesh, phases: np.ndarray, rest: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The same for positions alone, shape (phases, 9); `rest` are the wire's points at rest."""
    node = np.clip(np.searchsorted(mesh.phases, phases), 1, len(mesh.phases) - 1) - 1
    return node, parts_between(mesh, node, phases, rest)


def parts_between(mesh: WireMesh, node: np.ndarray, phases: np.ndarray, rest: np.ndarray) -> np.ndarray:
    """What points of the elements above some nodes take of both ends, shape (phases, 9)."""
    _, s, A, B, a, b = _neighbours(mesh, phases, node)
    low, high = s * (1.0 - s) ** 2, s**2 * (1.0 - s)
    parts = np.zeros((len(phases), SLOPES))
    parts[:, POSITION : POSITION + 1] = s - low + high
    parts[:, ROTATION : ROTATION + 1] = s
    parts[:, ARMS : ARMS + 3] = (1.0 - s) * (rest - a) + low * (A - a) - high * (B - a)
    parts[:, ARMS + 3 :] = s * (rest - b) - low * (A - b) + high * (B - b)
    return parts


def _neighbours(mesh: WireMesh, phases: np.ndarray, node: np.ndarray) -> tuple[np.ndarray, ...]:
    """Of the element above each node: phase as a part of it, and within it; points and nodes at its ends."""
    homes = mesh.nodes
    step = mesh.phases[1] - mesh.phases[0]
    whole = (phases - mesh.phases[node]) / step
    whole = np.where(np.abs(whole - np.rint(whole)) < SAME, np.rint(whole), whole)
    s = np.minimum(np.maximum(whole, 0.0), 1.0)[:, None]
    return whole, s, mesh.points[node], mesh.points[node + 1], homes[node], homes[node + 1]


def on_one_node(node: np.ndarray, parts: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The same where stations at a node, or in a rigid end, take all of that one: no second node then."""
    first, second = parts[:, ROTATION] == 0.0, parts[:, ROTATION] == 1.0
    single = parts.copy()
    single[first | second, : ROTATION + 1] = 0.0
    for arm in (ARMS, SLOPES):
        own, other = slice(arm, arm + 3), slice(arm + 3, arm + 6)
        single[second, own] = parts[second, other]
        single[first | second, other] = 0.0
    return node + second, single


@inlined
def of_wires(parts):
    """Whether these are the parts of stations, not the arms of spheres."""
    return parts.shape[1] == WIDTH


def rows(states: np.ndarray) -> np.ndarray:
    """States (n, size) as rows of their nodes, shape (n, nodes, 7)."""
    return states.reshape(len(states), states.shape[1] // ROW, ROW)


def turned_rows(q: np.ndarray, v: np.ndarray) -> np.ndarray:
    """Vectors v (..., 3) turned by the unit quaternions q (..., 4)."""
    t = 2.0 * cross_rows(q[..., 1:], v)
    return v + q[..., :1] * t + cross_rows(q[..., 1:], t)


def rest_tangents(mesh: WireMesh, node: np.ndarray, parts: np.ndarray) -> np.ndarray:
    """Tangents of stations at rest, where nothing is turned, (stations, 3)."""
    nodes, share = mesh.nodes, parts[:, TANGENT, None]
    upper = np.minimum(node + 1, len(nodes) - 1)
    arms = parts[:, SLOPES : SLOPES + 3] + parts[:, SLOPES + 3 :]
    return arms - share * nodes[node] + share * nodes[upper]


def stations_in(states: np.ndarray, node: np.ndarray, parts: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Positions and tangents of stations in states (n, size), each of shape (n, stations, 3)."""
    points = np.empty((len(states), len(node), 6))
    _fill_all(np.ascontiguousarray(states), node, parts, points)
    return points[..., :3], points[..., 3:]


@kernel
def _fill_all(states, node, parts, points):
    for n in range(len(states)):
        fill_stations(node, parts, states[n], points[n])


@arithmetic
def fill_stations(node, parts, state, points):
    """Fill the positions and tangents of stations, (stations, 6)."""
    A = B = matrix((1.0, 0.0, 0.0, 0.0))
    for k, of in enumerate(node):
        i = ROW * of
        if k == 0 or of != node[k - 1]:  # many stations have the same two nodes
            A = matrix(four(state, i + 3))
            if i + ROW < state.size:
                B = matrix(four(state, i + ROW + 3))
        x = plus(applied(A, three_of(parts, k, ARMS)), 1.0 - parts[k, POSITION], three(state, i))
        t = plus(applied(A, three_of(parts, k, SLOPES)), -parts[k, TANGENT], three(state, i))
        if parts[k, ROTATION] != 0.0:
            other = three(state, i + ROW)
            x = plus(plus(x, 1.0, applied(B, three_of(parts, k, ARMS + 3))), parts[k, POSITION], other)
            t = plus(plus(t, 1.0, applied(B, three_of(parts, k, SLOPES + 3))), parts[k, TANGENT], other)
        points[k, 0], points[k, 1], points[k, 2] = x
        points[k, 3], points[k, 4], points[k, 5] = t


def fixed_to_sections(
    nodes: np.ndarray, node: np.ndarray, parts: np.ndarray, vectors: np.ndarray
) -> np.ndarray:
    """Vectors (..., stations, 3) fixed to the sections of stations at rest, as turned now."""
    share = parts[:, ROTATION, None]
    high = nodes[..., np.minimum(node + 1, nodes.shape[-2] - 1), 3:]
    return (1.0 - share) * turned_rows(nodes[..., node, 3:], vectors) + share * turned_rows(high, vectors)


def across_wires(w: np.ndarray, tau: np.ndarray, rest_overlap: np.ndarray) -> np.ndarray:
    """The part of vectors w (..., pairs, 3) across the sum tau of two tangents, longer by `rest_overlap`."""
    along = (w * tau).sum(axis=-1) / (tau * tau).sum(axis=-1)
    across = w - along[..., None] * tau
    h = np.linalg.norm(across, axis=-1)
    return across * (1.0 + rest_overlap / h)[..., None]


@arithmetic
def point_of(parts, state, node):
    """Position of a station."""
    i = ROW * node
    x = plus(turned(four(state, i + 3), three(parts, ARMS)), 1.0 - parts[POSITION], three(state, i))
    if parts[ROTATION] == 0.0:
        return x
    x = plus(x, 1.0, turned(four(state, i + ROW + 3), three(parts, ARMS + 3)))
    return plus(x, parts[POSITION], three(state, i + ROW))
