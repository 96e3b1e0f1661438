"""Whether coils pass through each other, by the verifier's own geometry.

Points of the wire, a tenth of a wire diameter apart, are compared with all others by a k-d tree; the
circles of the equivalent beam with all others, and in their order. Of the wire model's path only the list of
its pairs is taken.
"""

import math
from collections.abc import Mapping
from typing import Any

import numpy as np

from coilspring import EquilibriumPath, Spring
from validation.campaign.coils import largest_diameter
from validation.campaign.energy import BeamEnergy, circles, turned
from validation.campaign.verdict import Verdict
from validation.campaign.wire import WireForces
from validation.campaign.wirepairs import fresh_pairs
from validation.campaign.wireparts import Points, helix

ALLOWED = 0.1  # wire diameters of overlap beyond that of the deepest pair
SEEN = 0.03  # of them: what the solver's stations and these points see differently
SPACING = 0.1  # wire diameters between points


def excess(path: EquilibriumPath, states: np.ndarray) -> np.ndarray:
    """Overlap of the wire or the circles in states, less that of the deepest pair, in wire diameters."""
    find = _wire_overlaps if path.model == "wirefe" else _beam_overlaps
    spring = path.scene.spring
    return (find(spring, states) - deepest(path, states)) / spring.wire_diameter


def deepest(path: EquilibriumPath, states: np.ndarray) -> np.ndarray:
    """Penetration of a path's deepest pair in states, mm; 0 where none touches.

    Neither the law nor the kind of element changes where pairs are.
    """
    if path.model == "equivbeam":
        depths = BeamEnergy(path.scene, "haringx").depths(states)
    else:
        options: Mapping[str, Any] = path.options
        forces = WireForces(path.scene, "straight", options["elements_per_turn"], options["pairs_per_turn"])
        pairs = fresh_pairs(forces.points, forces.law, forces.rest, path.shape.pair_law.pairs)
        depths = pairs.depth(states.reshape(len(states), states.shape[1] // 7, 7))
    return depths.max(axis=1, initial=0.0)


def verify_overlap(verdict: Verdict, path: EquilibriumPath) -> None:
    """No row of a path, printed as an answer, may hold wires that have passed through each other; and where
    a path ends for that, they must be about to do so."""
    if not path.scene.contact.enabled:
        return
    for time, found in zip(path.times, excess(path, path.states), strict=True):
        if found > ALLOWED + SEEN:
            verdict.complain(f"wires overlap by {found:.2f} diameters at time {time:.6g}, unsaid")
            return
    if path.outcome == "interpenetration":
        assert path.last_state is not None
        last = float(excess(path, path.last_state[None])[0])
        verdict.ask("overlap", abs(last - ALLOWED), SEEN, "wires overlap otherwise where the path ends")


def _wire_overlaps(spring: Spring, states: np.ndarray) -> np.ndarray:
    """Overlaps of a wire of equal elements in states, mm; not of what is half a turn apart, or in one end."""
    d, count, least = spring.wire_diameter, states.shape[1] // 7, []
    nodes = helix(spring, np.linspace(0.0, 2.0 * math.pi * spring.active_coils, count))
    per_turn = math.ceil(math.pi * largest_diameter(spring) / (SPACING * d))
    wire = Points(spring, nodes, per_turn, wires=True)
    for state in states:
        places = wire.places(state.reshape(-1, 7))
        low, high = places[wire.touching(places, d).T]
        least.append(np.linalg.norm(high - low, axis=1).min(initial=d))
    return d - np.array(least)


def _beam_overlaps(spring: Spring, states: np.ndarray) -> np.ndarray:
    """Overlaps of a beam's circles in states, mm; those that have changed places on the axis overlap side by
    side."""
    node, offset = circles(spring)
    x, y, theta = (states[:, i::3][:, node] for i in range(3))
    centre = np.stack((x, y)) + turned(theta, *offset.T)
    first, second = np.triu_indices(len(node), 1)
    keep = node[first] != node[second]
    first, second = first[keep], second[keep]
    gap = centre[..., second] - centre[..., first]
    distance, next_coil = np.hypot(*gap), second - first == 2
    mean = 0.5 * (theta[:, first] + theta[:, second])[:, next_coil]
    beside, along = turned(-mean, *gap[..., next_coil])
    distance[:, next_coil] = np.where(along < 0.0, np.abs(beside), distance[:, next_coil])
    return spring.wire_diameter - distance.min(axis=1)
