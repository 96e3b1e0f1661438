"""The spring as a column under axial load: buckling and lateral stiffness, contact left out.

With the paper's law, `inclined` off (no cos p) and the axis refined below half a coil it tends to the
column of Haringx (1948), on which the buckling formula of EN 13906-1 rests; the order is 2.
"""

from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from coilspring.errors import InputError, require_integer, require_number
from coilspring.scene import Load, Scene, require_scene
from coilspring.scene.sizing import axial_rate
from coilspring.solver.solve import Run, follow_problem
from coilspring.solver.stages import prescribed_stage
from equivbeam.laws import law_of
from equivbeam.laws.haringx import KAX, KFL, KSH, L0
from equivbeam.laws.helix import Refinements
from equivbeam.laws.userlaw import UserLaw
from equivbeam.model import BeamModel, beam_problem, build_model, load_vector
from equivbeam.options import BeamOptions
from equivbeam.solve import beam_shape, law_kernels

FARTHEST = 0.9  # of the height at rest: shortening up to which buckling is searched
MOST = 1e3  # heights by which it may be drawn


@dataclass(frozen=True)
class Buckling:
    """Where the straight spring loses its stability.

    Attributes
    ----------
    force : axial force, N; negative in compression.
    shortening : of the spring there, mm.
    mode : (nodes, 3) x, y and rotation of the nodes, scaled to a largest entry of 1.
    """

    force: float
    shortening: float
    mode: np.ndarray


def buckling(
    scene: Scene, *, law: Any = "haringx", refine: int = 1, inclined: bool = True
) -> Buckling | None:
    """First loss of stability of a spring under axial compression.

    Parameters
    ----------
    scene : Scene
        Spring, material and supports: the bottom is clamped, the top free but for ``top_held``.
        Its load and contact are ignored. A column pinned at both ends is twice one that is
        clamped and free.
    law : as in `equivbeam.solve`; one that couples shear or rotation with length is no perfect column.
    refine : int
        Elements for each half coil, for verification with the paper's law; 1 is the model.
    inclined : bool
        With the paper's cos p in the stiffnesses.

    Returns
    -------
    Buckling, or None where the spring stays straight down to a tenth of its height.
    """
    law, shortening = law_of(law), FARTHEST * require_scene(scene).spring.active_height
    straight, data, run = _compressed(scene, law, refine, inclined, shortening)
    if run.critical_time is None:
        return None
    mode = np.concatenate((np.zeros(3), run.mode)).reshape(-1, 3)
    last, histories = run.track.last[None], run.track.history[None]
    return Buckling(
        force=float(beam_shape(straight, data, law).reactions(last, histories)[0, 1]),
        shortening=scene.spring.active_height - float(run.track.last[-2]),
        mode=mode / mode.flat[np.abs(mode).argmax()],
    )


def lateral_stiffness(
    scene: Scene, shortening: float, *, law: Any = "haringx", refine: int = 1, inclined: bool = True
) -> float:
    """Lateral stiffness dFx/dUX of the top of an axially shortened spring, N/mm.

    Parameters are those of `buckling`; `shortening` in mm is that of the straight spring.

    Raises
    ------
    InputError : the spring has buckled before, has no such length, or its top is held laterally.
    """
    held = require_scene(scene).supports.top_held
    if "ux" in held:
        raise InputError(f"supports.top_held must leave ux free for a lateral stiffness, got {held!r}")
    law, height = law_of(law), require_scene(scene).spring.active_height
    require_number("shortening", shortening, -MOST * height, height)
    straight, data, run = _compressed(scene, law, refine, inclined, shortening)
    if run.outcome != "completed":
        raise InputError(f"shortening must be below that of buckling, got {shortening!r}")
    shape = beam_shape(straight, data, law)
    return float(shape.rates(run.track.states[-1:], None, np.array([[1.0, 0.0]]))[0])


def _compressed(
    scene: Scene, law: str | UserLaw, refine: int, inclined: bool, shortening: float
) -> tuple[Scene, BeamModel, Run]:
    """The spring without contact, its model, and what followed as the top was lowered by the shortening.

    The force would not do: a law need not be linear. The spring buckles where it does under the force.
    """
    require_integer("refine", refine, 1, 10_000)
    if law != "haringx" and (refine > 1 or not inclined):
        raise InputError(
            f"refine and inclined must be left alone with law {law!s}, got {refine!r}, {inclined!r}"
        )
    straight = replace(require_scene(scene).without_contact(), load=Load((0.0, -1.0)))
    # a perfect column: with fixed ends of the wire its axis would bend from the first force on
    refinements = Refinements(ends=False) if law == "helix" else None
    data = _refined(build_model(straight, BeamOptions(law, refinements=refinements)), scene, refine, inclined)
    problem = beam_problem(data, load_vector(data, straight))
    assert problem.top is not None
    stage = prescribed_stage(problem.top, -shortening, axial_rate(straight))
    problem = replace(problem, load=-stage.growing[1] * problem.load, prescribed=stage.prescribed)
    with_law = law_kernels(law, data.rows.shape[1])
    return straight, data, follow_problem(problem, with_law, np.ones(1), scene.spring.wire_diameter)


def _refined(data: BeamModel, scene: Scene, refine: int, inclined: bool) -> BeamModel:
    """The model with `refine` equal elements for each half coil, and without cos p unless `inclined`."""
    if refine == 1 and inclined:
        return data
    rows = np.repeat(data.rows, refine, axis=0)
    rows[:, [KAX, KSH, KFL]] *= refine
    rows[:, L0] /= refine
    if not inclined:
        spring = scene.spring
        middle = np.repeat((np.arange(len(data.rows)) + 0.5) * np.pi, refine)
        slope = refine * rows[:, L0] / (np.pi * spring.radius(middle))
        rows[:, [KAX, KSH, KFL]] *= np.hypot(1.0, slope)[:, None]
    return data._replace(rows=rows)
