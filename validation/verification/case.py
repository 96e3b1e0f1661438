"""Verification cases of the wire model, described as data, and their one runner: a row of the page each."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

SMALL = 1e-3  # of the largest component of the target: one below counts over the largest
UNVERIFIED = "not verified here"  # in the source of a target that was not at hand
KINDS = {  # of targets, by how their source begins
    "exact": "closed form",
    "published": "by others",
    "own": "this project's shooting solver, independent of the wire model",
    UNVERIFIED: "a printed source that was not at hand",
}


@dataclass(frozen=True)
class VerificationCase:
    """One case: what is solved, against what, and how well it must agree."""

    name: str  # as the page has it, as data, source and limits
    data: str
    target: tuple[float, ...]  # what is exact
    source: str
    tolerance: float  # of the largest of `component_errors`
    limits: str  # what the case cannot show
    solve: Callable[[int], Sequence[float] | np.ndarray]  # components of the result, by a number of elements
    mesh: int  # that number
    meshes: tuple[int, ...] = ()  # each twice as fine as the one before, for the order of convergence
    fine: int = 0  # mesh that stands in place of the target there
    components: int = 3  # whose error gives the order

    def kind(self) -> str:
        """Kind of the target, of `KINDS`.

        Raises
        ------
        ValueError : its source begins otherwise.
        """
        kind = UNVERIFIED if UNVERIFIED in self.source else self.source.replace(",", " ").split()[0]
        if kind not in KINDS:
            raise ValueError(f"source must begin with one of {(*KINDS,)}, got {self.source!r}")
        return kind

    def checked(self) -> dict[str, Any]:
        """The case, solved: a row of the page."""
        order = None
        if self.meshes:
            exact = np.array(self.solve(self.fine) if self.fine else self.target)
            off = [component_errors(self.solve(count), exact)[: self.components] for count in self.meshes]
            order = observed_order([float(each.max()) for each in off])
        result = np.array(self.solve(self.mesh))
        error = float(component_errors(result, np.array(self.target)).max())
        row = {"result": result.tolist(), "error": error, "passed": error <= self.tolerance, "order": order}
        return vars(self) | row | {"kind": self.kind()}


def component_errors(result: Sequence[float] | np.ndarray, target: np.ndarray) -> np.ndarray:
    """Error of each component over that component of the target, or over the largest where it is `SMALL`."""
    sizes = np.abs(target)
    return np.abs(np.asarray(result) - target) / np.where(sizes > SMALL * sizes.max(), sizes, sizes.max())


def observed_order(errors: Sequence[float]) -> float:
    """Order from the errors of meshes that are each twice as fine, by the first and the last."""
    return float(np.log2(errors[0] / errors[-1]) / (len(errors) - 1))
