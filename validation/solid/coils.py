"""Flexibility of a few coils, clamped at the bottom and rigid at the top, by rods."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from scipy.sparse.linalg import spsolve

import wirefe
from coilspring import Material, Spring
from coilspring.scene.solidwire import wire_flexibility
from wirefe.modes import linear_stiffness

PER_TURN = 16  # curved elements; their linear flexibility is exact


def rod_flexibility(spring: Spring, material: Material, coils: float) -> np.ndarray:
    """Motion (u, rotation) of the reference point on the axis by unit forces and moments there, (6, 6).

    Of the first active coils, by the wire model with the spring's `wire_rigidity`.
    """
    end = 2.0 * np.pi * coils
    phases = np.linspace(0.0, end, round(PER_TURN * coils) + 1)
    rod = wirefe.curved_rod(spring, phases, wire_flexibility(spring, material)).holding(0)
    x, _, z = rod.points[-1]
    wrenches = np.zeros((rod.held.size - 6, 6))
    wrenches[-6:] = np.eye(6)
    for dof, force in enumerate(np.eye(3)):
        wrenches[-3:, dof] = np.cross([-x, 0.0, -z], force)
    stiffness = linear_stiffness(rod)[6:, 6:].tocsc()
    return wrenches.T @ spsolve(stiffness, wrenches)


def coil(index: float, degrees: float, coils: float, wire_rigidity: str = "beam") -> Spring:
    """Coils of wire of 1 mm without end turns, of a pitch angle."""
    pitch = np.pi * index * np.tan(np.radians(degrees))
    return Spring(
        1.0, (index, index), coils, coils * float(pitch), end_turns=0.0, wire_rigidity=wire_rigidity
    )


def both(spring: Spring, material: Material, coils: float) -> dict[str, np.ndarray]:
    """`rod_flexibility` with both rigidities of the wire."""
    return {
        kind: rod_flexibility(replace(spring, wire_rigidity=kind), material, coils)
        for kind in ("beam", "solid")
    }
