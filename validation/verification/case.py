"""Verification cases of the wire model, described as data, and their one runner: a row of the page each."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np


@dataclass(frozen=True)
class VerificationCase:
    """One case: what is solved, against what, and how well it must agree."""

    name: str  # as the page has it, as data, source and limits
    data: str
    target: tuple[float, ...]  # what is exact
    source: str
    tolerance: float  # of the largest component's error over the largest component of the target
    limits: str  # what the case cannot show
    solve: Callable[[int], Sequence[float] | np.ndarray]  # components of the result, by a number of elements
    mesh: int  # that number
    meshes: tuple[int, ...] = ()  # each twice as fine as the one before, which tell the order of convergence
    fine: int = 0  # mesh that stands in place of the target there
    components: int = 3  # whose error tells the order

    def checked(self) -> dict[str, Any]:
        """The case, solved: a row of the page."""
        order = None
        if self.meshes:
            exact = np.array(self.solve(self.fine) if self.fine else self.target)
            off = [np.abs(np.array(self.solve(count)) - exact)[: self.components] for count in self.meshes]
            order = observed_order([float(each.max()) for each in off])
        result, target = np.array(self.solve(self.mesh)), np.array(self.target)
        error = float(np.abs(result - target).max() / np.abs(target).max())
        row = {"result": result.tolist(), "error": error, "passed": error <= self.tolerance, "order": order}
        return vars(self) | row


def observed_order(errors: Sequence[float]) -> float:
    """Order from the errors of meshes that are each twice as fine, by the first and the last."""
    return float(np.log2(errors[0] / errors[-1]) / (len(errors) - 1))
