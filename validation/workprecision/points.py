"""What the work-precision study finds: errors and times of settings, and which are worth their time."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass

import numpy as np

from coilspring import EquilibriumPath, Scene
from validation.study.metrics import Comparison
from validation.study.timing import Spread
from validation.workprecision.settings import PAIRS, STEPS, Setting

TIE = 1.1  # times nearer to each other than about this factor are one
GAIN = 0.9  # a slower setting is on the front where its error is below this part of the faster ones'


@dataclass(frozen=True)
class Reference:
    """What a scene's paths are compared with.

    Attributes
    ----------
    path : the finest path.
    by_mesh, by_steps : what half its mesh and half its steps change.
    exact : its distance from the exact rod over the peak, where there is one.
    """

    path: EquilibriumPath
    by_mesh: Comparison
    by_steps: Comparison
    exact: float | None

    @property
    def curve(self) -> float:
        """Its own error of the load curve, over the peak."""
        return self.by_mesh.curve_max + self.by_steps.curve_max

    @property
    def shape(self) -> float:
        """Its own error of the shape, mm."""
        return self.by_mesh.shape_max + self.by_steps.shape_max


@dataclass(frozen=True)
class Point:
    """One setting on one scene: its error and its time.

    Attributes
    ----------
    setting : what was run.
    outcome : of the path; errors are those of the part that was reached.
    error : distance from the reference.
    ratio : its time over that of the paper's FE mesh, formed within each round.
    seconds : CPU seconds of the solve: the ratio times the median time of the paper's FE mesh.
    iterations : factorisations.
    """

    setting: Setting
    outcome: str
    error: Comparison
    ratio: Spread
    seconds: Spread
    iterations: int

    @property
    def competes(self) -> bool:
        """Whether it solves the scene to the end with the scene's contact model."""
        return self.outcome == "completed" and self.setting.pairs in (0, PAIRS)


@dataclass(frozen=True)
class Study:
    """All settings of one scene.

    Attributes
    ----------
    scene, reference : what was solved, and what the paths are compared with.
    points : in the order of `worksettings.settings`.
    paper : CPU seconds of the paper's FE mesh, as they were measured.
    peers : OpenSees where it is installed, on no front; it has no shape.
    """

    scene: Scene
    reference: Reference
    points: tuple[Point, ...]
    paper: Spread
    peers: tuple[Point, ...] = ()

    @property
    def curve_front(self) -> tuple[Point, ...]:
        """The fastest settings for every error of the load curve, among those that give all of it."""
        whole = [point for point in self.points if point.setting.steps >= STEPS]
        return front(whole, lambda point: max(point.error.curve_max, self.reference.curve))

    @property
    def shape_front(self) -> tuple[Point, ...]:
        """The fastest settings for every error of the shape at full load, in any number of steps."""
        return front(self.points, lambda point: max(point.error.shape_max, self.reference.shape))


def front(points: Iterable[Point], error: Callable[[Point], float]) -> tuple[Point, ...]:
    """Pareto front by time: no competitor that is faster, or as fast, has an error as small within `GAIN`."""

    def rank(point: Point) -> tuple[int, float]:
        return round(np.log(point.ratio.median) / np.log(TIE)), error(point)

    found: list[Point] = []
    for point in sorted((each for each in points if each.competes), key=rank):
        if not found or error(point) < GAIN * error(found[-1]):
            found.append(point)
    return tuple(found)
