"""Accuracy of the wire model, as a page: ``python -m validation.verification.accuracy``."""

import sys
from collections.abc import Iterable
from pathlib import Path

import numpy as np

from coilspring import Material
from coilspring.scene.solidwire import flexibility
from coilspring.scene.wire import SHEAR_FACTOR
from validation.study import template
from validation.study.files import write_facts, write_text
from validation.verification import rodcases, springcases
from validation.verification.case import KINDS, SMALL

PAGE, RECORD = Path("docs/validation.md"), Path("reports/verification")
FEWEST = "4 curved elements per turn; UX, UY, ROTZ"
# What the wire's curvature changes, which a wire of beams leaves out: axial deflection of a closely coiled
# spring over 8 F D^3 n/(G d^4), by index D/d: sector of a ring in three-dimensional elasticity by Ritz's
# method, zero pitch. Our own numbers; Ancker and Goodier's series agrees to 1e-3.
EXACT_RING = {
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


def goehner(index: float) -> float:
    """The same by Goehner's term."""
    return 1.0 - 3.0 / 16.0 / index**2


def numbers(values: Iterable[float]) -> str:
    """Components of a target or a result."""
    return ", ".join(f"{value:.7g}" for value in values)


WORDS = template.template(Path(__file__).with_name("accuracy.md"), [rod, solid, goehner, numbers])
WORDS.globals.update(kinds=KINDS, small=SMALL, shear_factor=SHEAR_FACTOR, rings=EXACT_RING, spring_a=SPRING_A)


def write_page(path: Path, record: Path) -> bool:
    """Solve all checks, write the page, and the facts into the folder `record`; whether all passed."""
    found = [case.checked() for case in (*rodcases.CASES, springcases.WRENCH)]
    rods = list(springcases.exact_rods())
    found += [*rods, *(case.checked() for case in springcases.OTHERS)]
    write_text(path, template.page(WORDS, checks=found))
    fewest = [check["error"] for check in rods if FEWEST in check["data"]]
    failed = sum(not check["passed"] for check in found)
    counts = {kind: sum(check["kind"] == kind for check in found) for kind in KINDS}
    write_facts({"checks": len(found), "failed": failed, "curved": max(fewest)} | counts, record)
    return not failed


if __name__ == "__main__":
    sys.exit(0 if write_page(PAGE, RECORD) else 1)
