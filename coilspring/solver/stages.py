"""Stages of a load history: what is there when a stage begins, and what grows in it.

A stage begins with the dead load p of the last one, and adds its own in proportion to time.

A prescribed displacement is a constraint: y moves with time, whatever the spring does, and equilibrium is
asked of all other degrees of freedom. So its gradient is zero, and its stiffness in the matrix is so large
that pivots are those of the constrained spring. Newton's steps leave y as it is, and solving for that
stiffness times dY/dt along y gives the tangent of the constrained path.
"""

from collections.abc import Callable, Iterator
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from coilspring.compiling.packing import pack
from coilspring.scene import Scene
from coilspring.scene.load import stage_ends
from coilspring.scene.sizing import axial_rate
from coilspring.solver.system import FREE

PRESCRIBED = 1e12  # axial rates of the spring: stiffness of what is prescribed


class Top(NamedTuple):
    """Where a model keeps x and y of the top reference point."""

    state: tuple[int, int]  # in the state
    dof: tuple[int, int]  # in the gradient
    diagonal: int  # entry of y with itself in the matrix


class Stage(NamedTuple):
    """A stage as the follower takes it: on x and y of the top, N."""

    dead: np.ndarray  # (2,) load from its beginning
    growing: np.ndarray  # (2,)
    prescribed: np.ndarray  # see `coilspring.solver.system`; empty where loads are forces


def prescribed_stage(top: Top, change: float, rate: float) -> Stage:
    """A stage in which y of the top changes in proportion to time, mm; `rate` is the axial one, N/mm."""
    stiffness = PRESCRIBED * rate
    prescribed = np.array([top.state[1], top.dof[1], top.diagonal, stiffness, change])
    return Stage(np.zeros(2), np.array([0.0, stiffness * change]), prescribed)


def stages(scene: Scene, top: Top) -> Iterator[Stage]:
    """The stages of a scene's load."""
    held = [name in scene.supports.top_held for name in ("ux", "uy")]
    for before, after in pairwise(stage_ends(scene.load)):
        if scene.load.displacement:
            yield prescribed_stage(top, (after - before)[1], axial_rate(scene))
        else:
            dead, growing = (np.where(held, 0.0, force) for force in (before, after - before))
            yield Stage(dead, growing, FREE)


def rates(
    compiled: tuple[Callable, Callable, Callable],
    data: tuple,
    sizes: tuple[int, int],
    x: int,
    states: np.ndarray,
    histories: np.ndarray,
    directions: np.ndarray,
) -> np.ndarray:
    """Tangent stiffness of the top along directions in states found with contact histories, (states,), N/mm.

    It is the force over the deflection in that direction, where no other force changes: 1 / (d . H^-1 d).

    Parameters
    ----------
    compiled : the model's kernels `assemble`, `factor` and `solve`; no load acts, and nothing is prescribed.
    data : the model's arrays.
    sizes : number of its degrees of freedom, and length of its matrix.
    x : the first of the top's two degrees of freedom x and y.
    directions : (states, 2) of length 1.
    """
    assemble, factor, solve = compiled
    packed, out, top = pack(data), np.empty(len(states)), slice(x, x + 2)
    for row, (state, history, direction) in enumerate(zip(states, histories, directions, strict=True)):
        move, F = map(np.empty, sizes)
        assemble(*packed, state, 0.0, history, state, move, F)
        factor(*packed, F)
        move[:] = 0.0
        move[top] = direction
        solve(*packed, F, move)
        out[row] = 1.0 / (direction @ move[top])
    return out


def reactions(
    assemble: Callable, data: tuple, size: int, x: int, states: np.ndarray, histories: np.ndarray
) -> np.ndarray:
    """Forces that hold the top along X and Y in states found with contact histories, shape (states, 2), N.

    Parameters
    ----------
    assemble : the model's kernel, in which both are free and no load acts.
    data : the model's arrays.
    size : number of its degrees of freedom.
    x : the first of the top's two degrees of freedom x and y.
    """
    packed, empty, out = pack(data), np.empty(0), np.empty((len(states), 2))
    for row, (state, history) in enumerate(zip(states, histories, strict=True)):
        g = np.empty(size)
        assemble(*packed, state, 0.0, history, state, g, empty)
        out[row] = g[x : x + 2]
    return out
