"""Whether coils pass through each other, by code that shares nothing with the solver.

Points of the wire, a quarter of a wire diameter apart, are compared with all others by a k-d tree; the
circles of the equivalent beam with all others, and in their order.
"""

import math

import numpy as np

from coilspring import EquilibriumPath, Spring
from validation.campaign.energy import circles, turned
from validation.campaign.verdict import THROUGH, Verdict
from validation.campaign.wireparts import Points, helix

ALLOWED = 0.1  # wire diameters of overlap beyond that of the deepest pair
SEEN = 0.03  # of them: what the solver's stations and these points see differently
SPACING = 0.25  # wire diameters between points


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
    nodes = helix(spring, np.linspace(0.0, 2.0 * math.pi * spring.active_coils, len(rows)))
    per_turn = math.ceil(math.pi * max(spring.mean_diameter) / (SPACING * d))
    wire = Points(spring, nodes, per_turn, wires=True)
    low, high = wire.places(rows)[wire.touching(rows, d).T]
    return d - float(np.linalg.norm(high - low, axis=1).min(initial=d))


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
