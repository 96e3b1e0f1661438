"""The paper's law of a half coil, after Haringx (1948): constant stiffnesses.

U = 1/2 Kax (l - l0)^2 + 1/2 Ksh v^2 + 1/2 Kfl dtheta^2                        (B2)
"""

import math

import numpy as np

from coilspring.compiling.compiled import inlined
from coilspring.scene.material import Material
from coilspring.scene.solidwire import coil_section, half_ring
from coilspring.scene.spring import Spring
from equivbeam.element import Response
from equivbeam.halfcoils import half_coils

KAX, KSH, KFL, L0 = range(4)


def haringx_stiffness(spring: Spring, material: Material) -> np.ndarray:
    """Axial, shearing and bending stiffness of every half coil, shape (2 n, 3): N/mm, N/mm, N mm.

    Haringx (1948) with the paper's cos p; the coil diameter is that in the middle of the half coil,
    the helix angle p that of its mean pitch. A solid wire has those of half a ring of its curvature, in
    which shear and stretch of the wire have their part, too.
    """
    at = half_coils(spring)
    D = 2.0 * spring.radius(at.middles)
    E, G, d = material.E, material.G, spring.wire_diameter
    cos_p = np.cos(np.arctan(2.0 * at.lengths / (math.pi * D)))
    if spring.wire_rigidity == "solid":
        curvature = 2.0 * cos_p**2 / D
        return cos_p[:, None] * half_ring(coil_section(spring, material, curvature), 0.5 * D)
    kax = 2.0 * G * d**4 / (8.0 * D**3) * cos_p
    ksh = 2.0 * E * d**4 / (8.0 * D**3) * cos_p
    kfl = 2.0 * 4.0 * E * G * d**4 / (64.0 * D * (2.0 * G + E)) * cos_p
    return np.stack((kax, ksh, kfl), axis=1)


def haringx_rows(spring: Spring, material: Material) -> np.ndarray:
    """Parameters of every half coil: Kax, Ksh, Kfl and the length at rest, shape (2 n, 4)."""
    return np.column_stack((haringx_stiffness(spring, material), half_coils(spring).lengths))


@inlined
def haringx_response(rows, i, l, v, dth):  # noqa: E741
    """Response of the half coil `i`."""
    kax, ksh, kfl = rows[i, KAX], rows[i, KSH], rows[i, KFL]
    x = l - rows[i, L0]
    N, T, M = kax * x, ksh * v, kfl * dth
    return Response(0.5 * (N * x + T * v + M * dth), N, T, M, kax, 0.0, 0.0, ksh, kfl, 0.0)
