"""Least stiffness of a frictionless wire whose top is held along the axis, for the verifier."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from scipy.linalg import eigh

from validation.campaign.poses import NUDGE, nudged, width
from validation.campaign.slipping import wire_tangent
from validation.campaign.wire import WireForces

NONE = (np.zeros((0, 2), int), np.zeros((0, 3)))


def least_stiffness(forces: WireForces, rows: np.ndarray) -> float:
    """Least eigenvalue of the tangent in a state, in units of that at rest; positive where stable."""
    free = ~forces.fixed
    free[-1, 1] = False
    free = free.ravel()
    rest = _tangent(forces, forces.rest)
    some = np.ix_(free, free)
    return float(eigh(_tangent(forces, rows)[some], rest[some], subset_by_index=(0, 0), eigvals_only=True)[0])


def _tangent(forces: WireForces, rows: np.ndarray) -> np.ndarray:
    """Symmetric derivative of all forces in moves and spins of the nodes: in balance it is symmetric."""
    J, d = wire_tangent(forces, rows, 0), forces.d
    for node in np.unique(forces.attached[forces.touching(rows)[0]]):
        for i in range(6):
            ends = [forces.contact_forces(nudged(rows, node, i, h, d)) for h in (NUDGE, -NUDGE)]
            J[:, 6 * node + i] += ((ends[0] - ends[1]) / width(i, d)).ravel()
    return 0.5 * (J + J.T)


def vanishing(times: Sequence[float], least: Sequence[float]) -> float | None:
    """Time at which a stiffness vanishes that falls over the three times given, the latest first.

    Next to a bifurcation it falls as the time left, next to a fold as its root: the power which a straight
    line through the first and last fits best in the middle is taken; None where it falls otherwise.
    """
    found = []
    for power in (1.0, 2.0):
        a, b, c = (value**power for value in least)
        slope = (a - c) / (times[0] - times[2])
        if slope >= 0.0:
            continue
        bend = abs(b - c - slope * (times[1] - times[2])) / abs(a - c)
        ahead = [
            float(root.real)
            for root in np.roots(np.polyfit(np.array(times) - times[0], [a, b, c], 2))
            if root.imag == 0.0 and root.real >= 0.0
        ]
        if ahead:
            found.append((bend, times[0] + min(ahead)))
    return min(found)[1] if found else None
