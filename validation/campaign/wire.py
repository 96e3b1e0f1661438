"""Forces in the wire model's states in plain numpy, for the verifier: shares nothing with the solver.

Written from docs/theory.md, section 3, with quaternions (scalar first) and complex steps of the energy.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from coilspring import EquilibriumPath, Scene
from validation.campaign.poses import TINY, product, rotated, strain
from validation.campaign.wireparts import curved, end_frames, helix, spheres, straight

PAIRS_A_TURN = 4  # that the scene's stiffness belongs to


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
    fixed : (degrees of freedom,) of the nodes, where nothing must balance.
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

    def residual(
        self, state: np.ndarray, load: np.ndarray, friction: tuple[np.ndarray, np.ndarray]
    ) -> np.ndarray:
        """Force and moment (nodes, 6) that are out of balance under a load, or the reaction to a prescribed
        displacement; `friction` is pairs and their forces."""
        rows = state.reshape(-1, 7)
        total = self.element_forces(rows)
        total += self.contact_forces(rows)
        for (low, high), force in zip(*friction, strict=True):
            self.add_force(total, rows, low, -force)
            self.add_force(total, rows, high, force)
        total[-1, :2] -= load
        return np.where(self.fixed, 0.0, total)

    def contact_forces(self, rows: np.ndarray) -> np.ndarray:
        """Gradient (nodes, 6) of the energy of the pairs that touch."""
        total = np.zeros((len(rows), 6))
        for (low, high), force in zip(*self.touching(rows), strict=True):
            self.add_force(total, rows, low, force)
            self.add_force(total, rows, high, -force)
        return total

    def element_forces(self, rows: np.ndarray) -> np.ndarray:
        """Gradient (nodes, 6) of the strain energy in displacements and spins."""
        x, q = rows[:, :3].T.copy(), rows[:, 3:].T
        x[:, -1] += rotated(q[:, -1], self.arm)
        ends = np.stack((np.arange(x.shape[1] - 1), np.arange(1, x.shape[1])))
        shift = np.zeros((12, 12, 1), dtype=complex)
        shift[np.arange(12), np.arange(12)] = 1j * TINY
        poses = []
        for end in range(2):
            move, spin = np.split(shift[6 * end : 6 * end + 6], 2)
            position = x[:, None, ends[end]] + move
            turned = product(np.concatenate((np.ones((1, 12, 1)), 0.5 * spin)), q[:, None, ends[end]])
            poses.append((position, product(turned, self.frames[:, None, end])))
        e = strain(*poses) - self.strain0[:, None]
        energy = 0.5 * np.einsum("ike,ije,jke->ke", e, self.stiffness, e)
        parts = energy.imag.T / TINY
        total = np.zeros((len(rows), 6))
        np.add.at(total, ends[0], parts[:, :6])
        np.add.at(total, ends[1], parts[:, 6:])
        total[-1, 3:] += np.cross(rotated(q[:, -1], self.arm), total[-1, :3])
        return total

    def centres(self, rows: np.ndarray) -> np.ndarray:
        """Centres (spheres, 3) of the contact spheres."""
        moving = rows[self.attached]
        return moving[:, :3] + rotated(moving[:, 3:].T, self.offset.T).T

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

    def add_force(self, total: np.ndarray, rows: np.ndarray, sphere: int, force: np.ndarray) -> None:
        """Add the gradient `force` at a sphere to that of the nodes."""
        node = self.attached[sphere]
        arm = rotated(rows[node, 3:], self.offset[sphere])
        total[node, :3] += force
        total[node, 3:] += np.cross(arm, force)


def wire_forces(scene: Scene, element: str, elements_per_turn: int, pairs_per_turn: int) -> WireForces:
    """The scene's wire on a mesh."""
    spring = scene.spring
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
    contact = scene.contact
    rest = np.zeros((count + 1, 7))
    rest[:, :3], rest[:, 3] = points, 1.0
    rest[-1, :3] = reference
    return WireForces(
        rest=rest,
        frames=frames,
        arm=points[-1] - reference,
        stiffness=(curved if element == "curved" else straight)(scene, phases, points, poses),
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


def friction_of(path: EquilibriumPath, row: int) -> tuple[np.ndarray, np.ndarray]:
    """Pairs and tangential forces on their lower spheres, as the path reports them."""
    pairs = path.shape.data.contact.pairs  # type: ignore[attr-defined]
    if path.scene.contact.sliding == "free" or not len(pairs):
        return np.zeros((0, 2), int), np.zeros((0, 3))
    return pairs, path.friction.force[row]
