"""Constitutive laws of a half coil: each is a table of parameters, a row a half coil, and one kernel."""

from __future__ import annotations

import numpy as np

from coilspring.compiling.compiled import part
from coilspring.scene.material import Material
from coilspring.scene.spring import Spring
from equivbeam.laws.haringx import KAX, KFL, KSH, haringx_response, haringx_rows
from equivbeam.laws.helix import helix_response
from equivbeam.laws.helixrows import Refinements, helix_rows

HARINGX, HELIX = 0, 1
LAWS = {"haringx": HARINGX, "helix": HELIX}


def law_rows(
    law: str,
    spring: Spring,
    material: Material,
    refinements: Refinements,
    factors: tuple[float, float, float] = (1.0, 1.0, 1.0),
) -> np.ndarray:
    """Parameters of every half coil as the law reads them, one row each; the length at rest in column L0."""
    if law == "helix":
        return helix_rows(spring, material, refinements)
    rows = haringx_rows(spring, material)
    rows[:, [KAX, KSH, KFL]] *= factors
    return rows


@part
def response(law, rows, i, l, v, dth):  # noqa: E741
    """Response of the half coil `i`: energy and derivatives in its length, shear and relative rotation."""
    return haringx_response(rows, i, l, v, dth) if law == HARINGX else helix_response(rows, i, l, v, dth)
