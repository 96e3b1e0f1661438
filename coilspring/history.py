"""Loads that do not grow from nothing in proportion to time: several stages, and a test machine.

A stage begins with the dead load of the last one, and adds its own in proportion to time. A test machine
that prescribes UY of the top is a spring between the top and a grip which moves: stiff against the
scene's spring, and no stiffer than rounding allows. Both are added to a model's energy at the top:

    V = -p . (r - r0) + 1/2 k (y - y0)^2,    load  k dY/dt along y

with the dead load p of the last stages, the machine's stiffness k and the way Y of its grip.
"""

from __future__ import annotations

from collections.abc import Iterator
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from coilspring.compiled import kernel
from coilspring.packing import heads, vector
from coilspring.scene import Scene
from coilspring.sizing import axial_rate

STIFFNESS = 1e5  # of the test machine, in rates of the scene's spring


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


@kernel
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


def machine_stiffness(scene: Scene) -> float:
    """Stiffness of the test machine that prescribes a displacement, N/mm; 0 where forces are given."""
    return STIFFNESS * axial_rate(scene) if scene.load.displacement else 0.0


def stages(scene: Scene, top: Top) -> Iterator[tuple[Drive, np.ndarray]]:
    """What acts on the top in each stage, and the load (2,) that grows in it, N."""
    machine = machine_stiffness(scene)
    held = [name in scene.supports.top_held for name in ("ux", "uy")]
    ends = np.where(held, 0.0, _grip(scene, machine))
    place = np.array([*top.state, *top.freedom, top.diagonal])
    rest = np.array([0.0, scene.spring.active_height])
    for before, after in pairwise(ends):
        yield Drive(place, rest, before, np.array([machine])), after - before


def loads(scene: Scene, times: np.ndarray, tips: np.ndarray) -> np.ndarray:
    """Load on the top at displacements `tips` (steps, 3) found at times, shape (steps, 2), N.

    Of a prescribed displacement it is what the test machine measures.
    """
    machine = machine_stiffness(scene)
    ends = _grip(scene, machine)
    at = np.linspace(0.0, 1.0, len(ends))
    given = np.stack([np.interp(times, at, column) for column in ends.T], axis=1)
    given[:, 1] -= machine * tips[:, 1]
    return given


def _grip(scene: Scene, machine: float) -> np.ndarray:
    """Load at the ends of the stages, the beginning included, shape (stages + 1, 2), N; of a test
    machine it is that on a top that has not moved."""
    load = scene.load
    ends = [(0.0, machine * way) for way in load.displacement] or load.stages or [load.force]
    return np.array([(0.0, 0.0), *ends])
