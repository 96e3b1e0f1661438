"""Solve a scene, or many, with the 3D wire model, or any wire."""

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np

from coilspring.contact.law import PAIR_HISTORY, PairLaw
from coilspring.errors import EquilibriumNotFound, InputError, require_choice, require_integer
from coilspring.path import EquilibriumPath
from coilspring.scene import Scene, require_scene
from coilspring.scene.scene import require_motion
from coilspring.solver.interface import Kernels
from coilspring.solver.problem import Problem
from coilspring.solver.solve import follow_load, follow_problem, scene_path
from coilspring.sweep import Sweeper
from coilspring.words import shown
from wirefe import kernels, model, seated
from wirefe.contact.points import (
    NONE_FOUND,
    PER_TURN,
    ContactArrays,
    near_points,
    reach,
    require_nodes,
    require_pairs,
)
from wirefe.contact.stations import of_wires
from wirefe.element.poses import ROW
from wirefe.mesh import MOST_ELEMENTS, WireMesh, chord_warning
from wirefe.results.shape import WireShape, contact_centres
from wirefe.rod import ELEMENTS, Rod, RodPath

# Moves of a rod without contact are compared with this part of its length, as with a wire's diameter.
LENGTHS_OF_A_WIRE = 50.0
# Wire diameters within which what is no pair becomes one: spheres together with those that touch; stations as
# they touch, with the nearest one of another coil: chosen earlier, it would depend on the steps.
SPHERES_REACH, STATIONS_REACH = 1.5, 1.01
CHUNK = 4  # springs of a sweep handed to a worker at a time; to hand one over takes 0.4 ms

KERNELS = Kernels(*(getattr(kernels, name) for name in Kernels._fields))
SEATED = KERNELS._replace(assemble=seated.assemble, update_history=seated.update_history)


def solve(
    scene: Scene,
    *,
    steps: int | None = None,
    penalty: float | None = None,
    geometry: str | None = None,
    element: str = "straight",
    elements_per_turn: int = 40,
    pairs_per_turn: int | None = None,
) -> EquilibriumPath:
    """Follow the load path of `scene` with the 3D beam-FE model of the coiled wire.

    Parameters
    ----------
    scene : Scene
        What is modelled; active coils a multiple of 1/elements_per_turn. Its factors are left out: they
        belong to the equivalent beam.
    steps : int, optional
        Requested equal steps of time; by default the scene's.
    penalty : float, optional
        Contact stiffness K in the scene's convention, N/mm^exponent; by default the scene's.
    geometry : {"wires", "spheres"}, optional
        What stands for the wire in contact; by default the scene's.
    element : {"straight", "curved"}
        Two-node element between points of the helix: straight, as the paper's, or a curved piece of wire,
        exact to the second order in its end forces (0.02 % at 4 per turn for nine of ten springs whose wires
        do not touch).
    elements_per_turn : int
        Mesh.
    pairs_per_turn : int, optional
        Contact points per turn, the stiffness of each K * 4 / pairs_per_turn: 4 spheres, of which
        `elements_per_turn` is a multiple, or 32 stations of wires.

    Returns
    -------
    EquilibriumPath

    Raises
    ------
    InputError : bad input, in one sentence.
    EquilibriumNotFound : the path ends before time 1; carries what was reached.
    """
    scene = require_scene(scene).overridden(steps, penalty, geometry)
    problem, mesh, options = scene_problem(scene, element, elements_per_turn, pairs_per_turn)
    run = follow_load(scene, problem, scene_kernels(scene))
    data = run.problem.data
    options["pairs_found"] = len(data.contact.pairs) - len(problem.history)
    coarse = chord_warning(element, elements_per_turn, scene.material.nu)
    run = replace(run, message=run.message + coarse)
    return scene_path(scene, "wirefe", options, run, WireShape(scene, data, mesh))


def path_shape(scene: Scene, options: Mapping[str, Any], found: np.ndarray) -> WireShape:
    """Reader of the states of a path solved with the options; `found` are the pairs found on the way."""
    mesh_options = {name: options[name] for name in ("element", "elements_per_turn", "pairs_per_turn")}
    problem, mesh, _ = scene_problem(scene, **mesh_options, found=found)
    return WireShape(scene, problem.data, mesh)


