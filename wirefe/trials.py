"""Paths of a scene on meshes that are finer and finer, and the error estimated from their differences.

The error is that of the load curve (`coilspring.curves`), against the wire model of the same scene with a
mesh, stations and substeps without end. It is taken to fall with the square of the resolution of the meshes
(`wirefe.meshes`): where wires do not touch it falls faster at first.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field
from itertools import count
from typing import Any

from coilspring.errors import EquilibriumNotFound, InputError
from coilspring.path import EquilibriumPath
from wirefe.mesh import MOST_ELEMENTS
from wirefe.meshes import FEWEST, MOST, STATIONS, Levels, Trial, difference, on_plates
from wirefe.solve import solve

# Accuracies and errors are of `coilspring.curves`: shares of the peak.
ACCURACIES = (1e-5, 1e-2)  # that may be asked for
# Errors over their estimates from differences of paths, at most, as measured on random springs.
SMOOTH = 3.0  # of the last path where errors fall evenly
STEADY = 2.0  # of the last path where they do, and the two estimates before it agree
UNEVEN = 10.0  # of the last path where errors fall unevenly
SEATED = 6.0  # of the last path where they do so by plates alone
ALIKE = 1.5  # ratio of two estimates, below which they agree
CHANCE = 1e-3  # accuracy up to which two paths agree too often by chance with stations or friction: three do
SHARE = 0.5  # least resolution of a mesh with few stations, as a share of its level
FALL = 0.5  # least ratio of an estimate to the one before: two paths may agree by chance


class NotReached(InputError):
    """An accuracy that no mesh reaches.

    Attributes
    ----------
    reached : accuracy that can be asked for, as far as is known or predicted; infinite where it is not.
    why : what limits it.
    """

    def __init__(self, message: str, reached: float, why: str) -> None:
        super().__init__(message)
        self.reached, self.why = reached, why

    def __reduce__(self) -> tuple:
        return NotReached, (str(self), self.reached, self.why)


@dataclass
class Trials:
    """Paths of a scene, each on a mesh finer than the one before.

    Attributes
    ----------
    levels : of the scene.
    wanted : largest error.
    steps : of a path that can be the answer.
    lost : error that is left by substeps.
    found : paths with their meshes.
    deviations : of each path before from the last one.
    constants : error of the last path times the square of its resolution, as estimated from each path before.
    enough : error that will do where the one wanted is out of reach.
    guarded : whether paths may agree by chance on what is wanted, and more of them are compared.
    solved : what was solved, by its mesh and steps.
    progress : called before each solve with one line: what is solved, the time and the estimate so far.
    """

    levels: Levels
    wanted: float
    steps: int
    lost: float = 0.0
    found: list[Trial] = field(default_factory=list)
    deviations: list[float] = field(default_factory=list)
    constants: list[float] = field(default_factory=list)
    enough: float = 0.0
    guarded: bool = False
    solved: dict[tuple, EquilibriumPath] = field(default_factory=dict)
    progress: Callable[[str], None] = lambda line: None

    @property
    def seconds(self) -> float:
        """CPU time of all solves."""
        return sum(path.solve_seconds for path in self.solved.values())

    @property
    def touching(self) -> bool:
        """Whether coils touch, or come near it, on the last mesh so far; if none, whether they may."""
        return self.levels.scene.contact.enabled and (not self.found or self.found[-1].touching)

    @property
    def irregular(self) -> bool:
        """Whether there is an error of stations, which falls irregularly: where coils touch."""
        return self.levels.spheres is None and self.touching

    @property
    def uneven(self) -> bool:
        """Whether errors fall unevenly: with stations, on plates, and where wires overlap in the end."""
        return self.irregular or self.overlapping or on_plates(self.levels.scene)

    @property
    def overlapping(self) -> bool:
        """Whether wires overlap in the end, which is looked for between points of them."""
        return bool(self.found) and self.found[-1].path.outcome == "interpenetration"

    @property
    def substeps(self) -> bool:
        """Whether the path depends on its substeps."""
        return bool(self.levels.scene.contact.coefficient) and self.touching

    @property
    def erratic(self) -> bool:
        """Whether two paths in substeps with friction may agree by chance on less than is wanted."""
        friction = self.levels.scene.contact.coefficient < math.inf
        return self.guarded and self.substeps and friction

    @property
    def finest(self) -> int:
        """The last level."""
        return self.levels.last if self.irregular else self.levels.finest

    def solve(self, mesh: dict[str, Any], steps: int) -> EquilibriumPath:
        """The path on a mesh in some steps, as far as it was reached; nothing is solved twice."""
        key = (*mesh.items(), steps)
        if key in self.solved:
            return self.solved[key]
        so_far = f"; {self.seconds:.0f} s CPU" if self.found else ""
        if math.isfinite(self.estimate):
            so_far += f", estimated error {self.estimate:.2g}"
        self.progress(f"{mesh['elements_per_turn']} elements per turn, {steps} steps{so_far}")
        scene = self.levels.scene
        try:
            path = solve(scene, steps=None if steps == scene.load.steps else steps, **mesh)
        except EquilibriumNotFound as found:
            path = found.path
        self.solved[key] = path
        return path

    def add(self, level: int, steps: int, stations: int | None = None) -> None:
        """Solve on a level, with the stations that go with it unless given, and with more elements than
        before: the difference of two paths with as many elements does not contain their error."""
        regular = not self.irregular
        if regular:
            level, stations = self.levels.at_least(level), FEWEST
        elif stations is None:
            stations = self.others(STATIONS * level)
        mesh = self.levels.options(level, stations, beyond=self.found[-1].elements if self.found else 0)
        if mesh["elements_per_turn"] > MOST_ELEMENTS:
            reached = self.reached if self.found else math.inf
            raise refusal(self.wanted, reached, f"with {MOST_ELEMENTS} elements per turn")
        path = self.solve(mesh, steps)
        if path.outcome != "completed" and steps < self.steps:
            path = self.solve(mesh, self.steps)  # near its end differences are not smooth
        self.take(*self.found, Trial(level, stations, path))
        if regular and self.irregular:  # only now coils touch
            self.found, self.deviations, self.constants = [], [], []
            self.add(level, self.steps)

    def take(self, *found: Trial) -> None:
        """Take these paths, and compare the last one with those before."""
        *before, last = self.found = list(found)
        fine, self.constants = self.resolution(last) ** -2, []
        self.deviations = [difference(each.path, last.path) for each in before]
        for each, deviation in zip(before, self.deviations, strict=True):
            more = self.resolution(each) ** -2 - fine
            unknown = more <= 0.0 or (self.irregular and not told_by_stations(each, last))
            self.constants.append(math.inf if unknown else deviation / more)

    def others(self, stations: int) -> int:
        """Stations, at least so many, elsewhere than those of the paths so far, but for one in a turn."""
        numbers = count(min(stations, MOST))
        return next(n for n in numbers if all(math.gcd(n, each.stations) == 1 for each in self.found))

    def resolution(self, trial: Trial) -> float:
        """Level of the elements, or where stations matter theirs, which do not make all of a difference."""
        if not self.irregular:
            return self.levels.at_least(trial.level)
        return min(trial.level, max(trial.stations / STATIONS, SHARE * trial.level))

    @property
    def constant(self) -> float:
        """The largest of `constants`, older ones reduced; infinite where too few paths end as the last one.

        Whether a spring passes a critical point or not may change from mesh to mesh: more have to agree.
        """
        if not self.constants or self.constants[-1] == math.inf:
            return math.inf
        known = [
            constant * FALL**age for age, constant in enumerate(self.constants[::-1]) if constant < math.inf
        ]
        needed = 1 if len(known) == len(self.constants) else 2
        if self.found[-1].path.critical_time is not None:
            needed = 3 if self.irregular else 2
        return max(known) if len(known) >= needed else math.inf

    @property
    def safety(self) -> float:
        """Error over its estimate by the constant, at most."""
        if self.uneven:
            return UNEVEN if self.irregular or self.overlapping else SEATED
        if len(self.found) > 2 and max(self.constants[-2:]) < ALIKE * min(self.constants[-2:]):
            return STEADY
        return SMOOTH

    @property
    def by_chance(self) -> bool:
        """Whether the paths so far may agree by chance, and a finer mesh may tell."""
        few = self.guarded and self.irregular and len(self.found) < 3
        return few and self.found[-1].level < self.finest

    @property
    def estimate(self) -> float:
        """Error of the last path; infinite where it is not known."""
        if (constant := self.constant) == math.inf:
            return math.inf
        return self.safety * constant / self.resolution(self.found[-1]) ** 2 + self.lost

    @property
    def reached(self) -> float:
        """Error on the finest mesh. Where they are uneven errors may fall with the level alone."""
        finer = max(self.finest / self.resolution(self.found[-1]), 1.0)
        return (self.estimate - self.lost) / finer ** (1.0 if self.uneven else 2.0) + self.lost


def told_by_stations(coarse: Trial, fine: Trial) -> bool:
    """Whether the difference of two paths tells the error of their stations: not where these are as many, or
    where the same one is pressed alone in both, which makes much the same error in both."""
    same = coarse.corner is not None and coarse.corner == fine.corner
    return coarse.stations < fine.stations and not same


def refusal(asked: float, reached: float, why: str, about: str = "") -> NotReached:
    """What cannot be reached, and what can, or what is predicted to."""
    if reached <= asked:  # as far as the paths tell: but these are too few
        reached = math.inf
    rounded = float(f"{1.05 * reached:.1e}") if math.isfinite(reached) else math.inf
    if rounded <= ACCURACIES[1]:
        said = f"accuracy must be at least {about}{rounded:g} for this scene, got {asked:g}: {why}"
        return NotReached(said, rounded, why)
    found = (
        f"the estimated error is {reached:.3g}"
        if reached < math.inf
        else "too few meshes tell the error, or agree on how the path ends"
    )
    return NotReached(f"accuracy cannot be met for this scene, got {asked:g}: {why} {found}", reached, why)
