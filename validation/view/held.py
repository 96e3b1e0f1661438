"""The wire between rigid ends, at rest."""

import math

import numpy as np

from coilspring import Scene
from coilspring.scene.solidwire import wire_flexibility
from wirefe.results.linear import tip_flexibility
from wirefe.rod import curved_rod

PER_TURN = 16  # curved elements, whose linear flexibility is exact


def held_rate(scene: Scene) -> float:
    """Axial rate at rest of the active coils, as rigid ends hold them, N/mm: the top turns about Z and moves
    along X where its supports leave that free."""
    spring = scene.spring
    phases = np.linspace(0.0, spring.phase_end, math.ceil(PER_TURN * spring.active_coils) + 1)
    rod = curved_rod(spring, phases, wire_flexibility(spring, scene.material))
    flexibility = tip_flexibility(rod, np.array([0.0, spring.active_height, 0.0]))
    free = [1, *(dof for name, dof in (("ux", 0), ("rotz", 5)) if name not in scene.supports.top_held)]
    stiffness = np.linalg.inv(flexibility)[np.ix_(free, free)]
    return float(1.0 / np.linalg.inv(stiffness)[0, 0])
