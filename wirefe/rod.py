"""Any wire: a chain of straight or curved elements, held and under dead loads, and its equilibrium path."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from typing import Any, Protocol

import numpy as np

from coilspring.errors import InputError, require_choice, require_integer, require_number
from coilspring.scene.load import MOST_FORCE
from coilspring.scene.wire import Section
from coilspring.words import shown
from wirefe.element.beam import deformations
from wirefe.element.curved import (
    POINTS,
    UPTO,
    WEIGHTS,
    constant_strain_twists,
    second_order,
)
from wirefe.element.poses import ROW, at_rest
from wirefe.element.rotations import cross_rows, quaternion_from_matrix

FREEDOMS = ("ux", "uy", "uz", "rotx", "roty", "rotz")
# Of a wire whose flexibility varies: at parameters of its curve, (n, 6, 6) in Frenet's axes there.
Flexibility = Callable[[np.ndarray], np.ndarray]
ELEMENTS = ("straight", "curved")
KINK = 1e-13  # of the largest parameter, well above its rounding: how far inside its ends an element begins


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
    stiffness : (nodes - 1, 6, 6) of the elements at rest, see `wirefe.element.beam`.
    held : (nodes, 6) dofs that are held.
    loads : (nodes, 6) dead forces and moments at time 1. Moments keep their direction in space; in
        space (not in a plane) such a load has no potential, and the matrix is the symmetric part of the
        tangent: equilibria are right, but may not be found, and nothing is said of their stability.
    second : (nodes - 1, 6, 36) second derivatives of the elements' deformation in the amplitudes of strains,
        see `wirefe.element.curved`; (0, 6, 36) of straight ones.
    """

    points: np.ndarray
    triads: np.ndarray
    stiffness: np.ndarray
    held: np.ndarray
    loads: np.ndarray
    second: np.ndarray = field(default_factory=lambda: np.zeros((0, 6, 36)))

    @property
    def strain0(self) -> np.ndarray:
        """Deformation measures of the elements at rest, (nodes - 1, 6): first tangents times lengths."""
        found = np.empty((len(self.triads), 6))
        deformations(at_rest(self.points).ravel(), np.zeros(3), self.triads, found)
        return found

    @property
    def twisted(self) -> int | None:
        """The first node with a moment that has no potential, since it may turn about more than one axis."""
        free = ~self.held[:, 3:]
        found = np.flatnonzero((self.loads[:, 3:] * free).any(axis=1) & (free.sum(axis=1) > 1))
        return int(found[0]) if found.size else None

    @property
    def stands(self) -> bool:
        """Whether what is held leaves no rigid motion."""
        x = (self.points - self.points.mean(axis=0)) / np.ptp(self.points, axis=0).max()
        motions = np.zeros((*self.held.shape, 6))  # of each dof by a unit of each rigid motion
        motions[:, range(6), range(6)] = 1.0
        motions[:, :3, 3:] = np.cross(np.eye(3), x[:, None]).swapaxes(1, 2)
        return bool(np.linalg.matrix_rank(motions[self.held]) == 6)

    def holding(self, node: int, *dofs: str) -> Rod:
        """With dofs of a node held; all six where none is named.

        Raises
        ------
        InputError : a name that is not one of ux, uy, uz, rotx, roty, rotz; a node that is not there.
        """
        held, node = self.held.copy(), self._node(node)
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
        """With a dead force and moment added at a node.

        Raises
        ------
        InputError : a node that is not there; loads that are not three finite numbers each.
        """
        loads, node = self.loads.copy(), self._node(node)
        for name, part, given in (("force", slice(3), force), ("moment", slice(3, 6), moment)):
            if np.shape(given) != (3,):
                raise InputError(f"{name} must be three numbers, got {shown(given)}")
            loads[node, part] += [require_number(name, value, -MOST_FORCE, MOST_FORCE) for value in given]
        return replace(self, loads=loads)

    def _node(self, node: int) -> int:
        """The number of a node; negative ones count from the end."""
        return require_integer("node", node, -len(self.points), len(self.points) - 1)


def straight_rod(points: np.ndarray, section: Section) -> Rod:
    """Straight elements between points, shape (nodes, 3); rigid joints where they meet at an angle."""
    points = _checked(points)
    _require_section(section)
    t, lengths = _chords(points)
    # The section is round: any second axis will do, here the one across the tangent and the coordinate axis
    # that is least along it.
    second = np.cross(np.eye(3)[np.abs(t).argmin(axis=1)], t)
    second /= np.linalg.norm(second, axis=1)[:, None]
    triads = quaternion_from_matrix(np.stack((t, second, np.cross(t, second)), axis=-1))
    return _rod(points, np.stack((triads, triads), axis=1), straight_stiffness(section, lengths))


