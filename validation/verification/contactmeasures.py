"""What is measured of contact in the wire model: overlaps, couples, work and the springs they are of."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import lru_cache

import numpy as np
from scipy.spatial import cKDTree

import wirefe
from coilspring import Contact, EquilibriumPath, Scene, spring_a, spring_b
from validation.study.partialsolve import as_far
from wirefe.model import ContactArrays
from wirefe.shape import sphere_centres

NONE = np.inf  # no sliding
SPRINGS: dict[str, Callable[[], Scene]] = {"A": spring_a, "B": spring_b}
CATALOGUE = {"A": 0.0, "B": NONE}  # coefficients of the catalogue's springs
HELD = 1e-9  # tips below are held freedoms' rounding
REPEATS = 3  # timed runs, of which the least counts


def with_friction(name: str, coefficient: float) -> Scene:
    """A spring of the paper with a coefficient of friction; 0 for none, infinite for no sliding."""
    sliding = {0.0: "free", NONE: "none"}.get(coefficient, "coulomb")
    contact = Contact(sliding=sliding, friction=coefficient if sliding == "coulomb" else None)
    return replace(SPRINGS[name](), contact=contact)


@lru_cache
def solved(name: str, coefficient: float, steps: int = 50, pairs: int = 4) -> EquilibriumPath:
    """A spring's path, as far as it goes."""
    return as_far(wirefe.solve, with_friction(name, coefficient), steps=steps, pairs_per_turn=pairs)


def seconds(name: str, pairs: int) -> float:
    """Least CPU time of a spring's path over the repeats."""
    scene = with_friction(name, CATALOGUE[name])
    return min(as_far(wirefe.solve, scene, pairs_per_turn=pairs).solve_seconds for _ in range(REPEATS))


def overlap(path: EquilibriumPath, points_per_turn: int = 160) -> float:
    """Largest overlap of wires of neighbouring coils anywhere at the last step, mm.

    Distances of points of the centreline from the straight pieces half a turn to one and a half turns on;
    points of one rigid end turn do not count with each other.
    """
    line = path.centreline(-1, points_per_turn)
    ends = round(path.scene.spring.end_turns * points_per_turn)
    half = points_per_turn // 2
    least = np.inf
    for ahead in range(half, 3 * half):
        count = len(line) - ahead - 1
        first, second = line[ahead : ahead + count], line[ahead + 1 : ahead + 1 + count]
        distance = to_pieces(line[:count], first, second)
        inside = np.arange(count)
        active = (inside + ahead >= ends) & (inside < len(line) - ends)
        least = min(least, float(distance[active].min()))
    return max(path.scene.spring.wire_diameter - least, 0.0)


def to_pieces(points: np.ndarray, first: np.ndarray, second: np.ndarray) -> np.ndarray:
    """Distance of each point from its piece between `first` and `second`."""
    way, out = second - first, points - first
    share = np.clip((out * way).sum(axis=1) / (way * way).sum(axis=1), 0.0, 1.0)
    return np.linalg.norm(out - share[:, None] * way, axis=1)


def centres(path: EquilibriumPath, step: int) -> tuple[ContactArrays, np.ndarray]:
    """Contact arrays and the spheres' centres at a stored step."""
    contact = path.shape.data.contact  # type: ignore[attr-defined]
    return contact, sphere_centres(contact, path.states[step])


def couple(path: EquilibriumPath) -> float:
    """Size of the sum of the couples g x f_t that the tangential forces leave at the last step, N mm."""
    contact, places = centres(path, -1)
    way = places[contact.pairs[:, 1]] - places[contact.pairs[:, 0]]
    return float(np.linalg.norm(np.cross(way, path.friction.force[-1]).sum(axis=0)))


def dissipated(path: EquilibriumPath) -> float:
    """Work taken by friction along the path, of pairs that have opened since included, N mm."""
    work = path.friction.work
    before = np.vstack((np.zeros(work.shape[1]), work[:-1]))
    return float(np.where(work < before - 1e-12, work, work - before).sum())


def unlisted(path: EquilibriumPath) -> int:
    """Overlaps of spheres, over all stored states, that are no pair of the model."""
    count = 0
    for step in range(len(path.times)):
        contact, places = centres(path, step)
        listed = {tuple(pair) for pair in contact.pairs.tolist()}
        touching = cKDTree(places).query_pairs(contact.d, output_type="ndarray").tolist()
        count += sum(
            b - a > contact.near and contact.attached[a] != contact.attached[b] and (a, b) not in listed
            for a, b in touching
        )
    return count


def difference(path: EquilibriumPath, reference: EquilibriumPath) -> float:
    """Largest difference of a tip's component over that component, of those that move."""
    peak = np.abs(reference.tips[-1])
    moved = peak > HELD
    return float((np.abs(path.tips[-1] - reference.tips[-1])[moved] / peak[moved]).max())
