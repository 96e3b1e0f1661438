"""Contact points that touch although they are no pair."""

import math

import numpy as np

from coilspring.compiling.compiled import arithmetic, inlined
from wirefe.contact.spheres import centre
from wirefe.contact.stations import ROTATION, of_wires
from wirefe.contact.wires import facing, placed
from wirefe.element.algebra import dot, plus
from wirefe.element.poses import three


@inlined
def _is_pair(contact, A, B):
    """Whether two contact points are a pair; of stations, whether the first has one on the second's coil."""
    near = contact.near if of_wires(contact.parts) else 0
    for m in range(contact.pairs.shape[0]):
        if contact.pairs[m, 0] == A and abs(contact.pairs[m, 1] - B) <= near:
            return True
    return False


@inlined
def _one_body(contact, A, B):
    """Whether two contact points move with one node."""
    if contact.attached[A] != contact.attached[B]:
        return False
    return not of_wires(contact.parts) or contact.parts[A, ROTATION] == contact.parts[B, ROTATION] == 0.0


@arithmetic
def _contact_points(contact, state):
    """Where the centres of spheres are, or `placed` stations."""
    if of_wires(contact.parts):
        return placed(contact, state)
    centres = np.empty((contact.attached.size, 3))
    for k in range(contact.attached.size):
        x, _ = centre(contact, state, k)
        centres[k, 0], centres[k, 1], centres[k, 2] = x
    return centres


@arithmetic
def _wires_touch(contact, points, A, B, most):
    """Whether wires touch between the stations A and B: across the gap, and no farther along the wire than
    the square `most`."""
    w, tau = facing(points, A, B)
    along = dot(w, tau) ** 2 / dot(tau, tau)
    return along <= most and dot(w, w) - along < contact.d**2


@arithmetic
def touch_unlisted(contact, state):
    """Whether contact points touch that are no pair; of wires, whether these touch anywhere between two
    stations. Stations of neighbouring coils are pairs.

    Where points are too far apart along the axis, as many are passed over as cannot be nearer.
    """
    count, wires, most, rise = contact.attached.size, of_wires(contact.parts), 0.0, 0.0
    centres = _contact_points(contact, state)
    for A in range(1, count):
        step = plus(three(centres[A], 0), -1.0, three(centres[A - 1], 0))
        most = max(most, 0.25 * dot(step, step) if wires else 0.0)
        rise = max(rise, abs(step[1]))
    reach = math.sqrt(contact.d**2 + most)
    for A in range(count):
        B = A + (3 if wires else 1) * contact.near + 1
        while count > B:
            w = plus(three(centres[B], 0), -1.0, three(centres[A], 0))
            beyond = abs(w[1]) - reach
            if beyond > 0.0:
                B += 1 + int(min(beyond / rise, float(count)))
                continue
            near = dot(w, w) < reach**2 and not (_one_body(contact, A, B) or _is_pair(contact, A, B))
            if near and (not wires or _wires_touch(contact, centres, A, B, most)):
                return True
            B += 1
    return False
