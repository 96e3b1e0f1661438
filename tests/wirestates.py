"""What tests read off the wire model's stored states by themselves."""

import numpy as np

from wirefe.contact.stations import turned_rows as turned
from wirefe.element.beam import beams
from wirefe.element.poses import ROW


def elements(path, step):
    """Points, strain energy and gradients (elements, 12) of the wire at a stored step."""
    data, rows = path.shape.data.elements, path.states[step].reshape(-1, ROW)
    points, turns = rows[:, :3].copy(), rows[:, 3:]
    points[-1] += turned(turns[-1], data.arm)
    g, H = np.empty((len(rows) - 1, 12)), np.empty((0, 12, 12))
    elastic = data.strain0, data.stiffness, data.second
    return points, beams(path.states[step], data.arm, data.triads, *elastic, g, H), g


def centres(contact, state):
    """Centres of the spheres in a state, from the rigid motion of the nodes that carry them."""
    rows = state.reshape(-1, ROW)[contact.attached]
    return rows[:, :3] + turned(rows[:, 3:], contact.parts)


def add(total, force, point, moment=0.0):
    """Add a force and a moment that act at a point to the total about the origin."""
    total[:3] += force
    total[3:] += moment + np.cross(point, force)


def dense(data, H, n):
    """Full matrix (n, n) of a model's blocks."""
    blocks, attached = H.reshape(-1, 6, 6), data.contact.attached
    full = np.zeros((n, n))
    for node in range(n // 6):
        full[6 * node : 6 * node + 6, 6 * node : 6 * node + 6] = blocks[node]
    chain = [(e, e + 1) for e in range(len(data.elements.block))]
    resting = data.plates.couplings(n // 6 - 1)
    done = set()
    for part, ends in (
        (data.elements, chain),
        (data.contact, attached[data.contact.pairs]),
        (data.plates, resting),
    ):
        for block, flip, (a, b) in zip(part.block, part.flip, ends, strict=True):
            if block not in done:
                done.add(block)
                rows, columns = (a, b) if flip else (b, a)
                full[6 * rows : 6 * rows + 6, 6 * columns : 6 * columns + 6] = blocks[block]
                full[6 * columns : 6 * columns + 6, 6 * rows : 6 * rows + 6] = blocks[block].T
    return full
