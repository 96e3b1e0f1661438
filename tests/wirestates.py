"""What tests read off the wire model's stored states by themselves."""

import numpy as np

from wirefe.contact.plates import BORDERS
from wirefe.contact.stations import ARMS, POSITION
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


def plate_forces(path, step=-1):
    """Borders of the pieces that may touch, (borders, 3), and their forces: of the bottom, of the top."""
    plates = path.shape.data.plates
    x, gaps = gaps_at(plates, path.states[step])
    f = -pressed(plates, gaps)[0]
    low = plates.below * BORDERS
    return x, f[:low], f[low:]


def gaps_at(plates, state):
    """Borders of all pieces in a state, shape (borders, 3), and their gaps, in plain numpy."""
    nodes, a = state.reshape(-1, 7), np.repeat(plates.node, BORDERS)
    p = plates.parts[:, POSITION, None]
    x = (1.0 - p) * nodes[a, :3] + p * nodes[a + 1, :3]
    x += turned(nodes[a, 3:], plates.parts[:, ARMS : ARMS + 3])
    x += turned(nodes[a + 1, 3:], plates.parts[:, ARMS + 3 : ARMS + 6])
    normal = turned(nodes[-1, 3:], np.array([0.0, 1.0, 0.0]))
    bottom = np.arange(len(a)) < plates.below * BORDERS
    return x, np.where(bottom, x[:, 1], (nodes[-1, :3] - x) @ normal) - plates.c


def pressed(plates, gaps):
    """Forces on the borders, and their derivatives in the gaps of all (borders, borders): by quadrature that
    is exact over the pressed part of each piece."""
    count = len(gaps)
    force, slope = np.zeros(count), np.zeros((count, count))
    for i in range(count - 1):
        a, b = gaps[i : i + 2]
        if i % BORDERS == BORDERS - 1 or min(a, b) >= 0.0:
            continue
        zero = a / (a - b) if a * b < 0.0 else 1.0
        begin, end = (zero, 1.0) if a > 0.0 else (0.0, zero)
        for t in (0.5 - np.sqrt(1.0 / 12.0), 0.5 + np.sqrt(1.0 / 12.0)):
            s, weight = begin + t * (end - begin), 0.5 * (end - begin) * plates.stiffness
            hats = np.array([1.0 - s, s])
            force[i : i + 2] += weight * (hats @ [a, b]) * hats
            slope[i : i + 2, i : i + 2] += weight * np.outer(hats, hats)
    return force, slope
