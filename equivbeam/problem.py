"""The equivalent beam's arrays made ready for the path follower."""

from __future__ import annotations

import numpy as np

from coilspring.pairlaw import MEMORY
from coilspring.solving import Problem
from equivbeam.model import BeamModel, matrix_size, rest_state, top_place


def beam_problem(data: BeamModel, load: np.ndarray) -> Problem:
    """The beam at rest under a load vector at time 1."""
    return Problem(
        data=data,
        load=load,
        start=rest_state(data),
        memory=np.zeros((len(data.pairs), MEMORY)),  # no pair has ever closed
        matrix_size=matrix_size(data),
        top=top_place(data),
    )
