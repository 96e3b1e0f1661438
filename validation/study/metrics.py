"""Deviation of two equilibrium paths of one scene: load curves and shapes."""

from dataclasses import replace

import numpy as np

from coilspring.curves import COMPONENTS, NEGLIGIBLE, Comparison, answered, compare_curves, peaks
from coilspring.path import EquilibriumPath

__all__ = [
    "COMPONENTS", "NEGLIGIBLE", "Comparison", "answered", "compare_curves", "compare_paths", "peaks",
    "upper_bound",
]  # fmt: skip
CONFIDENCE = 0.95


def upper_bound(count: int, of: int) -> float:
    """One-sided upper bound of a rate with 95 % confidence, by Clopper and Pearson."""
    from scipy.stats import beta  # takes a second to import

    return float(beta.ppf(CONFIDENCE, count + 1, of - count)) if count < of else 1.0


def compare_paths(path: EquilibriumPath, reference: EquilibriumPath) -> Comparison:
    """Compare two paths of one spring under one load at the times that both reached.

    Parameters
    ----------
    path : the path that is compared.
    reference : the path whose peaks the curve errors are divided by.
    """
    times, mine, theirs = np.intersect1d(path.times, reference.times, return_indices=True)
    curve = compare_curves(path.times, answered(path), reference)
    if times.size == 0:
        return curve
    vectors = path.circle_centres(mine[-1]) - reference.circle_centres(theirs[-1])
    distance = np.linalg.norm(vectors, axis=1)
    return replace(curve, shape_max=float(distance.max()), shape_rms=float(np.sqrt(np.mean(distance**2))))
