"""What acts on the top in a stage of a load history, besides the load that grows in it.

A stage begins with the dead load p of the last one, and adds its own in proportion to time: the potential of
the former, -p . (r - r0), is added to a model's energy.

A prescribed displacement is a constraint: y moves with time, whatever the spring does, and equilibrium is
asked of all other freedoms. So its gradient is zero, and its stiffness in the matrix is FIXED: so large that
pivots are those of the constrained spring. Newton's steps leave y as it is, and solving
for the load FIXED dY/dt along y gives the tangent of the constrained path.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from coilspring.compiled import part
from coilspring.history import stage_ends
from coilspring.packing import heads, pack, vector
from coilspring.scene import Scene
from coilspring.sizing import axial_rate

FIXED = 1e12  # axial rates of the spring


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
    fixed: np.ndarray  # (1,) stiffness that holds y where it is prescribed, N/mm; 0 where it is not


@part
def drive(reals, ints, state, g, H):
    """Add what acts on the top to the gradient, and to the matrix unless it is empty; returns its energy."""
    head = heads(ints)
    last = len(head)
    place, rest = vector(ints, head[last - 4]), vector(reals, head[last - 3])
    force, fixed = vector(reals, head[last - 2]), reals[head[last - 1, 0]]
    energy = 0.0
    for i in range(2):
        energy -= force[i] * (state[place[i]] - rest[i])
        g[place[2 + i]] -= force[i]
    if fixed > 0.0:
        g[place[3]] = 0.0
        if H.size > 0:
            H[place[4]] += fixed
    return energy


@part
def rests(reals, ints, b):
    """Freedom of y where it is prescribed and the right-hand side `b` has nothing along it, else -1."""
    head = heads(ints)
    last = len(head)
    y = vector(ints, head[last - 4])[3]
    return y if reals[head[last - 1, 0]] > 0.0 and b[y] == 0.0 else -1


class Stage(NamedTuple):
    """A stage as the follower takes it."""

    drive: Drive
    load: np.ndarray  # (2,) that grows in it, N, on x and y of the top
    prescribed: np.ndarray  # (2,) place of y in the state and its change, mm; empty where loads are forces


def stages(scene: Scene, top: Top) -> Iterator[Stage]:
    """The stages of a scene's load."""
    fixed = FIXED * axial_rate(scene) if scene.load.displacement else 0.0
    held = [name in scene.supports.top_held for name in ("ux", "uy")]
    place = np.array([*top.state, *top.freedom, top.diagonal])
    rest = np.array([0.0, scene.spring.active_height])
    for before, after in pairwise(stage_ends(scene.load)):
        if fixed > 0.0:
            drive = Drive(place, rest, np.zeros(2), np.array([fixed]))
            change = (after - before)[1]
            yield Stage(drive, np.array([0.0, fixed * change]), np.array([top.state[1], change]))
            continue
        dead, growing = (np.where(held, 0.0, force) for force in (before, after - before))
        yield Stage(Drive(place, rest, dead, np.zeros(1)), growing, np.zeros(0))


def reactions(
    assemble: Callable, data: tuple, size: int, freedom: int, states: np.ndarray, memories: np.ndarray
) -> np.ndarray:
    """Internal force along a freedom in states found with contact memories, shape (states,), N.

    Parameters
    ----------
    assemble : the model's kernel, in which the freedom is free and no load acts.
    data : the model's arrays.
    size : number of its freedoms.
    """
    packed, empty, out = pack(data), np.empty(0), np.empty(len(states))
    for row, (state, memory) in enumerate(zip(states, memories, strict=True)):
        g = np.empty(size)
        assemble(*packed, state, 0.0, memory, state, g, empty)
        out[row] = g[freedom]
    return out
