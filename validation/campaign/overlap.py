"""Whether coils pass through each other, by code that shares nothing with the solver.

The wire is a cubic curve through the nodes along its tangents there, and straight or helical pieces of the
rigid ends; points of it, a quarter of a wire diameter apart, are compared with all others by a k-d tree. The
circles of the equivalent beam are compared with all others, and in their order.
"""

from __future__ import annotations

import math

import numpy as np
from scipy.interpolate import CubicHermiteSpline
from scipy.spatial import cKDTree

from coilspring import EquilibriumPath, Spring
from validation.campaign.energy import circles, turned
from validation.campaign.poses import carried, rotated
from validation.campaign.verdict import THROUGH, Verdict
from validation.campaign.wireparts import helix

ALLOWED = 0.1  # wire diameters of overlap beyond that of the deepest pair
SEEN = 0.03  # of them: what the solver's stations and these points see differently
SPACING = 0.25  # wire diameters between points
TWO_PI = 2.0 * math.pi


def excess(path: EquilibriumPath, states: np.ndarray) -> np.ndarray:
    """Overlap of the wire or the circles in states, less that of the deepest pair, in wire diameters."""
    find = _wire_overlap if path.model == "wirefe" else _beam_overlap
    deepest = np.maximum(-path.shape.pair_gaps(states).min(axis=1, initial=0.0), 0.0)
    spring = path.scene.spring
    return (np.array([find(spring, state) for state in states]) - deepest) / spring.wire_diameter


def verify_overlap(verdict: Verdict, path: EquilibriumPath) -> None:
    """No row of a path, printed as an answer, may hold wires that have passed through each other; and where
    a path ends for that, they must be about to do so."""
    if not path.scene.contact.enabled:
        return
    for time, found in zip(path.times, excess(path, path.states), strict=True):
        if found > ALLOWED + SEEN:
            verdict.complain(f"wires overlap by {found:.2f} diameters at time {time:.6g}, unsaid")
            return
    if path.outcome == THROUGH:
        assert path.last_state is not None
        last = float(excess(path, path.last_state[None])[0])
        verdict.ask("overlap", abs(last - ALLOWED), SEEN, "wires overlap otherwise where the path ends")


def _wire_overlap(spring: Spring, state: np.ndarray) -> float:
    """Overlap of a wire of equal elements, mm; not of what is half a turn apart, or in one end."""
    d, rows = spring.wire_diameter, state.reshape(-1, 7)
    count, last = len(rows) - 1, TWO_PI * spring.active_coils
    per_turn = math.ceil(math.pi * max(spring.mean_diameter) / (SPACING * d))
    parts = math.ceil(per_turn * spring.active_coils / count)
    low = np.arange(-TWO_PI * spring.end_turns, -1e-9, TWO_PI / per_turn)
    high = last + TWO_PI * spring.end_turns - (low + TWO_PI * spring.end_turns)[::-1]
    phases = np.concatenate((low, np.linspace(0.0, last, parts * count + 1), high))
    bottom, top = helix(spring, np.zeros(1)), np.array([0.0, spring.active_height, 0.0])
    points = np.concatenate(
        (
            carried(rows[:1], helix(spring, low) - bottom),
            _between(spring, rows, np.linspace(0.0, last, count + 1), parts),
            carried(rows[-1:], helix(spring, high) - top),
        )
    )
    pairs = cKDTree(points).query_pairs(d, output_type="ndarray")  # the lower index, here phase, first
    first, second = phases[pairs].reshape(-1, 2).T
    rigid = (second <= 1e-9) | (first >= last - 1e-9)
    pairs = pairs[(second - first >= math.pi - 1e-9) & ~rigid]
    distance = np.linalg.norm(points[pairs[:, 0]] - points[pairs[:, 1]], axis=1)
    return d - float(distance.min(initial=d))


def _between(spring: Spring, rows: np.ndarray, nodes: np.ndarray, parts: int) -> np.ndarray:
    """Points of the elastic wire, `parts` for each element: as at rest, moved with the mean rotation of both
    nodes, and a cubic for what that leaves at them."""
    low, high, rest = rows[:-1], rows[1:].copy(), helix(spring, nodes)
    high[-1, :3] = carried(rows[-1], rest[-1] - [0.0, spring.active_height, 0.0])
    same = np.sign((low[:, 3:] * high[:, 3:]).sum(axis=1, keepdims=True))
    mean = low[:, 3:] + same * high[:, 3:]
    mean = np.hstack((low[:, :3], mean / np.linalg.norm(mean, axis=1, keepdims=True)))
    width = nodes[1] - nodes[0]
    shares = np.arange(parts) / parts
    arms = helix(spring, nodes[:-1, None] + width * shares) - rest[:-1, None]
    tangents = width * helix(spring, nodes, 1)
    slopes = [
        (rotated(end[:, 3:].T, tangent.T) - rotated(mean[:, 3:].T, tangent.T)).T
        for end, tangent in ((low, tangents[:-1]), (high, tangents[1:]))
    ]
    missing = high[:, :3] - carried(mean, np.diff(rest, axis=0))
    cubic = CubicHermiteSpline([0.0, 1.0], np.stack((0.0 * missing, missing)), np.stack(slopes))
    points = carried(mean[:, None], arms) + cubic(shares).swapaxes(0, 1)
    return np.concatenate((points.reshape(-1, 3), high[-1:, :3]))


def _beam_overlap(spring: Spring, state: np.ndarray) -> float:
    """Overlap of a beam's circles, mm; those that have changed places on the axis overlap side by side."""
    node, offset = circles(spring)
    x, y, theta = state.reshape(-1, 3)[node].T
    centre = np.stack((x, y)) + turned(theta, *offset.T)
    first, second = np.triu_indices(len(node), 1)
    keep = node[first] != node[second]
    first, second = first[keep], second[keep]
    gap = centre[:, second] - centre[:, first]
    beside, along = turned(-0.5 * (theta[first] + theta[second]), *gap)
    passed = (second - first == 2) & (along < 0.0)
    return spring.wire_diameter - float(np.where(passed, np.abs(beside), np.hypot(*gap)).min())
