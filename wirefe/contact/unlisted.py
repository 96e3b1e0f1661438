"""Contact points that touch although they are no pair."""

from __future__ import annotations

import numpy as np

from coilspring.compiling.compiled import arithmetic, part
from wirefe.contact.spheres import centre
from wirefe.contact.stations import ROTATION, of_wires, point_of


@part
def _is_pair(contact, A, B):
    """Whether two contact points are a pair; of stations, whether the first has one on the second's coil."""
    near = contact.near if of_wires(contact.parts) else 0
    for m in range(contact.pairs.shape[0]):
        if contact.pairs[m, 0] == A and abs(contact.pairs[m, 1] - B) <= near:
            return True
    return False


@part
def _one_body(contact, A, B):
    """Whether two contact points move with one node."""
    if contact.attached[A] != contact.attached[B]:
        return False
    return not of_wires(contact.parts) or contact.parts[A, ROTATION] == contact.parts[B, ROTATION] == 0.0


@arithmetic
def _contact_point(contact, state, k):
    """Where a sphere or a station is."""
    if of_wires(contact.parts):
        return point_of(contact.parts[k], state, contact.attached[k])
    x, _ = centre(contact, state, k)
    return x


@arithmetic
def touch_unlisted(contact, state):
    """Whether contact points touch that are no pair."""
    count = contact.attached.size
    centres = np.empty((count, 3))
    for A in range(count):
        centres[A, 0], centres[A, 1], centres[A, 2] = _contact_point(contact, state, A)
    for A in range(count):
        for B in range(A + contact.near + 1, count):
            y = centres[B, 1] - centres[A, 1]
            if abs(y) >= contact.d:
                continue
            square = (centres[B, 0] - centres[A, 0]) ** 2 + y * y + (centres[B, 2] - centres[A, 2]) ** 2
            if square < contact.d**2 and not _one_body(contact, A, B) and not _is_pair(contact, A, B):
                return True
    return False
