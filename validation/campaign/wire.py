"""Forces in the wire model's states in plain numpy, for the verifier: shares nothing with the solver.

Written from docs/theory.md, section 3, with quaternions (scalar first), complex steps of the energy, and
central differences of the forces.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.linalg import cho_solve_banded, cholesky_banded, eigh, lu_factor, lu_solve
from scipy.sparse import csr_array
from scipy.sparse.linalg import LinearOperator, eigs, eigsh

from coilspring import EquilibriumPath, Scene
from validation.campaign.poses import TINY, differences, product, rotated, strain
from validation.campaign.wirepairs import Law, Pairs, known_pairs
from validation.campaign.wireparts import Points, curved, end_frames, helix, spheres, stations, straight

PAIRS_A_TURN = 4  # that the scene's stiffness belongs to
SETTLED = 1e-8  # of an eigenvalue


@dataclass(frozen=True)
class WireForces:
    """A scene's wire: elements and contact.

    Attributes
    ----------
    rest : (nodes, 7) positions and quaternions at rest.
    frames : (4, 2, elements) quaternions of the end triads at rest.
    arm : (3,) from the top reference point to the wire's last point, at rest.
    stiffness, strain0 : (6, 6, elements) and (6, elements).
    points, law : of the contact; no law where there is none.
    d : diameter of the wire.
    fixed : (nodes, 6) degrees of freedom, where nothing must balance.
    driven : a displacement of the top is prescribed.
    """

    rest: np.ndarray
    frames: np.ndarray
    arm: np.ndarray
    stiffness: np.ndarray
    strain0: np.ndarray
    points: Points
    law: Law | None
    d: float
    fixed: np.ndarray
    driven: bool

    def residual(self, state: np.ndarray, load: np.ndarray, pairs: Pairs | None) -> np.ndarray:
        """Force and moment (nodes, 6) that are out of balance under a load, or the reaction to a prescribed
        displacement."""
        total = self.forces(state.reshape(-1, 7), pairs)
        total[-1, :2] -= load
        return np.where(self.fixed, 0.0, total)

    def forces(self, rows: np.ndarray, pairs: Pairs | None) -> np.ndarray:
        """Forces and moments (nodes, 6) of the elements and the contact, those of the supports included."""
        total = self.element_forces(rows)
        return total if pairs is None else total + pairs.gradient(rows)

    def element_forces(self, rows: np.ndarray) -> np.ndarray:
        """Gradient (nodes, 6) of the strain energy in displacements and spins."""
        x, q = rows[:, :3].T.copy(), rows[:, 3:].T
        x[:, -1] += rotated(q[:, -1], self.arm)
        ends = np.stack((np.arange(x.shape[1] - 1), np.arange(1, x.shape[1])))
        shift = 1j * TINY * np.eye(12)[..., None]
        poses = []
        for end in range(2):
            move, spin = np.split(shift[6 * end : 6 * end + 6], 2)
            turned = product(np.concatenate((np.ones((1, 12, 1)), 0.5 * spin)), q[:, None, ends[end]])
            poses.append((x[:, None, ends[end]] + move, product(turned, self.frames[:, None, end])))
        e = strain(*poses) - self.strain0[:, None]
        energy = 0.5 * np.einsum("ike,ije,jke->ke", e, self.stiffness, e)
        parts = energy.imag.T / TINY
        total = np.zeros((len(rows), 6))
        np.add.at(total, ends[0], parts[:, :6])
        np.add.at(total, ends[1], parts[:, 6:])
        total[-1, 3:] += np.cross(rotated(q[:, -1], self.arm), total[-1, :3])
        return total

    def pairs(self, path: EquilibriumPath, row: int, reach: float = 0.0) -> Pairs | None:
        """Pairs that are held in a path's row or nearer than `reach`; None where there is no contact."""
        if self.law is None:
            return None
        found = known_pairs(self.points, self.law, self.rest, path, row)
        return found.of(found.held | (found.depth(path.states[row].reshape(-1, 7)) > -reach))

    def element_tangent(self, rows: np.ndarray) -> np.ndarray:
        """Derivative of the elements' forces in the moves and spins of all nodes; 1 where held."""
        nodes, held = len(rows), self.fixed.ravel()
        J: np.ndarray = np.zeros((nodes, 6, nodes, 6))
        # an element joins two nodes: every third may be moved at once
        thirds = [np.arange(first, nodes, 3) for first in range(3)]
        for some, i, change in differences(self.element_forces, rows, self.d, thirds):
            for node in np.atleast_1d(some):
                near = slice(max(node - 1, 0), node + 2)
                J[near, :, node, i] = change[near]
        J = J.reshape(held.size, held.size)
        J[held], J[:, held] = 0.0, 0.0
        J[held, held] = 1.0
        return J

    def tangent(self, rows: np.ndarray, pairs: Pairs | None) -> np.ndarray:
        """Derivative of all forces in the degrees of freedom that are free."""
        J = self.element_tangent(rows)
        if pairs is not None:
            J += pairs.tangent(rows)
        return J[np.ix_(self.free, self.free)]

    @property
    def free(self) -> np.ndarray:
        """Degrees of freedom that are neither held nor prescribed."""
        free = ~self.fixed
        free[-1, 1] &= not self.driven
        return np.flatnonzero(free)

    @cached_property
    def at_rest(self) -> np.ndarray:
        """Tangent at rest without contact, in units of which stiffness is measured."""
        J = self.tangent(self.rest, None)
        return 0.5 * (J + J.T)

    def least_stiffness(self, rows: np.ndarray, pairs: Pairs | None) -> float:
        """Eigenvalue of the tangent next to zero, in units of that at rest; negative where unstable.

        Where coils slide the tangent is not symmetric: it is unstable where the determinant is negative.
        """
        J, rest = self.tangent(rows, pairs), self.at_rest
        if pairs is None or not pairs.slides.any():
            J = 0.5 * (J + J.T)
            factor = _cholesky(J)
            if factor is None:
                return float(eigh(J, rest, subset_by_index=(0, 0), eigvals_only=True)[0])
            return _next_to_zero(lambda b: cho_solve_banded((factor, True), b), J, rest)
        lu, swaps = lu_factor(J)
        swapped = np.count_nonzero(swaps != np.arange(len(swaps)))
        sign = (-1.0) ** swapped * np.prod(np.sign(np.diag(lu)))
        return float(sign * abs(_next_to_zero(lambda b: lu_solve((lu, swaps), b), J, rest)))


