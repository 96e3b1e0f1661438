"""Any wire: a chain of beam elements with held dofs and dead loads, and its equilibrium path."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any, Protocol

import numpy as np

from coilspring.errors import InputError, require_choice
from coilspring.scene.wire import Section
from wirefe.element.beam import deformations
from wirefe.element.poses import at_rest
from wirefe.element.rest import Flexibility, curved_elements, straight_elements, straight_solid_elements

FREEDOMS = ("ux", "uy", "uz", "rotx", "roty", "rotz")


class Curve(Protocol):
    """A smooth centreline; a `coilspring.Spring` is one."""

    def points(self, phi: np.ndarray) -> np.ndarray:
        """Points at the parameters `phi`, shape (len(phi), 3)."""

    def derivatives(self, phi: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """First and second derivative in `phi`, each (len(phi), 3); the curvature nowhere zero."""


@dataclass(frozen=True)
class Rod:
    """A wire at rest, what holds it and what loads it.

    Made by `straight_rod` or `curved_rod`; `holding` and `loaded` return changed copies.

    Attributes
    ----------
    points : (nodes, 3) at rest.
    triads : (nodes - 1, 2, 4) end frames of the elements, unit quaternions.
    stiffness : (nodes - 1, 6, 6) of the elements in (v, theta), see `wirefe.element.beam`.
    held : (nodes, 6) dofs that are held.
    loads : (nodes, 6) dead forces and moments at time 1. Moments keep their direction in space; in
        space (not in a plane) such a load has no potential: equilibria are right, statements on
        stability rest on the symmetric part of the tangent.
    """

    points: np.ndarray
    triads: np.ndarray
    stiffness: np.ndarray
    held: np.ndarray
    loads: np.ndarray

    @property
    def strain0(self) -> np.ndarray:
        """Deformation measures of the elements at rest, (nodes - 1, 6): first tangents times lengths."""
        found = np.empty((len(self.triads), 6))
        deformations(at_rest(self.points).ravel(), np.zeros(3), self.triads, found)
        return found

    def holding(self, node: int, *dofs: str) -> Rod:
        """With dofs of a node held; all six where none is named.

        Raises
        ------
        InputError : a name that is not one of ux, uy, uz, rotx, roty, rotz.
        """
        held = self.held.copy()
        for name in dofs or FREEDOMS:
            held[node, FREEDOMS.index(require_choice("dofs", name, FREEDOMS))] = True
        return replace(self, held=held)

    def in_plane(self) -> Rod:
        """Held in the X-Y plane at every node (UZ, ROTX, ROTY)."""
        held = self.held.copy()
        held[:, 2:5] = True
        return replace(self, held=held)

    def loaded(
        self,
        node: int,
        force: tuple[float, float, float] = (0.0, 0.0, 0.0),
        moment: tuple[float, float, float] = (0.0, 0.0, 0.0),
    ) -> Rod:
        """With a dead force and moment added at a node."""
        loads = self.loads.copy()
        loads[node] += (*force, *moment)
        return replace(self, loads=loads)


def straight_rod(points: np.ndarray, section: Section) -> Rod:
    """Straight elements between points, shape (nodes, 3); rigid joints where they meet at an angle."""
    points = _checked(points)
    return _rod(points, *straight_elements(points, section))


def straight_solid_rod(points: np.ndarray, flexibility: np.ndarray, inward: np.ndarray) -> Rod:
    """Straight elements of a wire that is not the same in all directions of its section.

    Parameters
    ----------
    flexibility : (elements, 6, 6) of the wire per length, in Frenet's axes.
    inward : (elements, 3) towards the centre of curvature.
    """
    points = _checked(points)
    return _rod(points, *straight_solid_elements(points, flexibility, inward))


def curved_rod(curve: Curve, parameters: np.ndarray, section: Section | Flexibility) -> Rod:
    """Elements with the exact linear flexibility of the curve's pieces between the parameters.

    Instead of a section, a function of parameters gives the wire's flexibility per length there, (n, 6, 6)
    in Frenet's axes.
    """
    parameters = np.asarray(parameters, dtype=float)
    points = _checked(curve.points(parameters))
    return _rod(points, *curved_elements(curve, section, parameters))


def _rod(points: np.ndarray, triads: np.ndarray, stiffness: np.ndarray) -> Rod:
    nodes = len(points)
    return Rod(points, triads, stiffness, np.zeros((nodes, 6), dtype=bool), np.zeros((nodes, 6)))


def _checked(points: np.ndarray) -> np.ndarray:
    points = np.asarray(points, dtype=float)
    if points.ndim != 2 or points.shape[1] != 3 or len(points) < 2 or not np.isfinite(points).all():
        raise InputError(f"points must be finite, of shape (2 or more, 3), got shape {points.shape}")
    if (np.linalg.norm(np.diff(points, axis=0), axis=1) == 0.0).any():
        raise InputError("points must differ from their neighbours, got two in one place")
    return points


@dataclass(frozen=True)
class RodPath:
    """Equilibria of a rod at the requested times, as far as they were reached.

    Attributes
    ----------
    rod : what was solved.
    times : (steps,) times reached.
    positions : (steps, nodes, 3).
    rotations : (steps, nodes, 4) of the nodes from rest, unit quaternions (w, x, y, z).
    iterations : (steps,) factorisations since the previous row.
    outcome, message, critical_time : as in `coilspring.EquilibriumPath`.
    residual_history : last Newton decrements over the reference work.
    solve_seconds : CPU time of the solve alone.
    negative_pivots : (steps,) of traced paths: 0 where the equilibrium is stable.
    """

    rod: Rod
    times: np.ndarray
    positions: np.ndarray
    rotations: np.ndarray
    iterations: np.ndarray
    outcome: str
    message: str
    critical_time: float | None
    residual_history: tuple[float, ...]
    solve_seconds: float
    negative_pivots: np.ndarray | None = None

    @classmethod
    def of(cls, rod: Rod, states: np.ndarray, **fields: Any) -> RodPath:
        """Path from the model's states, shape (steps, n), and the other fields."""
        rows = states.reshape(len(states), len(rod.points), -1)
        return cls(rod=rod, positions=rows[:, :, :3], rotations=rows[:, :, 3:], **fields)

    def displacements(self, node: int) -> np.ndarray:
        """Displacement of a node at the times reached, shape (steps, 3)."""
        return self.positions[:, node] - self.rod.points[node]
