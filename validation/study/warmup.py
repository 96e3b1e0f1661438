"""Both models' kernels made ready at the same time, on two processor cores."""

from __future__ import annotations

from functools import cache

import equivbeam
from coilspring import spring_b
from coilspring.solver.startup import background
from validation.study.partialsolve import partial_path

WIRE = (
    "from wirefe.solve import KERNELS; "
    "from coilspring.solver.startup import compile_kernels; compile_kernels(KERNELS)"
)


@cache
def make_ready() -> None:
    """Compile the wire model's kernels in a child while this process compiles what else there is; once."""
    with background(WIRE):
        partial_path(equivbeam.solve, spring_b(), steps=1)  # an edited law may have no path
