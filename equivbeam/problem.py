"""The equivalent beam's arrays made ready for the path follower."""

from __future__ import annotations

from typing import Any

import numpy as np

from coilspring.pairlaw import MEMORY
from coilspring.solving import Problem
from equivbeam.band import ROW
from equivbeam.model import matrix_size, rest_state, top_place


def beam_problem(data: Any, load: np.ndarray, row: int = ROW) -> Problem:
    """The beam of either plane at rest under a load vector at time 1; `row` is that of its matrix."""
    return Problem(
        data=data,
        load=load,
        start=rest_state(data),
        memory=np.zeros((len(data.pairs), MEMORY)),  # no pair has ever closed
        matrix_size=matrix_size(data, row),
        top=top_place(data, row),
    )
