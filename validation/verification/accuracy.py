"""Accuracy of the wire model, as a page: ``python -m validation.verification.accuracy``."""

from __future__ import annotations

import sys
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from validation.study.document import Table, Text, to_markdown
from validation.study.output import write_text

PAGE = Path("docs/validation.md")
HEAD = """# Accuracy of the wire model

Written by `python -m validation.verification.accuracy`; every result is computed there. Code verification:
rows with exact targets and observed orders. Solution verification: G13 over the mesh. No row compares with a
measured spring or with a wire of solid elements; what its curvature changes stands at the end. G numbers are
this project's names of its benchmark cases.

*Error* is the largest component's error over the largest component of the target; *order* the observed
order of convergence with the mesh. "Own" targets come from an independent shooting solver or a closed form,
"published" ones from the source named."""
HEADER = (
    *("check", "data", "target", "source", "tolerance", "result", "error", "order", "passed"),
    "what it cannot show",
)


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


def checks() -> list[Check]:
    """All checks, solved."""
    from validation.verification import momentcase, rodcases, springcases

    return [*rodcases.checks(), *momentcase.checks(), *springcases.checks()]


def write_page(path: str | Path) -> bool:
    """Solve all checks and write the page; whether all passed."""
    from validation.verification import curvature

    found = checks()
    table = Table(HEADER, tuple(check.row for check in found))
    write_text(Path(path), to_markdown((Text(HEAD), table, *curvature.blocks())))
    return all(check.passed for check in found)


def observed_order(errors: Iterable[float]) -> float:
    """Order from the errors of meshes that are each twice as fine, by the first and the last."""
    all_errors = list(errors)
    return float(np.log2(all_errors[0] / all_errors[-1]) / (len(all_errors) - 1))


def _numbers(values: tuple[float, ...]) -> str:
    return ", ".join(f"{value:.7g}" for value in values)


if __name__ == "__main__":
    sys.exit(0 if write_page(PAGE) else 1)
