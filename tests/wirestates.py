"""What tests read off the wire model's stored states by themselves."""

import numpy as np

from wirefe.beam import beams
from wirefe.model import ROW
from wirefe.shape import turned


def elements(path, step):
    """Points, strain energy and gradients (elements, 12) of the wire at a stored step."""
    data, rows = path.shape.data.elements, path.states[step].reshape(-1, ROW)
    points, turns = rows[:, :3].copy(), rows[:, 3:]
    points[-1] += turned(turns[-1], data.arm)
    count = len(rows) - 1
    g, H = np.empty((count, 12)), np.empty((count, 12, 12))
    ends, rotations = (np.stack((a[:-1], a[1:]), axis=1) for a in (points, turns))
    return points, beams(ends, rotations, data.triads, data.strain0, data.stiffness, g, H), g


def centres(contact, state):
    """Centres of the spheres in a state, from the rigid motion of the nodes that carry them."""
    rows = state.reshape(-1, ROW)[contact.carrier]
    return rows[:, :3] + turned(rows[:, 3:], contact.offset)


def add(total, force, point, moment=0.0):
    """Add a force and a moment that act at a point to the total about the origin."""
    total[:3] += force
    total[3:] += moment + np.cross(point, force)
