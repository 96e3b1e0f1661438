"""Forces in the wire model's states in plain numpy, for the verifier.

Written from docs/theory.md, section 3, without the solver's code, with quaternions (scalar first), complex
steps of the energy, and central differences of the forces. The pairs and what they remember are the path's.
"""

import math
from functools import cached_property

import numpy as np
from scipy.linalg import eigh, eigvals
from scipy.sparse import csc_array
from scipy.sparse.linalg import ArpackNoConvergence, LinearOperator, SuperLU, eigs, eigsh, splu

from coilspring import EquilibriumPath, Scene
from validation.campaign import poses
from validation.campaign.poses import TINY, like, product, rotated, strain
from validation.campaign.wirepairs import Law, Pairs, known_pairs
from validation.campaign.wireparts import Points, curved, end_frames, helix, straight

PAIRS_A_TURN = 4  # that the scene's stiffness belongs to
SETTLED = 1e-8  # of an eigenvalue


class WireForces:
    """A scene's wire on a mesh: elements and contact."""

    def __init__(self, scene: Scene, element: str, elements_per_turn: int, pairs_per_turn: int) -> None:
        spring, contact = scene.spring, scene.contact
        count = round(spring.active_coils * elements_per_turn)
        self.nodes = np.stack((np.arange(count), np.arange(1, count + 1)))  # (2, elements)
        phases = np.linspace(0.0, 2.0 * math.pi * spring.active_coils, count + 1)
        points = helix(spring, phases)
        reference = np.array([0.0, spring.active_height, 0.0])
        self.rest = np.zeros((count + 1, 7))  # positions and quaternions
        self.rest[:, :3], self.rest[:, 3] = points, 1.0
        self.rest[-1, :3] = reference
        # (4, 2, elements) quaternions of the end triads at rest
        self.frames = end_frames(spring, phases, points, element == "curved")
        # (2, 3, elements) from nodes to ends: from the top reference point, else zero
        self.arms = np.zeros((2, 3, count))
        self.arms[1, :, -1] = points[-1] - reference
        ends = ((points[:-1].T, self.frames[:, 0]), (points[1:].T, self.frames[:, 1]))
        self.strain0 = strain(*ends)
        # (6, 6, elements) in eta, and second derivatives of (v, theta) in eta
        self.stiffness: np.ndarray
        self.second: np.ndarray | None
        self.stiffness, self.second = (
            curved(scene, phases, points, ends) if element == "curved" else (straight(scene, points), None)
        )
        self.points = Points(spring, points, pairs_per_turn, contact.geometry == "wires")
        penalty = contact.stiffness * PAIRS_A_TURN / pairs_per_turn
        self.law = Law(spring.wire_diameter, penalty, contact.exponent, contact.coefficient)
        self.enabled = contact.enabled
        fixed = np.zeros((count + 1, 6), dtype=bool)
        fixed[0] = fixed[-1, 2:5] = True
        for name in scene.supports.top_held:
            fixed[-1, {"ux": 0, "rotz": 5}[name]] = True
        self.fixed = fixed.copy()  # degrees of freedom where nothing must balance
        fixed[-1, 1] |= bool(scene.load.displacement)
        self.free = np.flatnonzero(~fixed)  # those that are neither held nor prescribed

    def residual(self, rows: np.ndarray, load: np.ndarray, pairs: Pairs, guided: bool = False) -> np.ndarray:
        """Force and moment (nodes, 6) that are out of balance under a load or a reaction: where `guided`, of
        all that holds the top, UX too."""
        total = self.element_forces(rows) + pairs.gradient(rows)
        total[-1, :2] -= load
        left = np.where(self.fixed, 0.0, total)
        if guided:
            left[-1, 0] = total[-1, 0]
        return left

    def element_forces(self, rows: np.ndarray) -> np.ndarray:
        """Gradient (nodes, 6) of the strain energy in displacements and spins."""
        return poses.summed(self.nodes, self._slopes(rows[self.nodes]), len(rows))

    def _slopes(self, near: np.ndarray) -> np.ndarray:
        """Derivatives (12, ..., elements) of their energies in the moves and spins of their nodes."""
        slots = zip(poses.stepped(near), self.arms, self.frames.swapaxes(0, 1), strict=True)
        ends = [(x + rotated(q, like(x, arm)), product(q, like(x, frame))) for (x, q), arm, frame in slots]
        e = strain(*ends)
        e -= like(e, self.strain0)
        # of symmetric stiffness; what is real is the same in all steps
        here = e[:, 0].real
        if self.second is None:
            force = np.einsum("ije,j...e->i...e", self.stiffness, here)
        else:
            rates = np.einsum("ijke,k...e->ij...e", self.second, here)
            eta = here - 0.5 * (rates * here).sum(axis=1)
            force = np.einsum("ije,j...e->i...e", self.stiffness, eta)
            force -= (rates * force[:, None]).sum(axis=0)
        return np.einsum("i...,ik...->k...", force, e.imag) / TINY

    def pairs(self, path: EquilibriumPath, row: int, reach: float = 0.0) -> Pairs:
        """Pairs that are held in a path's row or nearer than `reach`; none where contact is not enabled."""
        found = known_pairs(self.points, self.law, self.rest, path, row)
        near = found.held | (found.depth(path.states[row].reshape(-1, 7)) > -reach)
        return found.of(near & self.enabled)

    def tangent(self, rows: np.ndarray, pairs: Pairs | None = None) -> np.ndarray:
        """Derivative of all forces in the degrees of freedom that are free; by default the elements'."""
        K = poses.differences(self._slopes, rows[self.nodes], self.law.d).swapaxes(0, 1)
        J = poses.assembled(self.nodes, K, len(rows))
        if pairs is not None and len(pairs.index):
            J += pairs.tangent(rows)
        return J[self.free][:, self.free]

    def correction(self, rows: np.ndarray, load: np.ndarray, pairs: Pairs) -> tuple[np.ndarray, float]:
        """Newton's move (nodes, 6) towards an equilibrium, and its size in wire diameters or rad."""
        move, left = np.zeros((len(rows), 6)), self.residual(rows, load, pairs)
        move.ravel()[self.free] = np.linalg.solve(self.tangent(rows, pairs), -left.ravel()[self.free])
        return move, float(np.abs(move / [*[self.law.d] * 3, 1.0, 1.0, 1.0]).max())

    @cached_property
    def at_rest(self) -> csc_array:
        """Tangent at rest without contact, in units of which stiffness is measured."""
        J = self.tangent(self.rest)
        return csc_array(0.5 * (J + J.T))

    def stiffness_of(self, path: EquilibriumPath, row: int = -1) -> float:
        """Least stiffness of a path's row."""
        rows = path.states[row].reshape(-1, 7)
        return self.least_stiffness(rows, self.pairs(path, row).renewed(rows))

    def least_stiffness(self, rows: np.ndarray, pairs: Pairs) -> float:
        """Eigenvalue of the tangent next to zero, in units of that at rest; negative where unstable.

        Where coils slide the tangent is not symmetric: it is unstable where the determinant is negative.
        """
        J, rest = self.tangent(rows, pairs), self.at_rest
        if pairs.slides.any():
            sign, find, factors = np.linalg.slogdet(J)[0], eigs, splu(csc_array(J))
        else:
            J, sign, find = 0.5 * (J + J.T), 1.0, eigsh
            factors = definite_factors(J)
            if factors is None:
                return float(eigh(J, rest.toarray(), subset_by_index=(0, 0), eigvals_only=True)[0])
        start = np.random.default_rng(1).standard_normal(len(J))
        solve = LinearOperator(J.shape, factors.solve, dtype=float)
        known = {"M": rest, "OPinv": solve, "v0": start, "tol": SETTLED, "return_eigenvectors": False}
        try:
            least = find(J, k=1, sigma=0.0, **known)[0].real
        except ArpackNoConvergence:  # two of nearly the same size
            least = np.abs(eigvals(J, rest.toarray())).min()
        return float(sign * abs(least))


def definite_factors(J: np.ndarray) -> SuperLU | None:
    """Factors L U of a symmetric matrix by pivots on its diagonal; None where one is not positive: then the
    matrix is not positive definite."""
    try:
        factors = splu(csc_array(J), "MMD_AT_PLUS_A", diag_pivot_thresh=0.0, options={"SymmetricMode": True})
    except RuntimeError:  # a pivot is zero
        return None
    diagonal = (factors.perm_r == factors.perm_c).all()
    return factors if diagonal and (factors.U.diagonal() > 0.0).all() else None
