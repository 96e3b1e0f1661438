"""How far the wire runs into itself: all of it against all of it, whatever its contact spheres see.

The wire is followed by stations, points of it at equal phases that move with the nodes about them (as
`wirefe.shape` draws it), and the straight pieces between them. Contact spheres are not asked: between them,
wires could pass through each other unseen.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from coilspring.compiled import arithmetic, part
from coilspring.spring import Spring
from wirefe.algebra import dot, plus
from wirefe.mesh import WireMesh
from wirefe.poses import ROW, four, three
from wirefe.quaternions import turned

PER_TURN, HALF = (
    20,
    10,
)  # a chord lies 0.6 % of the wire's diameter per unit of the coil index beside the wire
STRETCH = (
    1.05  # of the distance of neighbours, at most: what an arc has over its chord, and the wire's strain
)
SAME = 1e-9
REACH = 1.3  # wire diameters between centrelines beyond which a distance is not told


class Stations(NamedTuple):
    """Points along the wire, end turns included, from bottom to top."""

    node: np.ndarray  # (stations,) node at or below each
    share: np.ndarray  # (stations,) of the next node in its motion
    arms: np.ndarray  # (stations, 6) from both nodes, at rest
    stride: float  # largest distance of neighbours, mm
    low: int  # last station of the rigid bottom end
    high: int  # first station of the rigid top end
    diameter: float


NO_STATIONS = Stations(np.zeros(0, dtype=np.int64), np.zeros(0), np.zeros((0, 6)), 1.0, 0, 0, 1.0)


def place_stations(spring: Spring, mesh: WireMesh) -> Stations:
    """Stations along the whole wire of a mesh."""
    first, last = (phase / (2.0 * math.pi) * PER_TURN for phase in spring.phase_range)
    phases = np.arange(math.ceil(first - 1e-9), math.floor(last + 1e-9) + 1) * 2.0 * math.pi / PER_TURN
    rest = spring.points(phases)
    origins = np.concatenate((mesh.points[:-1], mesh.reference[None]))
    upper = np.clip(np.searchsorted(mesh.phases, phases), 1, len(origins) - 1)
    step = mesh.phases[1] - mesh.phases[0]
    share = np.clip((phases - mesh.phases[upper - 1]) / step, 0.0, 1.0)
    return Stations(
        node=upper - 1,
        share=share,
        arms=np.concatenate((rest - origins[upper - 1], rest - origins[upper]), axis=1),
        stride=STRETCH * float(np.linalg.norm(np.diff(rest, axis=0), axis=1).max()),
        low=int(np.count_nonzero(share + upper < 1.0 + SAME)) - 1,
        high=len(phases) - int(np.count_nonzero(share + upper > len(origins) - SAME)),
        diameter=spring.wire_diameter,
    )


@arithmetic
def station_points(stations, state):
    """Where the stations are, three numbers each, flat."""
    out = np.empty(3 * stations.node.size)
    for k in range(stations.node.size):
        i, share = ROW * stations.node[k], stations.share[k]
        p = (0.0, 0.0, 0.0)
        if share < 1.0:
            r = turned(four(state, i + 3), three(stations.arms[k], 0))
            p = plus(p, 1.0 - share, plus(three(state, i), 1.0, r))
        if share > 0.0:
            r = turned(four(state, i + ROW + 3), three(stations.arms[k], 3))
            p = plus(p, share, plus(three(state, i + ROW), 1.0, r))
        out[3 * k], out[3 * k + 1], out[3 * k + 2] = p
    return out


@arithmetic
def _square(points, i, j):
    """Square of the distance of two stations."""
    apart = plus(three(points, 3 * j), -1.0, three(points, 3 * i))
    return dot(apart, apart)


@arithmetic
def _to_piece(points, i, j):
    """Square of the distance of the station i from the straight piece between j and j + 1."""
    a = three(points, 3 * j)
    along, way = plus(three(points, 3 * j + 3), -1.0, a), plus(three(points, 3 * i), -1.0, a)
    share = min(max(dot(along, way) / dot(along, along), 0.0), 1.0)
    apart = plus(way, -share, along)
    return dot(apart, apart)


@part
def _next_coil(stations, points, least):
    """Least square of the distance of any station from the coil above it, if less than `least`."""
    count, reach = len(points) // 3, (0.5 * stations.stride) ** 2
    for i in range(min(stations.high, count - HALF)):
        first = max(i + HALF, stations.low if i <= stations.low else 0)
        j = min(max(i + PER_TURN, first), count - 1)
        here = _square(points, i, j)
        while j > first and _square(points, i, j - 1) < here:
            j -= 1
            here = _square(points, i, j)
        while j + 1 < count and _square(points, i, j + 1) < here:
            j += 1
            here = _square(points, i, j)
        if here < least + reach:
            if j > first:
                least = min(least, _to_piece(points, i, j - 1))
            if j + 1 < count:
                least = min(least, _to_piece(points, i, j))
    return least


@part
def _far_coils(stations, points, least):
    """The same for coils farther along the wire: pairs of every second station first, and where the wire
    between these could be nearer than `least`, all stations about them."""
    count, low, high = len(points) // 3, stations.low, stations.high
    reach = (2.0 * stations.stride) ** 2
    for i in range(0, min(high, count), 2):
        for j in range(i + PER_TURN + HALF, count, 2):
            if _square(points, i, j) < least + reach:
                for a in range(max(i - 1, 0), min(i + 2, high)):
                    for b in range(max(j - 2, low if a <= low else 0), min(j + 2, count - 1)):
                        least = min(least, _to_piece(points, a, b))
    return least


@part
def least_distance(stations, points):
    """Least distance between pieces of wire half a turn apart or more; `REACH` diameters where it is more."""
    least = (REACH * stations.diameter) ** 2
    return math.sqrt(_far_coils(stations, points, _next_coil(stations, points, least)))


@part
def wire_overlap(stations, state):
    """By how much the wire runs into itself, mm; negative where it is free, infinitely without stations."""
    if stations.node.size == 0:
        return -math.inf
    return stations.diameter - least_distance(stations, station_points(stations, state))
