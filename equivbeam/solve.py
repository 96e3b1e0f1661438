"""Solve a scene, or many, with the equivalent beam."""

from collections.abc import Callable, Mapping
from contextlib import suppress
from dataclasses import fields, replace
from functools import partial
from typing import Any, NoReturn

import numpy as np

from coilspring.errors import InputError
from coilspring.path import EquilibriumPath
from coilspring.scene import Factors, Scene, require_scene
from coilspring.scene.scene import require_motion
from coilspring.solver.interface import Kernels
from coilspring.solver.solve import MOST_ITERATIONS, Run, follow_load, output_times, scene_path
from coilspring.sweep import Sweeper
from equivbeam import kernels, model
from equivbeam.laws import law_of, require_factors
from equivbeam.laws.helix import Refinements
from equivbeam.laws.lawchecks import not_finite
from equivbeam.laws.userlaw import UserLaw
from equivbeam.options import BeamOptions
from equivbeam.shape import BeamShape, element_measures
from equivbeam.validity import warning

# The paper's matrices are not the tangent: they converge linearly, the printed one by hundreds of steps.
MOST_PAPER_ITERATIONS = 10_000
CHUNK = 64  # springs of a sweep handed to a worker at a time

KERNELS = Kernels(*(getattr(kernels, name) for name in Kernels._fields))


def solve(
    scene: Scene,
    *,
    steps: int | None = None,
    penalty: float | None = None,
    law: Any = "haringx",
    tangent: str = "exact",
    sliding: str = "ignore",
    refinements: Refinements | None = None,
    factors: tuple[float, float, float] | None = None,
) -> EquilibriumPath:
    """Follow the load path of `scene` with the 2D equivalent beam.

    Parameters
    ----------
    scene : Scene
        What is modelled; active coils a multiple of 0.5. Of the start phase the paper's law has the side on
        which the wire begins, as the circles of the working plane do; the helix law has it all.
    steps : int, optional
        Requested equal steps of time; by default the scene's.
    penalty : float, optional
        Contact stiffness K in the scene's convention, N/mm^exponent; by default the scene's.
    law : {"haringx", "helix"}, file, module or object
        Law of a half coil: the paper's (1)-(9), a helix in large deformation (`equivbeam.laws.helix`), or one
        of your own by its functions ``parameters`` and ``energy`` (`equivbeam.laws.userlaw`).
    tangent : {"exact", "paper", "paper-printed"}
        The Hessian of the energy with a tangent predictor, or the paper's matrix (Phi with the
        factor 12, or as printed) iterated from the last state, as the paper did; the paper's go
        with its own law alone.
    sliding : {"ignore", "scene"}
        "scene" applies the scene's "no sliding" or friction to the circles; by default they are
        frictionless.
    refinements : Refinements, optional
        What the helix law has beyond the paper's; by default all of it.
    factors : tuple of float, optional
        Of the paper's axial, shearing and bending stiffness, as `equivbeam.calibrate` finds them; by
        default the scene's.

    Returns
    -------
    EquilibriumPath

    Raises
    ------
    InputError : bad input, in one sentence.
    EquilibriumNotFound : the path ends before time 1; carries what was reached.
    """
    options = BeamOptions(law, tangent, sliding, refinements)
    scene = require_scene(scene).overridden(steps, penalty)
    if factors is not None:
        scene = replace(scene, factors=Factors.of(factors))
    require_motion(scene)
    data = model.build_model(scene, options)
    exact = tangent == "exact"
    limit = MOST_ITERATIONS if exact else MOST_PAPER_ITERATIONS
    problem = model.beam_problem(data, model.load_vector(data, scene))
    with_law = law_kernels(options.law, data.rows.shape[1])
    run = follow_load(scene, problem, with_law, limit=limit, predictor=exact)
    run = _judged(options.law, data.rows, run)
    states, times = run.track.states, output_times(scene)[: len(run.track.states)]
    if run.outcome != "completed":  # which the law may be to blame for
        states, times = np.vstack((states, run.track.last)), np.append(times, run.track.time)
    shape = beam_shape(scene, data, options.law)
    run = replace(run, message=run.message + warning(shape, options.law, states, times))
    return scene_path(scene, "equivbeam", options.stored(), run, shape)


def _judged(law: str | UserLaw, rows: np.ndarray, run: Run) -> Run:
    """The run; where it ended at a state beyond which a user's law is not defined, that is why it ended."""
    if isinstance(law, str) or run.outcome == "completed":
        return run
    where = not_finite(law, rows, element_measures(run.track.last[None])[0])
    return replace(run, outcome="not_converged", message=where, critical_time=None) if where else run


def scene_kernels(scene: Scene, law: str | UserLaw = "haringx", **others: object) -> Kernels:
    """Kernels of a scene: the same for all. A user's law has another `assemble`."""
    if isinstance(law, UserLaw):
        with suppress(InputError):  # the scene is refused then
            return law_kernels(law, law.columns(scene.spring, scene.material))
    return KERNELS


def law_kernels(law: str | UserLaw, columns: int) -> Kernels:
    """The kernels with a law whose table of parameters has so many columns."""
    return KERNELS._replace(assemble=kernels.assemble_of(law, columns))


def beam_shape(scene: Scene, data: model.BeamModel, law: str | UserLaw) -> BeamShape:
    """Reader of states that were found with a law; pickled with its file, or as what paths keep of an object,
    whose functions may go nowhere else."""
    kept = str(law) if isinstance(law, UserLaw) and law.source is None else law
    return BeamShape(scene, data, partial(_assemble_of, kept, data.rows.shape[1]))


def _assemble_of(law: str | UserLaw, columns: int) -> Callable:
    """See `equivbeam.kernels.assemble_of`; `InputError` for a law that this process does not know."""
    return kernels.assemble_of(law_of(law), columns)


def _checked(options: dict[str, Any]) -> dict[str, Any]:
    """Options of a sweep, good for some scenes; the law is read once: one content for all workers."""
    chosen = BeamOptions(**{item.name: options[item.name] for item in fields(BeamOptions)})
    if options["factors"] is not None:
        require_factors(chosen.law, Factors.of(options["factors"]))
    return {**options, "law": chosen.law}


sweep = Sweeper(solve, scene_kernels, CHUNK, _checked).sweep


def path_shape(scene: Scene, options: Mapping[str, Any], found: object = ()) -> BeamShape:
    """Reader of the states of a path that was solved with the options; no pairs are found on the way.

    A law that this process does not know is not needed to read them, but for the forces that hold the top.
    These stay refused if the law is loaded later: the table of parameters is another law's.
    """
    try:
        chosen = BeamOptions.of(options)
    except InputError as error:
        data = model.build_model(scene, BeamOptions.of({**options, "law": "haringx"}))
        return BeamShape(scene, data, partial(_refuse, error))
    data = model.build_model(scene, chosen)
    return beam_shape(scene, data, chosen.law)


def _refuse(error: InputError) -> NoReturn:
    raise error
