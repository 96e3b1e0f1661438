"""One verification case of the wire model: a row of the page."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True)
class Check:
    """One row: what is solved, against what, how well it must agree, and how well it does."""

    name: str
    data: str
    target: tuple[float, ...]
    source: str
    tolerance: float
    result: tuple[float, ...]
    limits: str
    order: float | None = None

    @property
    def error(self) -> float:
        """Largest component's error over the largest component of the target."""
        target, result = np.array(self.target), np.array(self.result)
        return float(np.abs(result - target).max() / np.abs(target).max())

    @property
    def passed(self) -> bool:
        """Whether the error is within the tolerance."""
        return self.error <= self.tolerance

    @property
    def row(self) -> tuple[str, ...]:
        """The row of the page."""
        return (
            *(self.name, self.data, _numbers(self.target), self.source, f"{self.tolerance:.1e}"),
            *(_numbers(self.result), f"{self.error:.1e}", "" if self.order is None else f"{self.order:.2f}"),
            *("yes" if self.passed else "**no**", self.limits),
        )


def observed_order(errors: Iterable[float]) -> float:
    """Order from the errors of meshes that are each twice as fine, by the first and the last."""
    all_errors = list(errors)
    return float(np.log2(all_errors[0] / all_errors[-1]) / (len(all_errors) - 1))


def _numbers(values: tuple[float, ...]) -> str:
    return ", ".join(f"{value:.7g}" for value in values)
