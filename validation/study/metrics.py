"""What a study says of many paths, beside the deviation of two; see `coilspring.curves`."""

from coilspring.curves import Comparison, compare_paths

__all__ = ["Comparison", "compare_paths", "upper_bound"]  # scripts import the first two from here

CONFIDENCE = 0.95


def upper_bound(count: int, of: int) -> float:
    """One-sided upper bound of a rate with 95 % confidence, by Clopper and Pearson."""
    from scipy.stats import beta  # takes a second to import

    return float(beta.ppf(CONFIDENCE, count + 1, of - count)) if count < of else 1.0