def _cholesky(J: np.ndarray) -> np.ndarray | None:
    """Banded factor of a symmetric matrix, lower form; None where it is not positive definite."""
    low, high = np.nonzero(np.tril(J))
    band = int((low - high).max())
    stored = np.zeros((band + 1, len(J)))
    stored[low - high, high] = J[low, high]
    try:
        return cholesky_banded(stored, lower=True)
    except np.linalg.LinAlgError:
        return None


def _next_to_zero(solve: Callable[[np.ndarray], np.ndarray], J: np.ndarray, rest: np.ndarray) -> float:
    """Eigenvalue of a matrix next to zero, in units of that at rest, by Arnoldi's method on the inverse."""
    inverse = LinearOperator(J.shape, solve, dtype=float)
    known = {"k": 1, "M": csr_array(rest), "sigma": 0.0, "tol": SETTLED, "return_eigenvectors": False}
    start = np.random.default_rng(1).standard_normal(len(rest))
    find = eigsh if (J == J.T).all() else eigs
    return float(find(csr_array(J), OPinv=inverse, v0=start, **known)[0].real)


def wire_forces(scene: Scene, element: str, elements_per_turn: int, pairs_per_turn: int) -> WireForces:
    """The scene's wire on a mesh."""
    spring, contact = scene.spring, scene.contact
    count = round(spring.active_coils * elements_per_turn)
    phases = np.linspace(0.0, 2.0 * math.pi * spring.active_coils, count + 1)
    points = helix(spring, phases)
    frames = end_frames(spring, phases, points, element == "curved")
    poses = ((points[:-1].T, frames[:, 0]), (points[1:].T, frames[:, 1]))
    reference = np.array([0.0, spring.active_height, 0.0])
    if contact.geometry == "wires":
        contact_points = stations(spring, points, reference, pairs_per_turn)
    else:
        contact_points = spheres(spring, points, reference, elements_per_turn, pairs_per_turn)
    penalty = contact.stiffness * PAIRS_A_TURN / pairs_per_turn
    law = Law(spring.wire_diameter, penalty, contact.exponent, contact.coefficient)
    fixed = np.zeros((count + 1, 6), dtype=bool)
    fixed[0] = True
    fixed[-1, 2:5] = True
    for name in scene.supports.top_held:
        fixed[-1, {"ux": 0, "rotz": 5}[name]] = True
    rest = np.zeros((count + 1, 7))
    rest[:, :3], rest[:, 3] = points, 1.0
    rest[-1, :3] = reference
    return WireForces(
        rest=rest,
        frames=frames,
        arm=points[-1] - reference,
        stiffness=curved(scene, phases, points, poses) if element == "curved" else straight(scene, points),
        strain0=strain(*poses),
        points=contact_points,
        law=law if contact.enabled else None,
        d=spring.wire_diameter,
        fixed=fixed,
        driven=bool(scene.load.displacement),
    )
