"""Whether coils pass through each other, by code that shares nothing with the solver.

The wire is a cubic curve through the nodes along its tangents there, and straight or helical pieces of the
rigid ends; points of it, a quarter of a wire diameter apart, are compared with all others by a k-d tree. The
circles of the equivalent beam are compared with all others, and in their order.
"""

from __future__ import annotations

import math

import numpy as np
from scipy.spatial import cKDTree

from coilspring import EquilibriumPath, Spring
from validation.campaign.poses import rotated
from validation.campaign.verdict import THROUGH, Verdict
from validation.campaign.wireparts import helix

ALLOWED = 0.1  # wire diameters of overlap beyond that of the deepest pair
SEEN = 0.03  # of them: what the solver's stations and these points see differently
SPACING = 0.25  # wire diameters between points
SMALL = 1e-6  # rad, for tangents
TWO_PI = 2.0 * math.pi


def excess(path: EquilibriumPath, states: np.ndarray) -> np.ndarray:
    """Overlap of the wire or the circles in states, less that of the deepest pair, in wire diameters."""
    find = _wire_overlap if path.model == "wirefe" else _beam_overlap
    deepest = np.maximum(-path.shape.pair_gaps(states).min(axis=1, initial=0.0), 0.0)
    return (np.array([find(path, state) for state in states]) - deepest) / path.scene.spring.wire_diameter


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


def _wire_overlap(path: EquilibriumPath, state: np.ndarray) -> float:
    """Overlap of a wire of equal elements, mm; not of what is half a turn apart, or in one end."""
    spring, d = path.scene.spring, path.scene.spring.wire_diameter
    rows = state.reshape(-1, 7)
    count = len(rows) - 1
    nodes = np.linspace(0.0, TWO_PI * spring.active_coils, count + 1)
    per_turn = math.ceil(math.pi * max(spring.mean_diameter) / (SPACING * d))
    inner = math.ceil(per_turn * spring.active_coils / count) * count  # points of the active wire
    active = np.linspace(0.0, nodes[-1], inner + 1)
    low = np.arange(-TWO_PI * spring.end_turns, -1e-9, TWO_PI / per_turn)
    high = nodes[-1] + TWO_PI * spring.end_turns - (low + TWO_PI * spring.end_turns)[::-1]
    phases = np.concatenate((low, active, high))
    reference = np.array([0.0, spring.active_height, 0.0])
    home = helix(spring, np.zeros(1))[0]
    points = np.concatenate(
        (
            _moved(rows[0], helix(spring, low) - home),
            _between(spring, rows, nodes, inner // count),
            _moved(rows[-1], helix(spring, high) - reference),
        )
    )
    pairs = cKDTree(points).query_pairs(d, output_type="ndarray")
    first, second = phases[pairs].T if len(pairs) else np.zeros((2, 0))
    first, second = np.minimum(first, second), np.maximum(first, second)
    rigid = (second <= 1e-9) | (first >= nodes[-1] - 1e-9)
    pairs = pairs[(second - first >= math.pi - 1e-9) & ~rigid]
    distance = np.linalg.norm(points[pairs[:, 0]] - points[pairs[:, 1]], axis=1)
    return d - float(distance.min(initial=d))


def _moved(row: np.ndarray, arms: np.ndarray) -> np.ndarray:
    """Points (n, 3) carried by a node, from their arms at rest."""
    return row[:3] + rotated(row[3:], arms.T).T


def _between(spring: Spring, rows: np.ndarray, nodes: np.ndarray, parts: int) -> np.ndarray:
    """Points of the elastic wire, `parts` for each element: as at rest, moved with the mean rotation of both
    nodes, and a cubic for what that leaves at them."""
    low, high = rows[:-1], rows[1:].copy()
    A, B = helix(spring, nodes[:-1]), helix(spring, nodes[1:])
    top = B[-1] - np.array([0.0, spring.active_height, 0.0])
    high[-1, :3] = _moved(rows[-1], top[None])[0]
    same = np.sign((low[:, 3:] * high[:, 3:]).sum(axis=1))[:, None]
    mean = low[:, 3:] + same * high[:, 3:]
    mean = (mean / np.linalg.norm(mean, axis=1)[:, None]).T
    width = nodes[1] - nodes[0]
    at = nodes[:-1, None] + width * np.arange(parts) / parts
    arms = helix(spring, at.ravel()).reshape(-1, parts, 3) - A[:, None]
    out = low[:, None, :3] + np.stack([rotated(mean, arms[:, k].T).T for k in range(parts)], axis=1)
    left = high[:, :3] - low[:, :3] - rotated(mean, (B - A).T).T
    slopes = []
    for phases, turn in ((nodes[:-1], low), (nodes[1:], high)):
        t = width * (helix(spring, phases + SMALL) - helix(spring, phases - SMALL)).T / (2.0 * SMALL)
        slopes.append((rotated(turn[:, 3:].T, t) - rotated(mean, t)).T[:, None])
    s = (np.arange(parts) / parts)[None, :, None]
    out += (
        s * (1.0 - s) ** 2 * slopes[0] + s**2 * (3.0 - 2.0 * s) * left[:, None] - s**2 * (1.0 - s) * slopes[1]
    )
    return np.concatenate((out.reshape(-1, 3), high[-1:, :3]))


def _beam_overlap(path: EquilibriumPath, state: np.ndarray) -> float:
    """Overlap of a beam's circles, mm; those that have changed places on the axis overlap side by side."""
    spring, d = path.scene.spring, path.scene.spring.wire_diameter
    count = round(2.0 * spring.active_coils)
    ends = int(2.0 * spring.end_turns + 1e-9)
    index = np.arange(-ends, count + ends + 1)
    node = np.clip(index, 0, count)
    x, y, theta = state.reshape(-1, 3)[node].T
    bottom, top = spring.mean_diameter
    side = np.where(index % 2 == 0, 1.0, -1.0) * (1.0 if math.cos(spring.start_phase) >= 0.0 else -1.0)
    arm = side * 0.5 * (bottom + (top - bottom) * node / count)
    rise = 0.5 * d * (index - node)
    centre = np.stack(
        (x + arm * np.cos(theta) - rise * np.sin(theta), y + arm * np.sin(theta) + rise * np.cos(theta))
    )
    first, second = np.triu_indices(len(index), 1)
    keep = node[first] != node[second]
    first, second = first[keep], second[keep]
    gap = centre[:, second] - centre[:, first]
    distance = np.hypot(*gap)
    turn = 0.5 * (theta[first] + theta[second])
    passed = (second - first == 2) & (gap[1] * np.cos(turn) - gap[0] * np.sin(turn) < 0.0)
    beside = np.abs(gap[0] * np.cos(turn) + gap[1] * np.sin(turn))
    return d - float(np.where(passed, beside, distance).min())
