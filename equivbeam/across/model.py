"""The beam in the plane across: its data, and their places in the packed arrays."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from coilspring.compiled import part
from coilspring.errors import InputError
from coilspring.packing import heads, table, vector
from coilspring.scene import Scene
from coilspring.spring import Spring
from equivbeam.helix import set_range
from equivbeam.helixrows import Refinements, set_ends, wound_rows
from equivbeam.stations import Stations, quarters_at_ends

PAIRS_PER_TURN = 4
# Columns of a circle: share of the next node in carrying it, distance from the axis in the plane and beside
# it, height above its node at rest, rise with the turn of its element.
SHARE, INSIDE, BESIDE, RISE, BOW = range(5)
# Columns of a pair: its circles, the lowest of the four nodes that it couples, and from there the first
# freedoms of the nodes that carry its circles; where it lies beside the plane the first of three elements
# whose angles raise one circle over the other (two of them may be one), and from there whether its circles
# follow their elements' radius, with which sign.
LOWER, FIRST, OFFSET, LEAN, GROWS = 0, 2, 3, 5, 8
SMALL = 1e-9


class AcrossModel(NamedTuple):
    """Arrays of one beam; its first and last node are the ends of the active coils, node 0 is clamped."""

    rows: np.ndarray  # (elements, columns) parameters of the helix law; N, mm, rad throughout
    held: np.ndarray  # (3,) freedoms of the last node that are held: 1.0 or 0.0
    node: np.ndarray  # (circles,) node that carries each circle, or the one below
    circles: np.ndarray  # (circles, 5) columns `SHARE` to `BOW`
    pairs: np.ndarray  # (pairs, 10) columns from `LOWER` to `GROWS` and one more
    arm: np.ndarray  # (pairs,) mean radius of pairs beside the plane, 0 of those in it
    reach: float  # largest distance of a circle from its node
    d: float  # wire diameter: the distance of centres at which a pair touches
    kc: float  # penalty of a pair
    k: float  # exponent
    mu: float  # coefficient of friction; infinite where closed pairs do not slide


def build_across(scene: Scene, sliding: str) -> AcrossModel:
    """Arrays of the beam of `scene`.

    Raises
    ------
    InputError : where the active coils are not a whole number of half coils, the top is free to
        move across or to turn or the end turns are not closed, or the scene has what no beam represents.
    """
    spring, contact = scene.spring, scene.contact
    scene.supports.require_supported("equivbeam")
    at, on = quarters_at_ends(spring), Refinements()
    if not is_axial(scene):
        raise InputError(
            "plane must be working unless supports.top_held has ux and rotz and the spring has closed end "
            "turns, got 'across'"
        )
    rows = wound_rows(spring, scene.material, on, at)
    set_range(rows)
    set_ends(rows, spring, at)
    phases = _circle_phases(scene)
    node, share = _carriers(spring, at, phases)
    circles = _circles(scene, at, phases, node, share)
    pairs = _pairs(phases, node, circles) if contact.enabled else np.zeros((0, 2), dtype=int)
    return AcrossModel(
        rows=rows,
        held=np.array([name in scene.supports.top_held for name in ("ux", "uy", "rotz")], dtype=float),
        node=node,
        circles=circles,
        pairs=_coupled(phases, pairs, node, circles, len(rows)),
        arm=np.abs(circles[pairs, BESIDE]).mean(axis=1),
        reach=float(np.hypot(spring.radius(phases), circles[:, RISE]).max()),
        d=spring.wire_diameter,
        kc=contact.stiffness,
        k=float(contact.exponent),
        mu=contact.coefficient if sliding == "scene" else 0.0,
    )


def is_axial(scene: Scene) -> bool:
    """Whether the spring can only move along its axis, so that one plane is as good as another, and ends in
    closed turns: without them nothing here would keep solid coils from tilting out of the plane."""
    spring, held = scene.spring, scene.supports.top_held
    return "ux" in held and "rotz" in held and spring.ends == "closed" and spring.end_turns > 0.0


def _circle_phases(scene: Scene) -> np.ndarray:
    """Phases of the circles, four a turn, end turns included, from bottom to top."""
    low, high = (phase / (0.5 * math.pi) for phase in scene.spring.phase_range)
    return np.arange(math.ceil(low - SMALL), math.floor(high + SMALL) + 1) * (0.5 * math.pi)


def _carriers(spring: Spring, at: Stations, phases: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Node that carries each circle, or the one below, and the share of the next one.

    A circle between two nodes stands where its height at rest is.
    """
    heights = spring.height(at.phases)
    station = np.interp(phases, at.phases, np.arange(len(at.phases)))
    node = np.floor(station + SMALL).astype(int)
    share = np.interp(spring.height(phases), heights, np.arange(len(heights))) - node
    return node, np.where(station - node > SMALL, share, 0.0)


def _circles(
    scene: Scene, at: Stations, phases: np.ndarray, node: np.ndarray, share: np.ndarray
) -> np.ndarray:
    """Table of the circles."""
    spring = scene.spring
    out = np.zeros((len(phases), 5))
    radius = spring.radius(phases)
    out[:, SHARE] = share
    out[:, INSIDE], out[:, BESIDE] = radius * np.rint(np.sin(phases)), radius * np.rint(np.cos(phases))
    out[:, RISE] = np.where(share > 0.0, 0.0, spring.height(phases) - spring.height(at.phases[node]))
    lower = np.sin(at.phases[node])  # side of the node below
    out[:, BOW] = np.where(share > 0.0, -lower * radius / math.pi, 0.0)
    return out


def _pairs(phases: np.ndarray, node: np.ndarray, circles: np.ndarray) -> np.ndarray:
    """Circles one turn apart, shape (pairs, 2); within one rigid end they never move against each other."""
    index = np.arange(len(phases) - PAIRS_PER_TURN)
    pairs = np.stack((index, index + PAIRS_PER_TURN), axis=1)
    still = (node[pairs[:, 0]] == node[pairs[:, 1]]) & (circles[pairs, SHARE] == 0.0).all(axis=1)
    return pairs[~still]


def _coupled(
    phases: np.ndarray, pairs: np.ndarray, node: np.ndarray, circles: np.ndarray, count: int
) -> np.ndarray:
    """Table of the pairs of a beam of `count` elements."""
    first = np.clip(node[pairs[:, 0]], 0, max(count - 3, 0))
    offset = 3 * (node[pairs] - first[:, None])
    between = circles[pairs, SHARE] > 0.0
    start = np.rint(phases[pairs[:, 0]] / math.pi).astype(int)  # of elements with their middles at k pi
    lean = np.clip(start[:, None] + np.arange(3), 0, count - 1)
    grows = between * np.sign(circles[pairs, BESIDE]).astype(int)
    return np.ascontiguousarray(np.column_stack((pairs, first, offset, lean, grows)))


@part
def view(reals, ints):
    """The model's fields, in their order, in the packed arrays."""
    head = heads(ints)
    return AcrossModel(
        table(reals, head[0]), vector(reals, head[1]), vector(ints, head[2]), table(reals, head[3]),
        table(ints, head[4]), vector(reals, head[5]), reals[head[6, 0]], reals[head[7, 0]],
        reals[head[8, 0]], reals[head[9, 0]], reals[head[10, 0]],
    )  # fmt: skip
