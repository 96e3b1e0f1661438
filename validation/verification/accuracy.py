"""Accuracy of the wire model, as a page: ``python -m validation.verification.accuracy``."""

from __future__ import annotations

import sys
from pathlib import Path

from validation.study.document import Table, Text, to_markdown
from validation.study.output import write_facts, write_text
from validation.verification import curvature, momentcase, rodcases, springcases
from validation.verification.case import Check

PAGE, RECORD = Path("docs/validation.md"), Path("reports/verification")
FEWEST = "4 curved elements per turn; UX, UY, ROTZ"
HEAD = """# Accuracy of the wire model

Written by `python -m validation.verification.accuracy`; every result is computed there. Code verification:
rows with exact targets and observed orders. Solution verification: G13 over the mesh. No row compares with a
measured spring or with a wire of solid elements ([that comparison](../reports/solid/solid.md)); what its
curvature changes stands at the end. G numbers are this project's names of its benchmark cases.

*Error* is the largest component's error over the largest component of the target; *order* the observed
order of convergence with the mesh. "Own" targets come from an independent shooting solver or a closed form,
"published" ones from the source named."""
HEADER = (
    *("check", "data", "target", "source", "tolerance", "result", "error", "order", "passed"),
    "what it cannot show",
)


def checks() -> list[Check]:
    """All checks, solved."""
    return [*rodcases.checks(), *momentcase.checks(), *springcases.checks()]


def write_page(path: Path, record: Path) -> bool:
    """Solve all checks, write the page, and the facts into the folder `record`; whether all passed."""
    found = checks()
    table = Table(HEADER, tuple(check.row for check in found))
    write_text(path, to_markdown((Text(HEAD), table, *curvature.blocks())))
    fewest = [check.error for check in found if check.name.startswith("G13, ") and FEWEST in check.data]
    failed = sum(not check.passed for check in found)
    write_facts({"checks": len(found), "failed": failed, "curved": max(fewest)}, record)
    return all(check.passed for check in found)


if __name__ == "__main__":
    sys.exit(0 if write_page(PAGE, RECORD) else 1)
