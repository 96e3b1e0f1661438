"""The wire between rigid ends, at rest: what formulas of coils that carry an axial force alone leave out."""

import math
from typing import NamedTuple

import numpy as np

from coilspring import Scene
from coilspring.scene.sizing import stress_factor
from coilspring.scene.solidwire import wire_flexibility
from wirefe.rod import section_flexibility

PER_TURN = 16  # pieces, in each of which the wire is integrated by Gauss's rule,
SECTIONS = 4  # and stresses are taken so many times


class HeldWire(NamedTuple):
    """How the active coils carry a small axial force."""

    rate: float  # N/mm
    stress: float  # largest shear stress of torsion with Bergstraesser's factor, over that of the formula


def held_wire(scene: Scene) -> HeldWire:
    """Rate and stress between rigid ends: the top turns about Z and moves along X where its supports leave
    that free; forces and moments hold it otherwise."""
    spring = scene.spring
    count = math.ceil(PER_TURN * spring.active_coils)
    top = np.array([0.0, spring.active_height, 0.0])
    pieces, ends = np.linspace(0.0, spring.phase_end, count + 1), np.broadcast_to(top, (count + 1, 3))
    flexibility, lengths = section_flexibility(spring, wire_flexibility(spring, scene.material), pieces, ends)
    stiffness = np.linalg.inv(np.einsum("eq,eqij->ij", lengths, flexibility))
    free = [1, *(dof for name, dof in (("ux", 0), ("rotz", 5)) if name not in scene.supports.top_held)]
    motion = np.linalg.inv(stiffness[np.ix_(free, free)])[0]  # by 1 N
    force, moment = np.split(stiffness[:, free] @ motion, 2)
    phases = np.linspace(0.0, spring.phase_end, SECTIONS * count + 1)
    along = spring.tangents(phases)
    along /= np.linalg.norm(along, axis=1, keepdims=True)
    torsion = ((moment + np.cross(top - spring.points(phases), force)) * along).sum(axis=1)
    radius = spring.radius(phases)
    factor = stress_factor(2.0 * radius / spring.wire_diameter)
    stress = (factor * np.abs(torsion)).max() / (factor * radius).max()
    return HeldWire(float(1.0 / motion[0]), float(stress))
