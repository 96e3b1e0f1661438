"""What acts on the top in a stage of a load history, besides the load that grows in it.

A stage begins with the dead load of the last one, and adds its own in proportion to time; a test machine
(see `coilspring.history`) is there throughout. Both are added to a model's energy at the top:

    V = -p . (r - r0) + 1/2 k (y - y0)^2,    load  k dY/dt along y

with the dead load p of the last stages, the machine's stiffness k and the way Y of its grip.
"""

from __future__ import annotations

from collections.abc import Iterator
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from coilspring.compiled import part
from coilspring.history import grip, machine_stiffness
from coilspring.packing import heads, vector
from coilspring.scene import Scene


class Top(NamedTuple):
    """Where a model keeps x and y of the top reference point."""

    state: tuple[int, int]  # in the state
    freedom: tuple[int, int]  # in the gradient
    diagonal: int  # entry of y with itself in the matrix


class Drive(NamedTuple):
    """What acts on the top in a stage besides its growing load; follows a model's arrays when packed."""

    place: np.ndarray  # (5,) the numbers of `Top`
    rest: np.ndarray  # (2,) position at rest, mm
    force: np.ndarray  # (2,) dead load at the beginning, N; 0 along held freedoms
    machine: np.ndarray  # (1,) stiffness of the test machine, N/mm; 0 where there is none


@part
def drive(reals, ints, state, g, H):
    """Add what acts on the top to the gradient, and to the matrix unless it is empty; returns its energy."""
    head = heads(ints)
    last = len(head)
    place, rest = vector(ints, head[last - 4]), vector(reals, head[last - 3])
    force, machine = vector(reals, head[last - 2]), reals[head[last - 1, 0]]
    energy = 0.0
    for i in range(2):
        energy -= force[i] * (state[place[i]] - rest[i])
        g[place[2 + i]] -= force[i]
    way = state[place[1]] - rest[1]
    g[place[3]] += machine * way
    if H.size > 0:
        H[place[4]] += machine
    return energy + 0.5 * machine * way * way


def stages(scene: Scene, top: Top) -> Iterator[tuple[Drive, np.ndarray]]:
    """What acts on the top in each stage, and the load (2,) that grows in it, N."""
    machine = machine_stiffness(scene)
    held = [name in scene.supports.top_held for name in ("ux", "uy")]
    ends = np.where(held, 0.0, grip(scene, machine))
    place = np.array([*top.state, *top.freedom, top.diagonal])
    rest = np.array([0.0, scene.spring.active_height])
    for before, after in pairwise(ends):
        yield Drive(place, rest, before, np.array([machine])), after - before
