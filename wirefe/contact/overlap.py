"""How far the wire runs into itself: all of it against all of it, whatever its contact pairs see.

The wire is followed by stations, points of it at equal phases that move with the nodes about them (as
`wirefe.results.shape` draws it), and the pieces between them. Contact pairs are not asked: between them,
wires could pass through each other unseen.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from coilspring.compiling.compiled import arithmetic, inlined, lent
from coilspring.compiling.packing import Table, Wholes
from coilspring.scene.spring import Spring
from wirefe.contact.stations import POSITION, SLOPES, carried_points, on_one_node, point_of
from wirefe.element.algebra import dot, mixed, plus
from wirefe.element.poses import three
from wirefe.mesh import WireMesh

# A chord lies 0.6 % of the wire's diameter per unit of the coil index beside the wire.
PER_TURN, HALF = 20, 10
# Of the distance of neighbours, at most: what an arc has over its chord, and the wire's strain.
STRETCH = 1.05
SAME = 1e-9
PARALLEL = 1e-9  # square of the sine between chords, below which they count as parallel
# Of the square of `Stations.stride`: by so much the square between stations may exceed the least one, between
# a piece's lower station and the next coil, and between the two nearest stations (half of it for straight
# pieces, the rest is for curvature and strain).
NEAR, CLOSE = 2.0, 1.25
REACH = 1.1  # wire diameters between centrelines beyond which no distance is evaluated
SHARES = (0.25, 0.5, 0.75)  # of a piece, at which those that touch are evaluated more closely


class Stations(NamedTuple):
    """Points along the wire, end turns included, from bottom to top."""

    node: Wholes  # (stations,) node at or below each
    parts: Table  # (stations, 9) what each takes of it and of the next one, see `wirefe.contact.stations`
    stride: float  # largest distance of neighbours, mm
    low: int  # last station of the rigid bottom end
    high: int  # first station of the rigid top end
    diameter: float


NO_STATIONS = Stations(np.zeros(0, dtype=np.int64), np.zeros((0, SLOPES)), 1.0, 0, 0, 1.0)


def place_stations(spring: Spring, mesh: WireMesh) -> Stations:
    """Stations along the whole wire of a mesh."""
    first, last = (phase / (2.0 * math.pi) * PER_TURN for phase in spring.phase_range)
    phases = np.arange(math.ceil(first - SAME), math.floor(last + SAME) + 1) * 2.0 * math.pi / PER_TURN
    points = spring.points(phases)
    node, parts = on_one_node(*carried_points(mesh, phases, points))
    place = node + parts[:, POSITION]
    return Stations(
        node=node,
        parts=parts,
        stride=STRETCH * float(np.linalg.norm(np.diff(points, axis=0), axis=1).max()),
        low=int(np.count_nonzero(place < SAME)) - 1,
        high=int(np.count_nonzero(place < len(mesh.points) - 1 - SAME)),
        diameter=spring.wire_diameter,
    )


@arithmetic
def station_points(stations, state):
    """Where the stations are, three numbers each, flat."""
    out = np.empty(3 * stations.node.size)
    for k in range(stations.node.size):
        place = point_of(stations.parts[k], state, stations.node[k])
        out[3 * k], out[3 * k + 1], out[3 * k + 2] = place
    return out


@arithmetic
def _square(points, i, j):
    """Square of the distance of two stations."""
    apart = plus(three(points, 3 * j), -1.0, three(points, 3 * i))
    return dot(apart, apart)


@arithmetic
def bulge(points, i):
    """From the chord's middle of the piece i to the wire, a parabola of the ends' mean second difference."""
    low, high = max(3 * i, 3), min(3 * i + 3, len(points) - 6)
    ends = plus(three(points, low - 3), 1.0, three(points, high + 3))
    after, before = plus(three(points, low + 3), 1.0, three(points, high - 3)), three(points, low)
    middle = plus(before, 1.0, three(points, high))
    return mixed(-0.0625, plus(ends, 1.0, after), 0.125, middle)


@arithmetic
def square_between(points, i, j, near):
    """Square of the distance of the piece of wire from the station i to the next from that at j.

    Arc to arc where the chords are nearest (Ericson 2005, Real-Time Collision Detection, section 5.1.9).
    Wires that are all but parallel and bend towards each other are nearest elsewhere: where the square is
    less than `near`, it is the least at some shares of the pieces.
    """
    a, b = three(points, 3 * i), three(points, 3 * j)
    u, v, w = (
        plus(three(points, 3 * i + 3), -1.0, a),
        plus(three(points, 3 * j + 3), -1.0, b),
        plus(b, -1.0, a),
    )
    uu, vv, uv, uw, vw = dot(u, u), dot(v, v), dot(u, v), dot(u, w), dot(v, w)
    det = uu * vv - uv * uv
    s = min(max((uw * vv - vw * uv) / det, 0.0), 1.0) if det > PARALLEL * uu * vv else 0.5
    t = min(max((s * uv - vw) / vv, 0.0), 1.0)
    s = min(max((t * uv + uw) / uu, 0.0), 1.0)
    p, q = bulge(points, i), bulge(points, j)
    least = _square_at(u, v, w, p, q, s, t)
    if least < near:
        for share in SHARES:
            t = min(max((share * uv - vw) / vv, 0.0), 1.0)
            least = min(least, _square_at(u, v, w, p, q, share, t))
    return least


@arithmetic
def _square_at(u, v, w, p, q, s, t):
    """Square of the distance of two arcs with chords u, v, w apart, and bulges p, q, at their shares s, t."""
    apart = plus(mixed(-s, u, t, v), 1.0, w)
    apart = plus(apart, 1.0, mixed(-4.0 * s * (1.0 - s), p, 4.0 * t * (1.0 - t), q))
    return dot(apart, apart)


@inlined
def _next_coil(stations, points, least):
    """Least square of the distance of any piece from the coil above it, if less than `least`."""
    count, reach, near = len(points) // 3, NEAR * stations.stride**2, stations.diameter**2
    for i in range(min(stations.high, count - HALF - 1)):
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
            # of coils that cross, the piece from i is nearest to one that need not begin or end at j
            for b in range(max(j - 1, first), min(j + 2, count - 1)):
                least = min(least, square_between(points, i, b, near))
    return least


@inlined
def _far_coils(stations, points, coordinates, least):
    """The same for coils farther along: all pieces about stations that are near."""
    points, (x, y, z) = lent(points), lent(coordinates)
    count, low, high = len(points) // 3, stations.low, stations.high
    near, close = stations.diameter**2, CLOSE * stations.stride**2
    for i in range(min(high + 1, count)):
        first = i + PER_TURN + HALF
        if not _any_near(x, y, z, i, first, least + close):
            continue
        for j in range(first, count):
            if _square(points, i, j) < least + close:
                for a in range(max(i - 1, 0), min(i + 1, high)):
                    for b in range(max(j - 1, low if a <= low else 0), min(j + 1, count - 1)):
                        least = min(least, square_between(points, a, b, near))
    return least


@inlined
def _coordinate(points, axis):
    """One coordinate of all stations: numbers side by side are compared four at a time."""
    out = np.empty(len(points) // 3)
    for k in range(out.size):
        out[k] = points[3 * k + axis]
    return out


@arithmetic
def _any_near(x, y, z, i, first, square):
    """Whether a station from the `first` on is nearer to the i-th than the root of `square`."""
    count, (a, b, c), (u, v, w) = 0, (x[i], y[i], z[i]), (x[first:], y[first:], z[first:])
    for k in range(u.size):
        count += (u[k] - a) ** 2 + (v[k] - b) ** 2 + (w[k] - c) ** 2 < square
    return count > 0


@inlined
def wire_overlap(stations, state):
    """By how much the wire runs into itself, mm; negative where it is free, infinitely without stations."""
    if stations.node.size == 0:
        return -math.inf
    points = station_points(stations, state)
    coordinates = _coordinate(points, 0), _coordinate(points, 1), _coordinate(points, 2)
    least = _next_coil(stations, points, (REACH * stations.diameter) ** 2)
    return stations.diameter - math.sqrt(_far_coils(stations, points, coordinates, least))
