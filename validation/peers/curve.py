"""What a peer answers."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True)
class Curve:
    """Load curve of one code, as far as it was reached.

    Attributes
    ----------
    code : name of the code.
    times : (steps,) of the load.
    tips : (steps, 3) UX, UY, ROTZ of the top reference point, mm, rad.
    seconds : CPU time of the solution.
    """

    code: str
    times: np.ndarray
    tips: np.ndarray
    seconds: float
