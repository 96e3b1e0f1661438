"""Forces in the wire model's states in plain numpy, for the verifier: shares nothing with the solver.

Written from docs/theory.md, section 3, with quaternions (scalar first), complex steps of the energy, and
central differences of the forces.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from scipy.linalg import eigh

from coilspring import EquilibriumPath, Scene
from validation.campaign.poses import TINY, carried, differences, product, rotated, strain
from validation.campaign.wireparts import curved, end_frames, helix, spheres, straight

PAIRS_A_TURN = 4  # that the scene's stiffness belongs to
Friction = tuple[np.ndarray, np.ndarray]  # pairs (pairs, 2) and forces (pairs, 3) on their lower spheres


@dataclass(frozen=True)
class WireForces:
    """A scene's wire: elements, spheres and load.

    Attributes
    ----------
    rest : (nodes, 7) positions and quaternions at rest.
    frames : (4, 2, elements) quaternions of the end triads at rest.
    arm : (3,) from the top reference point to the wire's last point, at rest.
    stiffness, strain0 : (6, 6, elements) and (6, elements).
    attached, offset : (spheres,) and (spheres, 3).
    near : spheres so near along the wire do not touch.
    d, penalty, exponent : of the contact.
    fixed : (nodes, 6) degrees of freedom, where nothing must balance.
    load : (2,) at time 1; 0 where a displacement is prescribed.
    """

    rest: np.ndarray
    frames: np.ndarray
    arm: np.ndarray
    stiffness: np.ndarray
    strain0: np.ndarray
    attached: np.ndarray
    offset: np.ndarray
    near: int
    d: float
    penalty: float
    exponent: float
    fixed: np.ndarray
    load: np.ndarray

    def residual(self, state: np.ndarray, load: np.ndarray, friction: Friction) -> np.ndarray:
        """Force and moment (nodes, 6) that are out of balance under a load, or the reaction to a prescribed
        displacement."""
        rows, (pairs, force) = state.reshape(-1, 7), friction
        total = self.element_forces(rows) + self.contact_forces(rows) + self.spread(rows, pairs, -force)
        total[-1, :2] -= load
        return np.where(self.fixed, 0.0, total)

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

    def contact_forces(self, rows: np.ndarray) -> np.ndarray:
        """Gradient (nodes, 6) of the energy of the pairs that touch."""
        return self.spread(rows, *self.touching(rows))

    def touching(self, rows: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Pairs of spheres that touch, and the gradient of their energy at the lower one."""
        if self.penalty == 0.0:
            return np.zeros((0, 2), int), np.zeros((0, 3))
        centres = self.centres(rows)
        low, high = np.triu_indices(len(centres), self.near + 1)
        g = centres[high] - centres[low]
        h = np.sqrt((g**2).sum(axis=1))
        hit = (h < self.d) & (self.attached[low] != self.attached[high])
        size = self.penalty * (self.d - h[hit]) ** self.exponent / h[hit]
        return np.stack((low[hit], high[hit]), axis=1), size[:, None] * g[hit]

    def centres(self, rows: np.ndarray) -> np.ndarray:
        """Centres (spheres, 3) of the contact spheres."""
        return carried(rows[self.attached], self.offset)

    def spread(self, rows: np.ndarray, pairs: np.ndarray, gradient: np.ndarray) -> np.ndarray:
        """Gradient (nodes, 6) from that at the lower spheres of pairs; at the upper ones it is opposite."""
        total = np.zeros((len(rows), 6))
        arms = self.centres(rows) - rows[self.attached, :3]
        for sphere, part in zip(pairs.T, (gradient, -gradient), strict=True):
            np.add.at(total, self.attached[sphere], np.hstack((part, np.cross(arms[sphere], part))))
        return total

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

    def tangent(self, rows: np.ndarray) -> np.ndarray:
        """Derivative of all forces without friction, made symmetric, which it is in balance."""
        J = self.element_tangent(rows)
        touched = np.unique(self.attached[self.touching(rows)[0]])
        for node, i, change in differences(self.contact_forces, rows, self.d, touched):
            J[:, 6 * node + i] += change.ravel()
        return 0.5 * (J + J.T)

    def least_stiffness(self, rows: np.ndarray) -> float:
        """Least eigenvalue of the tangent with the top held along the axis, in units of that at rest."""
        free = ~self.fixed
        free[-1, 1] = False
        some = np.ix_(free.ravel(), free.ravel())
        now, rest = self.tangent(rows)[some], self.tangent(self.rest)[some]
        return float(eigh(now, rest, subset_by_index=(0, 0), eigvals_only=True)[0])


def wire_forces(scene: Scene, element: str, elements_per_turn: int, pairs_per_turn: int) -> WireForces:
    """The scene's wire on a mesh."""
    spring, contact = scene.spring, scene.contact
    count = round(spring.active_coils * elements_per_turn)
    phases = np.linspace(0.0, 2.0 * math.pi * spring.active_coils, count + 1)
    points = helix(spring, phases)
    frames = end_frames(spring, phases, points, element == "curved")
    poses = ((points[:-1].T, frames[:, 0]), (points[1:].T, frames[:, 1]))
    reference = np.array([0.0, spring.active_height, 0.0])
    attached, offset = spheres(spring, points, reference, elements_per_turn, pairs_per_turn)
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
        attached=attached,
        offset=offset,
        near=pairs_per_turn // 2,
        d=spring.wire_diameter,
        penalty=contact.stiffness * PAIRS_A_TURN / pairs_per_turn if contact.enabled else 0.0,
        exponent=contact.exponent,
        fixed=fixed,
        load=np.array(scene.load.force),
    )


def friction_of(path: EquilibriumPath, row: int) -> Friction:
    """Pairs and tangential forces on their lower spheres, as the path reports them."""
    pairs = path.shape.data.contact.pairs  # type: ignore[attr-defined]
    if path.scene.contact.sliding == "free" or not len(pairs):
        return np.zeros((0, 2), int), np.zeros((0, 3))
    return pairs, path.friction.force[row]
