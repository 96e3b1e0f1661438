"""Tip curves for a load point elsewhere on the rigid top end, which neither model has as an input.

A dead force F at the height h above the top reference point does what F and the moment r x F do at that
point; r turns with the end, so that the moment is mu(rotz) = -h (Fx cos rotz + Fy sin rotz). Paths are
followed with three dead moments that span it; at every load the tip is interpolated between them, and the
moment is found that goes with the rotation it makes. What is read off is the tip of the raised point.
"""

from dataclasses import dataclass, replace
from typing import Self

import numpy as np

from coilspring import EquilibriumPath, Scene
from coilspring.curves import Curve
from coilspring.path import Shape
from coilspring.solver.solve import follow_problem, output_times, scene_path
from equivbeam import model as beam
from equivbeam.solve import KERNELS as BEAM_KERNELS
from equivbeam.solve import beam_shape
from validation.study.cases import paper_mesh
from validation.study.partialsolve import partial_path
from wirefe.results.shape import WireShape
from wirefe.solve import KERNELS as WIRE_KERNELS
from wirefe.solve import scene_problem

# of the farthest: the peak of a component that moves less says nothing; ROTZ counts at half the height
SLIGHT = 0.01
LEAST = 1e-3  # wire diameters: lever of the moments between which is interpolated, at least
ROUNDS = 20  # of the fixed point; on Spring A each leaves less than a tenth of the error


@dataclass(frozen=True)
class TipCurve:
    """What of a path the study compares."""

    times: np.ndarray  # (steps,) reached
    tips: np.ndarray  # (steps, 3) UX, UY (mm; prescribed, the force, N), ROTZ (rad) of the loaded point
    outcome: str  # how the path ended, as `EquilibriumPath` has it
    critical_time: float | None  # when it ended
    counted: tuple[bool, ...] = (True, True, True)  # components that move as far as others, nearly

    @classmethod
    def of(cls, path: EquilibriumPath) -> Self:
        """Tip curve of a path."""
        moved = np.abs(path.tips).max(axis=0, initial=0.0) * (1.0, 1.0, 0.5 * path.scene.spring.active_height)
        counted = tuple((moved > SLIGHT * moved.max()).tolist())
        return cls(path.times, Curve.of(path).answers, path.outcome, path.critical_time, counted)


def raised(scene: Scene, model: str, height: float) -> TipCurve:
    """Tip curve of the point `height` mm above the top reference point, which carries the load.

    For a top that turns, without friction: paths followed under several moments are combined at each load,
    which takes equilibria that do not depend on the path there.
    """
    base = followed(scene, model, 0.0)
    needed = _moment(scene, height, base.tips[:, 2])
    least = LEAST * scene.spring.wire_diameter * np.hypot(*scene.load.force)
    half = max(0.5 * np.ptp(needed), least)  # an axial force turns no top of the beam: none is needed
    moments = needed.min() + 0.5 * np.ptp(needed) + half * np.array([-1.0, 0.0, 1.0])
    curves = [followed(scene, model, float(moment)) for moment in moments]
    ended = next((curve for curve in (base, *curves) if curve.outcome != "completed"), None)
    if ended is not None:
        return ended
    tips = _consistent(scene, height, moments, np.array([curve.tips for curve in curves]))
    c, s = np.cos(tips[:, 2]), np.sin(tips[:, 2])
    tips[:, 0] -= height * s
    tips[:, 1] -= height * (1.0 - c)
    return replace(base, tips=tips)


def followed(scene: Scene, model: str, moment: float) -> TipCurve:
    """Tip curve of the reference point, the force there accompanied by a dead moment, N mm, at time 1."""
    return TipCurve.of(partial_path(_solve, scene, model=model, moment=moment))


def _solve(scene: Scene, model: str, moment: float) -> EquilibriumPath:
    options: dict[str, object] = {}
    if model == "equivbeam":
        data = beam.build_model(scene)
        problem, kernels = beam.beam_problem(data, beam.load_vector(data, scene)), BEAM_KERNELS
        shape: Shape = beam_shape(scene, data, "haringx")
    else:
        problem, mesh, options = scene_problem(scene, **paper_mesh(scene))
        kernels, shape = WIRE_KERNELS, WireShape(scene, problem.data, mesh)
    # the last degree of freedom is the rotation of the top in both models
    problem = replace(problem, load=np.append(problem.load[:-1], problem.load[-1] + moment))
    run = follow_problem(problem, kernels, output_times(scene), scene.spring.wire_diameter)
    return scene_path(scene, model, options, run, shape)


def _moment(scene: Scene, height: float, rotation: np.ndarray) -> np.ndarray:
    """Moment of the full force at the raised point about the reference point, N mm."""
    fx, fy = scene.load.force
    return -height * (fx * np.cos(rotation) + fy * np.sin(rotation))


def _consistent(scene: Scene, height: float, moments: np.ndarray, tips: np.ndarray) -> np.ndarray:
    """Tips, (steps, 3), at the moments that go with their rotations; `tips` is (moments, steps, 3)."""
    a, b, c = moments

    def at(m: np.ndarray) -> np.ndarray:
        weights = np.array([
            (m - b) * (m - c) / ((a - b) * (a - c)),
            (m - a) * (m - c) / ((b - a) * (b - c)),
            (m - a) * (m - b) / ((c - a) * (c - b)),
        ])  # fmt: skip
        return np.einsum("ms,msk->sk", weights, tips)

    found = np.full(tips.shape[1], b)
    for _ in range(ROUNDS):
        found = _moment(scene, height, at(found)[:, 2])
    return at(found)