def straight_solid_rod(points: np.ndarray, flexibility: np.ndarray, inward: np.ndarray) -> Rod:
    """Straight elements of a wire that is not the same in all directions of its section.

    Parameters
    ----------
    flexibility : (elements, 6, 6) of the wire per length, in Frenet's axes.
    inward : (elements, 3) across the wire towards the centre of curvature.
    """
    points = _checked(points)
    t, lengths = _chords(points)
    b = np.cross(t, inward)
    b /= np.linalg.norm(b, axis=1)[:, None]
    triads = quaternion_from_matrix(np.stack((t, np.cross(b, t), b), axis=-1))
    bent = flexibility.copy()
    for shear, moment in ((1, 5), (2, 4)):
        bent[:, shear, shear] += lengths**2 / 12.0 * flexibility[:, moment, moment]
    return _rod(points, np.stack((triads, triads), axis=1), np.linalg.inv(lengths[:, None, None] * bent))


def curved_rod(curve: Curve, parameters: np.ndarray, section: Section | Flexibility) -> Rod:
    """Elements of the curve's pieces between the parameters, exact to the second order in their end loads.

    Their triads are Frenet's, in which a uniform helix is a constant strain: the deformation of a spring into
    another helix is then represented exactly. Elements of more than half a turn are inexact, by 3e-4 of the
    second order at a whole one. Instead of a section, a function of parameters gives the wire's
    flexibility per length there, (n, 6, 6) in Frenet's axes.
    """
    phases = _numbers("parameters", parameters)
    if phases.ndim != 1 or len(phases) < 2 or not (np.diff(phases) > 0.0).all():
        raise InputError(f"parameters must be 2 or more rising numbers, got {shown(parameters)}")
    if not callable(section):
        _require_section(section)
    points = _checked(curve.points(phases))
    # at each end from within the element: the curve may have kinks between elements
    inset = KINK * np.abs(phases).max()
    frames = frenet_frames(curve, np.stack((phases[:-1] + inset, phases[1:] - inset), axis=1).ravel())
    triads = quaternion_from_matrix(frames).reshape(-1, 2, 4)
    flexibility, lengths = section_flexibility(curve, section, phases, points)
    rod = _rod(points, triads, np.zeros((len(triads), 6, 6)))
    constant = np.empty_like(flexibility)
    constant_strain_twists(triads, rod.strain0, POINTS, WEIGHTS, UPTO, constant)
    motion = np.tensordot(WEIGHTS, constant, (0, 1))  # of the second end, by a unit of each deformation
    wrench = np.linalg.solve(np.einsum("eq,eqij->eij", lengths, flexibility), motion)
    K = np.swapaxes(motion, 1, 2) @ wrench
    Q, inverse = np.empty((len(triads), 6, 36)), np.linalg.inv(motion)
    second_order(flexibility @ wrench[:, None], lengths, constant, WEIGHTS, UPTO, inverse, Q)
    return replace(rod, stiffness=0.5 * (K + np.swapaxes(K, 1, 2)), second=Q)


def _require_section(section: object) -> None:
    """Refuse what is no section, or one that resists nothing."""
    if not isinstance(section, Section):
        raise InputError(f"section must be a coilspring.scene.wire.Section, got {shown(section)}")
    for name in ("EA", "GA", "GJ", "EI"):
        values = _numbers(f"section.{name}", getattr(section, name))
        if not (np.isfinite(values).all() and (values > 0.0).all()):
            raise InputError(
                f"section.{name} must be finite and above 0, got {shown(getattr(section, name))}"
            )


def _rod(points: np.ndarray, triads: np.ndarray, stiffness: np.ndarray) -> Rod:
    nodes = len(points)
    return Rod(points, triads, stiffness, np.zeros((nodes, 6), dtype=bool), np.zeros((nodes, 6)))


def _checked(points: np.ndarray) -> np.ndarray:
    points = _numbers("points", points)
    if points.ndim != 2 or points.shape[1] != 3 or len(points) < 2 or not np.isfinite(points).all():
        raise InputError(f"points must be finite, of shape (2 or more, 3), got shape {points.shape}")
    if (np.linalg.norm(np.diff(points, axis=0), axis=1) == 0.0).any():
        raise InputError("points must differ from their neighbours, got two in one place")
    return points


def _numbers(name: str, given: object) -> np.ndarray:
    """An array of numbers; `InputError` for what is none."""
    try:
        return np.asarray(given, dtype=float)
    except (TypeError, ValueError) as error:
        raise InputError(f"{name} must be numbers, got {shown(given)}") from error


