"""What contact between the nodes does to section forces.

A point of contact within an element gives its force to both nodes. The element has the same force all along
it, so what acts on the wire between the point and a node is found from these shares: below a point the first
node's is added, above it the second node's is taken away.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from coilspring.compiling.packing import pack
from wirefe import kernels, seated
from wirefe.contact.plates import BORDERS
from wirefe.contact.stations import ROTATION, SAME, rows
from wirefe.element.rotations import cross_rows
from wirefe.mesh import WireMesh
from wirefe.model import HeldArrays, WireModel


class Between(NamedTuple):
    """What acts at points between the nodes of elements."""

    node: np.ndarray  # (points,) lower one of each
    share: np.ndarray  # (points,) of the element from there
    loads: np.ndarray  # (states, points, 2, 6) forces and moments on both nodes, N, N mm


def station_loads(model: WireModel, states: np.ndarray, histories: np.ndarray) -> np.ndarray:
    """Forces and moments of contact on the two nodes of each station, (states, stations, 2, 6), N, N mm.

    The model's own kernel gives them where each station has two nodes for itself.
    """
    contact, elements, nodes = model.contact, model.elements, rows(states)
    first = contact.attached
    second = np.minimum(first + 1, nodes.shape[1] - 1)
    own = np.stack((nodes[:, first], nodes[:, second]), axis=2).reshape(len(states), -1)
    soft = elements._replace(
        stiffness=np.zeros((1, 6, 6)),
        second=elements.second[:0],
        **{name: getattr(elements, name)[:1] for name in ("strain0", "triads", "block", "flip")},
    )
    apart = contact._replace(attached=2 * np.arange(len(first)))
    none = HeldArrays(*(field[:0] for field in model.held))
    data = pack(model._replace(elements=soft, held=none, contact=apart))
    out = np.empty((len(states), 12 * len(first)))
    for state, history, g in zip(own, histories, out, strict=True):
        kernels.assemble(*data, state, 0.0, history, state, g, np.empty(0))
    return -out.reshape(len(states), len(first), 2, 6)


def at_stations(model: WireModel, states: np.ndarray, histories: np.ndarray) -> Between:
    """What coils do to each other at stations within elements."""
    contact = model.contact
    within = np.flatnonzero(contact.parts[:, ROTATION])
    loads = station_loads(model, states, histories)[:, within]
    return Between(contact.attached[within], contact.parts[within, ROTATION], loads)


def at_plates(model: WireModel, states: np.ndarray) -> Between:
    """What plates do to the end turns at the borders of pieces."""
    node = np.repeat(model.plates.node, BORDERS)
    loads = np.empty((len(states), len(node), 12))
    seated.plate_loads(*pack(model), np.ascontiguousarray(states), loads)
    return Between(node, model.plates.parts[:, ROTATION], loads.reshape(len(states), len(node), 2, 6))


def beyond_sections(
    acting: Between, mesh: WireMesh, states: np.ndarray, element: np.ndarray, phases: np.ndarray
) -> np.ndarray:
    """What acts within elements adds to forces and to moments about the origin, (states, sections, 6), at
    sections given by their elements and phases."""
    order, at = np.lexsort((acting.share, acting.node)), mesh.phases
    node, share, loads = acting.node[order], acting.share[order], acting.loads[:, order]
    place = at[node] + share * (at[node + 1] - at[node])
    ends = np.stack((node, node + 1), axis=1)
    loads[..., 3:] += cross_rows(rows(states)[:, ends, :3], loads[..., :3])
    both, second = (_sums(each) for each in (loads.sum(axis=2), loads[:, :, 1]))
    low, high = (np.searchsorted(node, element, side) for side in ("left", "right"))
    near = SAME * (at[1] - at[0])  # at a point itself the mean of both sides is taken
    here, beyond = (np.clip(np.searchsorted(place, phases + side), low, high) for side in (-near, near))
    below = 0.5 * (both[:, here] + both[:, beyond])
    return both[:, high] - below - (second[:, high] - second[:, low])


def _sums(values: np.ndarray) -> np.ndarray:
    """Sums of the first 0, 1, 2, ... along the second axis."""
    states, _, size = values.shape
    return np.concatenate((np.zeros((states, 1, size)), values.cumsum(axis=1)), axis=1)
