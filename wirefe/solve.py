"""Solve a scene with the 3D wire model."""

from __future__ import annotations

import numpy as np

from coilspring.errors import require_choice, require_integer
from coilspring.path import EquilibriumPath
from coilspring.scene import Scene
from coilspring.solving import Problem, follow_scene
from coilspring.stepping import Kernels
from wirefe import kernels, model
from wirefe.elements import ELEMENTS
from wirefe.shape import WireShape

KERNELS = Kernels(
    assemble=kernels.assemble,
    factor=kernels.factor,
    solve=kernels.solve,
    retract=kernels.retract,
    motion=kernels.motion,
    commit=kernels.commit,
)


def solve(
    scene: Scene,
    *,
    steps: int | None = None,
    penalty: float | None = None,
    element: str = "straight",
    elements_per_turn: int = 40,
    pairs_per_turn: int = 4,
) -> EquilibriumPath:
    """Follow the load path of `scene` with the 3D beam-FE model of the coiled wire.

    Parameters
    ----------
    scene : Scene
        What is modelled; active coils a multiple of 1/elements_per_turn.
    steps : int, optional
        Requested equal steps of time; by default the scene's.
    penalty : float, optional
        Contact stiffness K in the scene's convention, N/mm^exponent; by default the scene's.
    element : {"straight", "curved"}
        Two-node element between points of the helix: straight, as the paper's, or with the exact
        linear flexibility of its curved piece of wire (0.1 % at 4 a turn).
    elements_per_turn : int
        Mesh; a multiple of `pairs_per_turn`.
    pairs_per_turn : int
        Sphere pairs a turn; the stiffness of each is K * 4 / pairs_per_turn.

    Returns
    -------
    EquilibriumPath

    Raises
    ------
    InputError : bad input, in one sentence.
    EquilibriumNotFound : the path ends before time 1; carries what was reached.
    """
    require_choice("element", element, ELEMENTS)
    require_integer("elements_per_turn", elements_per_turn, 4, 2000)
    scene = scene.overridden(steps, penalty)
    data, mesh = model.build_model(scene, elements_per_turn, pairs_per_turn, element)
    problem = Problem(
        data=data,
        load=model.load_vector(data, mesh),
        start=model.rest_state(mesh),
        memory=np.zeros((len(data.pairs), 7)),
        matrix_size=model.matrix_size(data),
    )
    options = {
        "element": element,
        "elements_per_turn": elements_per_turn,
        "pairs_per_turn": pairs_per_turn,
    }
    return follow_scene(scene, "wirefe", options, problem, KERNELS, WireShape(scene, data, mesh))
