"""What the wire's curvature changes: a straight rod with shear, and the coiled wire by its section."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from coilspring import Material
from coilspring.scene.solidwire import flexibility
from coilspring.scene.wire import SHEAR_FACTOR
from validation.study.document import Block, Heading, Table, Text

# Axial deflection of a closely coiled spring over 8 F D^3 n/(G d^4), by index D/d: sector of a ring in
# three-dimensional elasticity by Ritz's method, zero pitch. Our own numbers; Ancker and Goodier's series
# agrees to 1e-3.
EXACT_RING: Mapping[float, float] = {
    3.0: 0.97742, 4.0: 0.98774, 5.0: 0.99228, 20.0 / 3.0: 0.99571, 8.0: 0.99704, 10.0: 0.99811, 15.0: 0.99916,
}  # fmt: skip
SPRING_A = 20.0 / 3.0  # its index


def rod(index: float) -> float:
    """The same deflection of a straight rod with shear, which both models' wire is unless it is solid."""
    return 1.0 + 0.5 / (SHEAR_FACTOR * index**2)


def solid(index: float) -> float:
    """The same of a wire with `wire_rigidity = "solid"`."""
    material = Material(1.0, 0.3)
    F = flexibility(np.array([2.0 / index]), np.zeros(1), 1.0, material)[0]
    axial = np.array([0.0, 0.0, 1.0, 0.5 * index, 0.0, 0.0])
    return float(np.pi * material.G / (8.0 * index**2) * (axial @ F @ axial))


def formula(index: float) -> float:
    """The same by Goehner's term."""
    return 1.0 - 3.0 / 16.0 / index**2


def too_soft() -> float:
    """By how much both models move Spring A too far under an axial load, per cent."""
    return 100.0 * (rod(SPRING_A) / EXACT_RING[SPRING_A] - 1.0)


def blocks() -> list[Block]:
    """The part of the validation page."""
    rows = tuple(
        (
            f"{index:.3g}",
            f"{exact:.5f}",
            *_cells(rod(index), exact),
            *_cells(solid(index), exact),
            *_cells(formula(index), exact),
        )
        for index, exact in EXACT_RING.items()
    )
    exact = EXACT_RING[SPRING_A]
    return [
        Heading(2, "What the wire's curvature changes"),
        Text(
            "The wire of both models has the rigidities of a straight rod, with shear factor "
            f"{SHEAR_FACTOR}, unless `wire_rigidity` is `solid`. A curved wire is stiffer. Axial deflection "
            "of a closely coiled spring over 8 F D^3 n/(G d^4), against a ring sector in three-dimensional "
            "elasticity (own, Ritz's method):"
        ),
        Table(
            (
                *("index", "3D elasticity", "rod with shear", "too soft by (%)", "solid wire", "off by (%)"),
                *("Goehner's term", "off by (%)"),
            ),
            rows,
        ),
        Text(
            f"So at Spring A's index of {SPRING_A:.3g} both models move too far by "
            f"{too_soft():.1f} % under an axial load; the textbook formula, "
            f"without shear and curvature, by {100.0 * (1.0 / exact - 1.0):.1f} %. Checks against rods, "
            "the helix law's among them, say nothing of this. Coils against solid elements, and where each "
            "model stands: [the wire as a solid body](../reports/solid/solid.md)."
        ),
    ]


def _cells(value: float, exact: float) -> tuple[str, str]:
    return f"{value:.5f}", f"{100.0 * (value / exact - 1.0):+.2f}"
