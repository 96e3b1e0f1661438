"""Contact points of a scene: spheres at nodes or stations along the wire, and the pairs that may touch."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from coilspring.compiling.packing import Table, Vector, Wholes, WholeTable
from coilspring.contact.law import tangential_stiffness
from coilspring.errors import InputError, require_integer
from coilspring.scene import Scene
from coilspring.scene.profile import TWO_PI
from coilspring.scene.spring import Spring
from wirefe.contact.stations import (
    ARMS,
    ROTATION,
    SLOPES,
    across_wires,
    carried,
    of_wires,
    on_one_node,
    rest_tangents,
)
from wirefe.mesh import WireMesh

FEW = 200  # contact points, all pairs of which are looked at; of more, those that a tree finds near
PER_TURN = {"spheres": 4, "wires": 32}  # contact points, unless asked otherwise
NONE = np.zeros(0, dtype=np.int64)
NONE_FOUND = NONE.reshape(0, 2)  # no pairs besides those one turn apart


class ContactArrays(NamedTuple):
    """Points that stand for the wire in contact, the pairs that may touch, and their law."""

    attached: Wholes  # (points,) node to which each is attached; of stations the lower one
    parts: Table  # (points, 3) arm of a sphere at rest, or (points, 15): see `wirefe.contact.stations`
    pairs: WholeTable  # (pairs, 2), from bottom to top
    rest_overlap: Vector  # (pairs,) by how much wires run into each other at rest: they touch there
    weights: Vector  # (pairs,) spacings of stations that each stands for: 1 but where the wire ends
    d: float
    kc: float  # of a pair of weight 1
    kt: float
    k: float
    mu: float  # coefficient of friction: 0 without, infinite where closed pairs do not slide
    near: int  # points so near each other along the wire do not touch: half a turn
    # of a model with these points:
    reach: float = 0.0  # largest arm about the top end
    span: float = 0.0  # the same about other nodes, of a station both; 0 where spheres stand on them
    block: Wholes = NONE  # (pairs,) block of each pair's coupling; of stations (6 pairs,), see `COUPLINGS`
    flip: Wholes = NONE

    def reaches(self, top: int) -> tuple[float, float]:
        """Largest arms of points about the last node, `top`, and about the others, both of a station, mm."""
        arms = self.parts[:, ARMS:SLOPES] if of_wires(self.parts) else self.parts
        sizes = np.linalg.norm(arms.reshape(len(arms), arms.shape[1] // 3, 3), axis=2)
        nodes = self.attached[:, None] + np.arange(sizes.shape[1])
        fixed = (nodes == 0) & (sizes[:, 1:].sum(axis=1, keepdims=True) == 0.0)  # at the bottom end
        about_top, about_others = nodes >= top, (nodes < top) & ~fixed
        return (
            float((sizes * about_top).max(initial=0.0)),
            float((sizes * about_others).sum(axis=1).max(initial=0.0)),
        )


NO_CONTACT = ContactArrays(
    NONE, np.zeros((0, 3)), NONE_FOUND, np.zeros(0), np.zeros(0), 1.0, 1.0, 1.0, 1.0, 0.0, 0
)


def require_pairs(pairs_per_turn: int, geometry: str) -> None:
    """Refuse a number of contact points that no scene with this geometry can have."""
    # a station must be nearer to one coil than to the next
    require_integer("pairs_per_turn", pairs_per_turn, 1 if geometry == "spheres" else 2, 2000)


def require_nodes(elements_per_turn: int, pairs_per_turn: int) -> None:
    """Refuse a mesh that has no node at every sphere."""
    if elements_per_turn % pairs_per_turn:
        raise InputError(
            f"elements_per_turn must be a multiple of pairs_per_turn = {pairs_per_turn}, "
            f"got {elements_per_turn!r}"
        )


def places(spring: Spring, pairs_per_turn: int) -> tuple[np.ndarray, tuple[float, float]]:
    """Phases of contact points, and of the ends of the wire, in units of a turn over `pairs_per_turn`."""
    first, end = (phase / TWO_PI * pairs_per_turn for phase in spring.phase_range)
    return np.arange(math.ceil(first - 1e-9), math.floor(end + 1e-9) + 1), (first, end)


def contact_points(
    scene: Scene,
    mesh: WireMesh,
    elements_per_turn: int,
    pairs_per_turn: int,
    found: np.ndarray = NONE_FOUND,
) -> ContactArrays:
    """Contact points at `pairs_per_turn` phases a turn, end turns included, each paired one turn above.

    The stiffness per length of wire is kept: K * 4 / pairs, of stations where the wire ends times what they
    stand for. Pairs inside one rigid end are left out; the pairs `found` are added.
    """
    spheres = scene.contact.geometry == "spheres"
    require_pairs(pairs_per_turn, scene.contact.geometry)
    if spheres:
        require_nodes(elements_per_turn, pairs_per_turn)
    spring = scene.spring
    index, (first, end) = places(spring, pairs_per_turn)
    phases = index * TWO_PI / pairs_per_turn
    points = spring.points(phases)
    if spheres:
        start = round(mesh.phases[0] / TWO_PI * elements_per_turn)
        attached = np.clip(index * (elements_per_turn // pairs_per_turn) - start, 0, len(mesh.phases) - 1)
        parts = points - mesh.nodes[attached]
    else:
        attached, parts = on_one_node(*carried(spring, mesh, phases))
    body = bodies(attached, parts)
    pairs = np.stack((np.arange(len(index) - pairs_per_turn), np.arange(pairs_per_turn, len(index))), axis=1)
    weights = np.ones(len(pairs)) if spheres else _spacings(index[: len(pairs)], first, end - pairs_per_turn)
    kept = body[pairs[:, 0]] != body[pairs[:, 1]]
    pairs = np.concatenate((pairs[kept], found))
    d = spring.wire_diameter
    stiffness, exponent = scene.contact.pair_stiffness(pairs_per_turn), scene.contact.exponent
    contact = ContactArrays(
        attached=attached,
        parts=parts,
        pairs=pairs,
        rest_overlap=np.zeros(len(pairs)),
        weights=np.concatenate((weights[kept], np.ones(len(found)))),
        d=d,
        kc=stiffness,
        kt=tangential_stiffness(stiffness, exponent, d),
        k=exponent,
        mu=scene.contact.coefficient,
        near=pairs_per_turn // 2,
    )
    if not scene.contact.enabled:
        return contact._replace(pairs=pairs[:0], rest_overlap=np.zeros(0), weights=np.zeros(0))
    if spheres:
        return contact
    t = rest_tangents(mesh, attached, parts)
    low, high = pairs.T
    gap = across_wires(points[high] - points[low], t[low] + t[high], contact.rest_overlap)
    return contact._replace(rest_overlap=np.maximum(d - np.linalg.norm(gap, axis=1), 0.0))


def _spacings(at: np.ndarray, first: float, last: float) -> np.ndarray:
    """Lengths between `first` and `last` that points `at` stand for, one apart: each reaches half way to the
    next, the outermost to the ends. A single one stands for half of one at least: it must hold the ends."""
    if not len(at):
        return np.zeros(0)
    return np.maximum(np.diff(np.concatenate(([first], 0.5 * (at[1:] + at[:-1]), [last]))), 0.5)


def bodies(attached: np.ndarray, parts: np.ndarray) -> np.ndarray:
    """Number of the rigid body with which each contact point moves; one between two nodes has its own."""
    between = parts[:, ROTATION] > 0.0 if of_wires(parts) else np.zeros(len(parts), dtype=bool)
    return attached + 0.5 * between


def reach(contact: ContactArrays, centres: np.ndarray, diameters: float) -> float:
    """Distance of two contact points within which wires may be so many diameters near: the nearest stations
    may be half their spacing apart along the wire."""
    half = 0.0
    if of_wires(contact.parts):
        half = 0.5 * float(np.linalg.norm(np.diff(centres, axis=0), axis=1).max(initial=0.0))
    return math.hypot(diameters * contact.d, half)


def near_points(contact: ContactArrays, centres: np.ndarray, reach: float) -> tuple[np.ndarray, np.ndarray]:
    """Contact points that are no pair, nearer than `reach`: `near_wires` or `near_pairs`."""
    find = near_wires if of_wires(contact.parts) else near_pairs
    return find(centres, bodies(contact.attached, contact.parts), contact.pairs, contact.near, reach)


def near_pairs(
    centres: np.ndarray, body: np.ndarray, pairs: np.ndarray, near: int, reach: float
) -> tuple[np.ndarray, np.ndarray]:
    """Spheres that are no pair, with centres nearer than `reach`: (n, 2), and their distances (n,).

    Spheres up to `near` apart along the wire, or of one rigid body, do not touch.
    """
    if len(centres) <= FEW:
        first, second = np.triu_indices(len(centres), near + 1)
    else:
        first, second = _neighbours(centres, near, reach)
    first, second = _new_pairs(first, second, body, pairs)
    distance = np.linalg.norm(centres[second] - centres[first], axis=1)
    keep = distance < reach
    return np.stack((first[keep], second[keep]), axis=1), distance[keep]


def _new_pairs(
    first: np.ndarray, second: np.ndarray, body: np.ndarray, pairs: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Those of two bodies that are no pair."""
    count = len(body)
    new = ~np.isin(first * count + second, pairs[:, 0] * count + pairs[:, 1])
    keep = new & (body[first] != body[second])
    return first[keep], second[keep]


