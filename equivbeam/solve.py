"""Solve a scene with the equivalent beam."""

from __future__ import annotations

import numpy as np

from coilspring.errors import require_choice
from coilspring.path import EquilibriumPath
from coilspring.scene import Scene
from coilspring.solving import MOST_ITERATIONS, Problem, follow_load, scene_path
from coilspring.stepping import Kernels
from equivbeam import band, kernels, model
from equivbeam.contact import MEMORY
from equivbeam.rendering import BeamShape

LAWS = ("haringx",)
SLIDING = ("ignore", "scene")
# The paper's matrices are not the tangent: they converge linearly, the printed one by hundreds of steps.
MOST_PAPER_ITERATIONS = 10_000

KERNELS = Kernels(
    assemble=kernels.assemble,
    factor=band.factor,
    solve=band.solve,
    retract=kernels.retract,
    motion=kernels.motion,
    commit=kernels.commit,
    renew=kernels.renew,
)


def solve(
    scene: Scene,
    *,
    steps: int | None = None,
    penalty: float | None = None,
    law: str = "haringx",
    tangent: str = "exact",
    sliding: str = "ignore",
) -> EquilibriumPath:
    """Follow the load path of `scene` with the 2D equivalent beam.

    Parameters
    ----------
    scene : Scene
        What is modelled; active coils a multiple of 0.5. Of the start phase only the side on which
        the wire begins matters to an in-plane model.
    steps : int, optional
        Requested equal steps of time; by default the scene's.
    penalty : float, optional
        Contact stiffness K in the scene's convention, N/mm^exponent; by default the scene's.
    law : {"haringx"}
        Force law of a half coil: the paper's (1)-(9).
    tangent : {"exact", "paper", "paper-printed"}
        The Hessian of the energy with a tangent predictor, or the paper's matrix (Phi with the
        factor 12, or as printed) iterated from the last state, as the paper did.
    sliding : {"ignore", "scene"}
        "scene" applies the scene's "no sliding" or friction to the circles; by default they are
        frictionless.

    Returns
    -------
    EquilibriumPath

    Raises
    ------
    InputError : bad input, in one sentence.
    EquilibriumNotFound : the path ends before time 1; carries what was reached.
    """
    require_choice("law", law, LAWS)
    require_choice("tangent", tangent, tuple(model.TANGENTS))
    require_choice("sliding", sliding, SLIDING)
    scene = scene.overridden(steps, penalty)
    data = model.build_model(scene, tangent, sliding)
    problem = Problem(
        data=data,
        load=model.load_vector(data, scene),
        start=model.rest_state(data),
        memory=np.zeros((len(data.pairs), MEMORY)),
        matrix_size=model.matrix_size(data),
    )
    exact = tangent == "exact"
    limit = MOST_ITERATIONS if exact else MOST_PAPER_ITERATIONS
    run = follow_load(scene, problem, KERNELS, limit=limit, predictor=exact)
    options = {"law": law, "tangent": tangent, "sliding": sliding}
    return scene_path(scene, "equivbeam", options, run, BeamShape(scene, data))