def _chords(points: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Unit vectors between points, and their distances."""
    chords = np.diff(points, axis=0)
    lengths = np.linalg.norm(chords, axis=1)
    return chords / lengths[:, None], lengths


def straight_stiffness(section: Section, lengths: np.ndarray) -> np.ndarray:
    """Stiffness of straight elements in (v, theta), shape (elements, 6, 6).

    Shear carries the bending flexibility L^2/(12 EI) that constant strains leave out, which makes
    the element exact for small loads at its ends (MacNeal 1978, residual bending flexibility).
    """
    K = np.zeros((len(lengths), 6, 6))
    shear = 1.0 / (1.0 / section.GA + lengths**2 / (12.0 * section.EI))
    for i, rigidity in enumerate((section.EA, shear, shear, section.GJ, section.EI, section.EI)):
        K[:, i, i] = rigidity / lengths
    return K


def section_flexibility(
    curve: Curve, section: Section | Flexibility, phases: np.ndarray, points: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Motion (dx, spin) of each element's second end by a wrench there, for a length of the wire at each of
    its `POINTS`, (elements, points, 6, 6), and the lengths that these stand for, (elements, points)."""
    steps = np.diff(phases)[:, None]
    at = phases[:-1, None] + steps * POINTS
    first, _ = curve.derivatives(at.ravel())
    speed = np.linalg.norm(first, axis=1)
    lengths = steps * WEIGHTS * speed.reshape(at.shape)
    # a section carries the force n and the moment m + r x n, with r from it to the second end
    r = points[1:, None] - curve.points(at.ravel()).reshape(*at.shape, 3)
    R = cross_rows(np.eye(3), r[..., None, :])  # R x = r x x
    F = np.empty((*at.shape, 6, 6))
    if isinstance(section, Section):
        t = (first / speed[:, None]).reshape(*at.shape, 3)
        tt = t[..., :, None] * t[..., None, :]
        stretch = np.eye(3) / section.GA + (1.0 / section.EA - 1.0 / section.GA) * tt
        bend = np.eye(3) / section.EI + (1.0 / section.GJ - 1.0 / section.EI) * tt
        mutual = np.float64(0.0)
    else:
        axes = frenet_frames(curve, at.ravel()).reshape(*at.shape, 3, 3)
        back, local = np.swapaxes(axes, -1, -2), section(at.ravel()).reshape(F.shape)
        stretch, mutual, bend = (
            axes @ local[..., i : i + 3, j : j + 3] @ back for i, j in ((0, 0), (0, 3), (3, 3))
        )
    F[..., :3, 3:] = mutual - R @ bend
    F[..., 3:, :3] = np.swapaxes(F[..., :3, 3:], -1, -2)
    if mutual.ndim:
        stretch = stretch + mutual @ R
    F[..., :3, :3] = stretch - R @ F[..., 3:, :3]
    F[..., 3:, 3:] = bend
    return F, lengths


def frenet_frames(curve: Curve, phases: np.ndarray) -> np.ndarray:
    """Tangent, normal and binormal as columns, shape (len(phases), 3, 3)."""
    first, second = curve.derivatives(phases)
    b = cross_rows(first, second)
    if not b.any(axis=1).all():
        raise InputError("curve must be curved everywhere: a straight one has no normal; use straight_rod")
    t = first / np.linalg.norm(first, axis=1)[:, None]
    b /= np.linalg.norm(b, axis=1)[:, None]
    return np.stack((t, cross_rows(b, t), b), axis=-1)


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
        rows = states.reshape(len(states), len(rod.points), ROW)
        return cls(rod=rod, positions=rows[:, :, :3], rotations=rows[:, :, 3:], **fields)

    def doubted(self) -> RodPath:
        """The path, with what a moment without a potential leaves open: whether it is stable, and where it
        ends before time 1, whether there is an equilibrium beyond."""
        node = self.rod.twisted
        if node is None:
            return self
        why = (
            f"the moment on node {node}, which may turn about more than one axis, has no potential, and the "
            "matrix is the symmetric part of the tangent"
        )
        if self.outcome == "completed":
            return replace(self, message=f"{self.message}; whether it is stable is not known: {why}")
        last = f"{self.times[-1]:.6g}" if len(self.times) else "0"
        message = (
            f"no equilibrium was found beyond time {last}, though there may be one: {why}; a wire that stays "
            "in a plane is followed with in_plane()"
        )
        return replace(self, outcome="not_converged", message=message, critical_time=None)

    def displacements(self, node: int) -> np.ndarray:
        """Displacement of a node at the times reached, shape (steps, 3)."""
        return self.positions[:, node] - self.rod.points[node]