def solve_rod(rod: Rod, *, steps: int = 10) -> RodPath:
    """Follow the load path of any wire, in equal steps of time 0..1.

    Parameters
    ----------
    rod : Rod
        From `straight_rod` or `curved_rod`, held and loaded.
    steps : int
        Requested equal steps of time.

    Returns
    -------
    RodPath

    Raises
    ------
    InputError : bad input, in one sentence.
    EquilibriumNotFound : the path ends before time 1; carries what was reached.
    """
    require_integer("steps", steps, 1, 100_000)
    if not isinstance(rod, Rod):
        raise InputError(f"rod must be a wirefe.Rod, got {shown(rod)}")
    times = np.arange(1, steps + 1) / steps
    length = float(np.linalg.norm(np.diff(rod.points, axis=0), axis=1).sum()) / LENGTHS_OF_A_WIRE
    run = follow_problem(rod_problem(rod), KERNELS, times, length)
    track = run.track
    path = RodPath.of(
        rod,
        track.states,
        times=times[: len(track.states)],
        iterations=track.iterations,
        outcome=run.outcome,
        message=run.message,
        critical_time=run.critical_time,
        residual_history=tuple(track.decrements[track.decrements > 0.0]),
        solve_seconds=run.solve_seconds,
    ).doubted()
    if path.outcome != "completed":
        raise EquilibriumNotFound(path)
    return path


def scene_kernels(scene: Scene, **options: object) -> Kernels:
    """Kernels of a scene: with plates, or without."""
    return SEATED if scene.supports.seat == "plate" else KERNELS


def _checked(options: dict[str, Any]) -> dict[str, Any]:
    """Options of a sweep, good for some scenes."""
    require_mesh(options["element"], options["elements_per_turn"])
    pairs, geometry = options["pairs_per_turn"], options["geometry"]
    if pairs is not None:
        require_pairs(pairs, geometry or "spheres")  # of spheres there may be fewer than of stations
    if pairs is not None and geometry == "spheres":
        require_nodes(options["elements_per_turn"], pairs)
    return options


sweep = Sweeper(solve, scene_kernels, CHUNK, _checked).sweep


def new_pairs(contact: ContactArrays, state: np.ndarray) -> np.ndarray:
    """Pairs of contact points that are near in `state` and not in the model yet, shape (pairs, 2)."""
    centres = contact_centres(contact, state[None])[0]
    diameters = STATIONS_REACH if of_wires(contact.parts) else SPHERES_REACH
    found, _ = near_points(contact, centres, reach(contact, centres, diameters))
    return found


def scene_problem(
    scene: Scene,
    element: str,
    elements_per_turn: int,
    pairs_per_turn: int | None,
    found: np.ndarray = NONE_FOUND,
) -> tuple[Problem, WireMesh, dict[str, object]]:
    """Problem, mesh and options of a scene's wire model; `found` are pairs of contact points that touch
    besides those one turn apart."""
    require_mesh(element, elements_per_turn)
    require_motion(scene)
    if pairs_per_turn is None:
        pairs_per_turn = PER_TURN[scene.contact.geometry]
    data, mesh, rod = model.build_model(scene, elements_per_turn, pairs_per_turn, element, found)
    options: dict[str, object] = {
        "element": element,
        "elements_per_turn": elements_per_turn,
        "pairs_per_turn": pairs_per_turn,
        "pairs_found": len(found),
    }
    problem = _problem(data, rod, mesh.arm)

    def extended(state: np.ndarray) -> Problem:
        """The problem with the pairs that touch in a state as well."""
        more = np.concatenate((found, new_pairs(data.contact, state)))
        return scene_problem(scene, element, elements_per_turn, pairs_per_turn, more)[0]

    return replace(problem, extended=extended), mesh, options


def require_mesh(element: str, elements_per_turn: int) -> None:
    """Refuse a mesh that no scene can have."""
    require_choice("element", element, ELEMENTS)
    require_integer("elements_per_turn", elements_per_turn, 4, MOST_ELEMENTS)


def rod_problem(rod: Rod) -> Problem:
    """Problem of any wire."""
    if not rod.stands:
        raise InputError("held must leave no rigid motion, got dofs that hold the wire in part")
    if not rod.loads[~rod.held].any():
        raise InputError("loads must not all be zero or held, got none that does work")
    return _problem(model.rod_model(rod, np.zeros(3)), rod, np.zeros(3))


def _problem(data: model.WireModel, rod: Rod, arm: np.ndarray) -> Problem:
    start = model.rest_state(rod, arm)
    return Problem(
        data=data,
        load=model.load_vector(rod),
        start=start,
        span=float(np.abs(start.reshape(-1, ROW)[:, :3]).max()),
        history=np.zeros(len(data.contact.pairs), PAIR_HISTORY),
        matrix_size=model.matrix_size(data),
        law=PairLaw.of(data.contact),
        modified=True,
        top=model.top_place(rod),
    )
