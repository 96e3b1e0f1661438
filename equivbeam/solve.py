"""Solve a scene with the equivalent beam."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, replace
from typing import Any

from coilspring.errors import InputError, require_choice, require_number, shown
from coilspring.kernelset import Kernels
from coilspring.path import EquilibriumPath
from coilspring.scene import Scene, require_scene
from coilspring.solving import MOST_ITERATIONS, Problem, follow_load, scene_path
from equivbeam import band, kernels, model
from equivbeam.across import band as wide
from equivbeam.across import kernels as across
from equivbeam.across.model import AcrossModel, build_across, is_axial
from equivbeam.across.shape import AcrossShape
from equivbeam.helixrows import Refinements
from equivbeam.laws import LAWS
from equivbeam.limits import caution
from equivbeam.model import BeamModel
from equivbeam.problem import beam_problem
from equivbeam.rendering import BeamShape

SLIDING = ("ignore", "scene")
PLANES = ("working", "across")
# The paper's matrices are not the tangent: they converge linearly, the printed one by hundreds of steps.
MOST_PAPER_ITERATIONS = 10_000

KERNELS = Kernels(
    assemble=kernels.assemble,
    factor=band.factor,
    solve=band.solve,
    retract=kernels.retract,
    work=kernels.work,
    carry=kernels.carry,
    motion=kernels.motion,
    commit=kernels.commit,
    renew=kernels.renew,
    overlap=kernels.overlap,
)
ACROSS = KERNELS._replace(
    assemble=across.assemble,
    factor=wide.factor,
    solve=wide.solve,
    motion=across.motion,
    commit=across.commit,
    renew=across.renew,
    overlap=across.overlap,
)


def solve(
    scene: Scene,
    *,
    steps: int | None = None,
    penalty: float | None = None,
    law: str = "haringx",
    tangent: str = "exact",
    sliding: str = "ignore",
    plane: str | None = None,
    refinements: Refinements | None = None,
    factors: tuple[float, float, float] = model.ONES,
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
    law : {"haringx", "helix"}
        Law of a half coil: the paper's (1)-(9), or a helix in large deformation (`equivbeam.helix`).
    tangent : {"exact", "paper", "paper-printed"}
        The Hessian of the energy with a tangent predictor, or the paper's matrix (Phi with the
        factor 12, or as printed) iterated from the last state, as the paper did; the paper's go
        with its own law alone.
    sliding : {"ignore", "scene"}
        "scene" applies the scene's "no sliding" or friction to the circles; by default they are
        frictionless.
    plane : {"working", "across"}, optional
        Where the beam lies. "across", for the helix law with all its refinements and springs with closed end
        turns whose top is held in ux and rotz, is at a right angle to the plane in which the wire leaves the
        end turns: there the coils meet first (`equivbeam.across`). By default it is taken where it can be.
    refinements : Refinements, optional
        What the helix law has beyond the paper's; by default all of it.
    factors : tuple of float
        Of the paper's axial, shearing and bending stiffness, as `equivbeam.calibrate` finds them.

    Returns
    -------
    EquilibriumPath

    Raises
    ------
    InputError : bad input, in one sentence.
    EquilibriumNotFound : the path ends before time 1; carries what was reached.
    """
    require_choice("law", law, tuple(LAWS))
    require_choice("tangent", tangent, tuple(model.TANGENTS))
    require_choice("sliding", sliding, SLIDING)
    _refuse_mixtures(law, tangent, refinements, factors)
    scene = require_scene(scene).overridden(steps, penalty)
    plane = _plane(scene, plane, able=law == "helix" and refinements in (None, model.ALL))
    options: dict[str, object] = {"law": law, "tangent": tangent, "sliding": sliding, "plane": plane}
    if refinements is not None:
        options["refinements"] = asdict(refinements)
    if tuple(factors) != model.ONES:
        options["factors"] = tuple(factors)
    data = beam_model(scene, options)
    exact = tangent == "exact"
    limit = MOST_ITERATIONS if exact else MOST_PAPER_ITERATIONS
    problem, used = _ready(scene, data)
    run = follow_load(scene, problem, used, limit=limit, predictor=exact)
    run = replace(run, message=run.message + caution(scene, law, plane, data.rows, run.track.states))
    return scene_path(scene, "equivbeam", options, run, _reader(scene, data))


def _plane(scene: Scene, plane: str | None, able: bool) -> str:
    """The plane of the beam; `able` says whether the law is that of the plane across."""
    if plane is None:
        return "across" if able and is_axial(scene) else "working"
    require_choice("plane", plane, PLANES)
    if plane == "across" and not able:
        raise InputError(
            "plane must be working unless the law is helix with all its refinements, got 'across'"
        )
    return plane


def _ready(scene: Scene, data: BeamModel | AcrossModel) -> tuple[Problem, Kernels]:
    """A beam under the scene's load, and the kernels of its plane."""
    load = model.load_vector(data, scene)
    if isinstance(data, AcrossModel):
        return beam_problem(data, load, wide.ROW), ACROSS
    return beam_problem(data, load), KERNELS


def _reader(scene: Scene, data: BeamModel | AcrossModel) -> BeamShape | AcrossShape:
    """Reader of a beam's states."""
    return AcrossShape(scene, data) if isinstance(data, AcrossModel) else BeamShape(scene, data)


def beam_kernels(scene: Scene, options: Mapping[str, Any]) -> tuple[Problem, Kernels]:
    """Another scene's beam under its load with the options of a path, and the kernels of its plane."""
    return _ready(scene, beam_model(scene, options))


def beam_shape(scene: Scene, options: Mapping[str, Any]) -> BeamShape | AcrossShape:
    """Reader of the states of a path that was solved with the options."""
    return _reader(scene, beam_model(scene, options))


def beam_model(scene: Scene, options: Mapping[str, Any]) -> BeamModel | AcrossModel:
    """Arrays of another scene's equivalent beam with the options that a path was solved with."""
    if options["plane"] == "across":
        return build_across(scene, options["sliding"])
    chosen = options.get("refinements")
    return model.build_model(
        scene,
        options["tangent"],
        options["sliding"],
        options["law"],
        model.ALL if chosen is None else Refinements(**chosen),
        options.get("factors", model.ONES),
    )


def _refuse_mixtures(
    law: str, tangent: str, refinements: Refinements | None, factors: tuple[float, float, float]
) -> None:
    """Refuse what goes with one law alone."""
    if not isinstance(factors, list | tuple) or len(factors) != 3:
        raise InputError(f"factors must be three numbers, got {shown(factors)}")
    for factor in factors:
        require_number("factors", factor, 1e-3, 1e3)
    if law != "haringx" and tuple(factors) != model.ONES:
        raise InputError(f"factors must be 1 unless the law is haringx, got {factors!r} with {law!r}")
    if law != "haringx" and tangent != "exact":
        raise InputError(f"tangent must be exact with law {law}, got {tangent!r}")
    if refinements is None:
        return
    if not isinstance(refinements, Refinements):
        raise InputError(f"refinements must be equivbeam.Refinements, got {shown(refinements)}")
    if law != "helix":
        raise InputError(f"refinements must be left out unless the law is helix, got them with {law!r}")
