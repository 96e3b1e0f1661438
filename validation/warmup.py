"""Both models' kernels made ready at the same time, on two processor cores."""

from __future__ import annotations

import subprocess
import sys

import equivbeam
from coilspring import spring_b

# a scene with contact, so that every kernel is used
WIRE = "import coilspring, wirefe; wirefe.solve(coilspring.spring_b(), steps=1, elements_per_turn=4)"


def warm_up() -> None:
    """Compile the wire model's kernels in a child while this process compiles the other model's.

    The child leaves them in the on-disk cache. From a warm cache both take about half a second; a
    child that fails costs time only, since this process then compiles by itself.
    """
    with subprocess.Popen([sys.executable, "-c", WIRE], stderr=subprocess.DEVNULL) as child:
        equivbeam.solve(spring_b(), steps=1)
        child.wait()
