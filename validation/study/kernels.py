"""Kernels of both models, compiled before anything is timed."""

from functools import cache

import equivbeam
from coilspring import spring_b
from coilspring.solver.startup import background
from validation.study.partialsolve import partial_path

WIRE_KERNELS = (
    "from wirefe.solve import KERNELS; "
    "from coilspring.solver.startup import compile_kernels; compile_kernels(KERNELS)"
)


@cache
def make_ready() -> None:
    """Compile the wire model's kernels in a subprocess while this process compiles the others; once."""
    with background(WIRE_KERNELS):
        partial_path(equivbeam.solve, spring_b(), steps=1)  # an edited law may have no path
