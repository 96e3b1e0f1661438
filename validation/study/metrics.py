"""What studies say of tips and of many paths; for the deviation of two paths see `coilspring.curves`."""

import numpy as np

from coilspring.curves import moved

CONFIDENCE = 0.95


def tip_deviation(tips: np.ndarray, reference: np.ndarray) -> np.ndarray:
    """Largest relative deviation of tips (..., components) in the components that the reference moves."""
    free = moved(reference[None])
    return np.max(np.abs(tips - reference)[..., free] / np.abs(reference[free]), axis=-1, initial=0.0)


def upper_bound(count: int, of: int) -> float:
    """One-sided upper bound of a rate with 95 % confidence, by Clopper and Pearson."""
    from scipy.stats import beta  # takes a second to import

    return float(beta.ppf(CONFIDENCE, count + 1, of - count)) if count < of else 1.0