def _neighbours(centres: np.ndarray, near: int, reach: float) -> tuple[np.ndarray, np.ndarray]:
    """Points farther apart along the wire than `near` and within `reach`, in the order of all pairs."""
    from scipy.spatial import KDTree

    found = KDTree(centres).query_pairs(reach, output_type="ndarray")
    first, second = found[found[:, 1] - found[:, 0] > near].T
    order = np.lexsort((second, first))
    return first[order], second[order]


def near_wires(
    centres: np.ndarray, body: np.ndarray, pairs: np.ndarray, near: int, reach: float
) -> tuple[np.ndarray, np.ndarray]:
    """The same of stations: each with the nearest one of every coil beyond the next without a pair of it."""
    found, distance = near_pairs(centres, body, pairs, 3 * near, reach)
    listed = np.zeros((len(centres), len(centres) // (2 * near) + 2), dtype=bool)
    listed[pairs[:, 0], _coils(pairs, near)] = True
    coils = _coils(found, near)
    free = ~listed[found[:, 0], coils]
    found, distance, coils = found[free], distance[free], coils[free]
    order = np.lexsort((distance, coils, found[:, 0]))
    _, first = np.unique(np.stack((found[order, 0], coils[order])), axis=1, return_index=True)
    return found[order[first]], distance[order[first]]


def _coils(pairs: np.ndarray, near: int) -> np.ndarray:
    """By how many coils pairs are apart."""
    return (pairs[:, 1] - pairs[:, 0] + near) // (2 * near)
