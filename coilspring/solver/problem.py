"""What a model hands to the path follower, and what comes back."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from coilspring.contact.law import NO_PAIRS, PairLaw
from coilspring.solver.stages import Top
from coilspring.solver.system import FREE


@dataclass(frozen=True)
class Problem:
    """A scene made ready by a model for the path follower.

    Attributes
    ----------
    data : the model's arrays (NamedTuple).
    load : (n,) load vector at time 1 in the model's free degrees of freedom.
    start : state at rest.
    span : largest coordinate of a node there, mm, whose rounding is that of positions.
    history : (pairs,) contact history at rest.
    matrix_size : length of the model's matrix in its own storage.
    law : of the contact pairs.
    dofs_per_node : displacements, and rotations, of each node.
    modified : the matrix is costly: see `coilspring.solver.system.Task`.
    top : where the top reference point is in the state; for loads of several stages.
    dead : (n,) load that acts from the beginning, or None.
    prescribed : see `coilspring.solver.system`.
    extended : gives the problem with the pairs that touch in a state besides its own, which come last.
    """

    data: Any
    load: np.ndarray
    start: np.ndarray
    span: float
    history: np.ndarray
    matrix_size: int
    law: PairLaw = NO_PAIRS
    dofs_per_node: tuple[int, int] = (3, 3)
    modified: bool = False
    top: Top | None = None
    dead: np.ndarray | None = None
    prescribed: np.ndarray = field(default_factory=lambda: FREE)
    extended: Callable[[np.ndarray], Problem] | None = None


@dataclass(frozen=True)
class Track:
    """What was followed, as the solver left it."""

    states: np.ndarray  # (reached, state size), at the requested times
    histories: np.ndarray  # (reached, pairs) contact history with which they were found
    iterations: np.ndarray  # (reached,), factorisations since the previous row
    least_gaps: np.ndarray  # (reached,) least gap of the contact pairs, mm; infinite where there are none
    rest: int  # factorisations spent after the last row
    outcome: int
    time: float  # last accepted time
    bracket: float  # time beyond it, in which the path ends
    checks: int  # factorisations that only verified the stability of a linear stretch
    pairs: int  # contact pairs evaluated
    last: np.ndarray  # last accepted state
    history: np.ndarray  # contact history with which a step from there was tried
    decrements: np.ndarray  # last Newton decrements over the reference work
    far: bool  # beyond its end a snap found an equilibrium, but too far away
    bifurcates: bool  # towards its end the stiffness falls to zero in proportion, by a mode of no work
    snaps: int  # limit points passed, see `coilspring.solver.continuation.snap`,
    largest_snap: float  # and bound on the largest motion at one of them, wire diameters
    undecided: float  # time from which on grazing pairs could hold other forces, or infinite
