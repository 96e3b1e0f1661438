"""Fit of the coiled wire's flexibility to solutions on its section: ``python -m validation.solid.table``.

Writes coilspring/scene/solidtable.toml; both are numbers of a wire of diameter 1 and modulus 1.
"""

import sys
from itertools import product

import numpy as np

from coilspring.scene.solidwire import ENTRIES, POWERS, TABLE, monomials
from validation.solid.section import SectionSolution, disk, solve

INDICES = (2.0, 2.3, 2.7, 3.2, 4.0, 6.0, 10.0, 30.0)
ANGLES = (0.0, 6.0, 15.0, 25.0, 40.0, 60.0)  # of the helix, degrees
POISSON = (0.0, 0.1, 0.2, 0.3, 0.4, 0.45, 0.49)
CUBIC = 4  # coefficients in Poisson's ratio
STRESS_TERMS = 6
HEAD = "# Coefficients of `coilspring.scene.solidwire`, written by `python -m validation.solid.table`.\n\n"


def helix(index: float, degrees: float) -> tuple[float, float]:
    """Curvature and torsion of a right-handed helix of a wire of diameter 1."""
    c, s = np.cos(np.radians(degrees)), np.sin(np.radians(degrees))
    return 2.0 * c * c / index, 2.0 * s * c / index


def inner_stress(found: SectionSolution) -> float:
    """Shear stress at the inside of a ring under an axial force over 8 F D / (pi d^3)."""
    radius = 1.0 / found.curvature
    at, stress = found.stresses(np.array([0.0, 0.0, 1.0, radius, 0.0, 0.0]))
    inside = np.hypot(at[0] - 0.5, at[1]) < 1e-9
    return float(stress[4, inside].mean() * np.pi / (16.0 * radius))


def fitted(at: np.ndarray, flexibilities: np.ndarray) -> np.ndarray:
    """Coefficients of every entry, (entries, powers, `CUBIC`)."""
    k, t, nu = at.T
    terms = monomials(k, t)[:, :, None] * (nu[:, None] ** np.arange(CUBIC))[:, None, :]
    weight = 1.0 / (1.0 + 4.0 * k**2)  # coils of usual index
    table = np.zeros((len(ENTRIES), len(POWERS), CUBIC))
    for coefficients, ((i, j), (bent, twisted)) in zip(table, ENTRIES.items(), strict=True):
        # a straight wire of round section does not feel that its axes turn
        kept = [n for n, (a, b) in enumerate(POWERS) if i != j or a or not b]
        lead = weight * k**bent * t**twisted / (1.0 + nu)
        matrix = lead[:, None] * terms[:, kept].reshape(len(at), -1)
        found, *_ = np.linalg.lstsq(matrix, weight * flexibilities[:, i, j], rcond=None)
        coefficients[kept] = found.reshape(-1, CUBIC)
    return table


def main() -> None:
    """Solve, fit and write."""
    mesh = disk()
    at = np.array([(*helix(index, angle), nu) for nu, index, angle in product(POISSON, INDICES, ANGLES)])
    solutions = [solve(mesh, *point) for point in at.tolist()]
    flat = np.flatnonzero((at[:, 1] == 0.0) & (at[:, 2] == 0.3))
    factors = np.array([inner_stress(solutions[n]) for n in flat])
    terms = at[flat, 0, None] ** np.arange(1, STRESS_TERMS + 1)
    tables = {
        "FLEXIBILITY": fitted(at, np.stack([found.flexibility for found in solutions])),
        "STRESS": np.linalg.lstsq(terms, factors - 1.0, rcond=None)[0],
    }
    with np.printoptions(precision=9, linewidth=110, threshold=sys.maxsize, suppress=False):
        lines = [f"{name} = {np.array2string(table, separator=', ')}\n" for name, table in tables.items()]
    TABLE.write_text(HEAD + "".join(lines), encoding="utf-8")


if __name__ == "__main__":
    main()
