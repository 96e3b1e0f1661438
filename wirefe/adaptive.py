"""A load path as accurate as asked for: mesh, stations and substeps are chosen, and the error is estimated.

The error is that of the load curve (`coilspring.curves`), against the wire model of the same scene with a
mesh, stations and substeps without end. What elements and what stations leave (`wirefe.meshes`) is estimated
by itself, and so many of both are taken as do and cost least.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from itertools import count
from typing import Any

import numpy as np

from coilspring.errors import EquilibriumNotFound, InputError, require_number
from coilspring.path import EquilibriumPath
from coilspring.scene import Scene, require_scene
from wirefe.meshes import MOST, STATIONS, Errors, Levels, Trial, difference
from wirefe.solve import solve

ACCURACIES = (1e-5, 1e-2)
COARSEST = 4  # level
FEWEST = 16  # stations, where nothing touches
ROWS = 5  # of a stage, at least, at which paths are compared whose differences are smooth
ROUGH = 5e-3  # accuracies from here on are mostly met by the coarsest mesh
# Errors over what differences tell, at most (as measured on random springs): of the coarser of two paths;
# where substeps differ; of the last path, as two tell it, three, or more (from `ROUGH` on one less).
COARSE, MIXED, SAFE = 2.0, 3.0, {2: 5.0, 3: 4.0, 4: 3.0}
CLEAR = 0.05  # wire diameters between coils that do not touch on any level
AHEAD = 1.1  # below the error wanted is that of the mesh that is predicted to do
STRIDE = 1.4  # times the last mesh, at least: nearer ones differ by less than their errors
SECOND = 2.0  # times the first mesh
FAR = 3.0  # times the last mesh, at most, where errors fall irregularly
BEYOND = 1.5  # times the finest mesh: what is predicted to take more is refused
HALVINGS = 3  # of the substeps, at most, where friction makes the answer depend on them


@dataclass
class Trials:
    """Paths of a scene, each on a mesh finer than the one before in elements or stations.

    Attributes
    ----------
    levels : of the scene.
    wanted : largest error.
    steps : of a path that can be the answer.
    lost : error that is left by substeps.
    found : paths with their meshes.
    errors : what they tell.
    seconds : CPU time of all solves.
    progress : called before each solve with one line: what is solved, the time and the estimate so far.
    """

    levels: Levels
    wanted: float
    steps: int
    lost: float = 0.0
    found: list[Trial] = field(default_factory=list)
    errors: Errors = field(default_factory=Errors)
    seconds: float = 0.0
    progress: Callable[[str], None] = lambda line: None

    @property
    def touching(self) -> bool:
        """Whether coils touch, or come near it, on the last mesh so far; if none, whether they may."""
        scene = self.levels.scene
        if not scene.contact.enabled or not self.found:
            return scene.contact.enabled
        return float(self.found[-1].path.gaps.min(initial=np.inf)) < CLEAR * scene.spring.wire_diameter

    @property
    def irregular(self) -> bool:
        """Whether there is an error of stations, which falls irregularly: where coils touch."""
        return self.levels.spheres is None and self.touching

    @property
    def substeps(self) -> bool:
        """Whether the path depends on its substeps."""
        return bool(self.levels.scene.contact.coefficient) and self.touching

    @property
    def second(self) -> int:
        """The level after the first."""
        return self.levels.at_least(SECOND * self.found[0].level)

    def solve(self, mesh: dict[str, Any], steps: int) -> EquilibriumPath:
        """The path on a mesh in some steps, as far as it was reached."""
        so_far = f"; {self.seconds:.0f} s CPU" if self.found else ""
        if len(self.found) > 1 and math.isfinite(self.estimate):
            so_far += f", estimated error {self.estimate:.2g}"
        self.progress(f"{mesh['elements_per_turn']} elements per turn, {steps} steps{so_far}")
        try:
            path = solve(self.levels.scene, steps=steps, **mesh)
        except EquilibriumNotFound as found:
            path = found.path
        self.seconds += path.solve_seconds
        return path

    def add(self, level: int, stations: int, steps: int) -> None:
        """Solve on a mesh; where nothing touches its stations are the fewest."""
        stations = stations if self.irregular else FEWEST
        path = self.solve(mesh := self.levels.options(level, stations), steps)
        if path.outcome != "completed" and steps < self.steps:
            path = self.solve(mesh, self.steps)  # near its end differences are not smooth
        self.take(Trial(level, stations, path))

    def take(self, trial: Trial) -> None:
        """Compare a path with the last one."""
        if self.found:
            self.errors = self.errors.seen(self.found[-1], trial)
        self.found.append(trial)

    def others(self, stations: float) -> int:
        """Stations, at least so many, elsewhere than those of the paths so far, but for two.

        Stations that two paths share make the same error in both, which their difference does not tell.
        """
        numbers = count(2 * math.ceil(0.5 * stations), 2)
        return next(n for n in numbers if all(math.gcd(n, each.stations) == 2 for each in self.found))

    @property
    def estimate(self) -> float:
        """Error of the last path; infinite if it ends otherwise, or if none before has seen coils touch."""
        last = self.found[-1]
        if self.irregular and not self.errors.stations:
            return math.inf
        paths = len(self.found) + (self.wanted >= ROUGH)
        return SAFE[min(paths, 4)] * self.errors.at(last.level, last.stations) + self.lost


def solve_to(
    scene: Scene,
    accuracy: float,
    *,
    steps: int | None = None,
    penalty: float | None = None,
    geometry: str | None = None,
    pairs_per_turn: int | None = None,
    progress: Callable[[str], None] = lambda line: None,
) -> EquilibriumPath:
    """Follow the load path of `scene` with a mesh, stations and substeps for the accuracy asked for.

    Two paths or more are solved; the estimate is taken from their differences.

    Parameters
    ----------
    scene : Scene
        What is modelled; its spheres, where it has them, are taken as given.
    accuracy : float
        Largest difference of UX, UY, ROTZ (or of the axial force where UY is prescribed) at the same load,
        over the peak, from the converged wire model; 1e-5 to 1e-2.
    steps, penalty, geometry : as of `wirefe.solve`.
    pairs_per_turn : int, optional
        Spheres per turn; stations of wires are chosen.
    progress : callable, optional
        Called before each solve with a line: the mesh, and time and estimated error so far.

    Returns
    -------
    EquilibriumPath
        Its `estimated_error` is at most `accuracy`.

    Raises
    ------
    InputError : bad input, or an accuracy that cannot be reached, in one sentence that says which can.
    EquilibriumNotFound : the path ends before time 1, on two levels alike; carries what was reached, and the
        estimate includes the time at which it ends.
    """
    scene = require_scene(scene).overridden(steps, penalty, geometry)
    wanted = require_number("accuracy", accuracy, *ACCURACIES)
    levels, rows = Levels.of(scene, pairs_per_turn), scene.load.steps
    trials = Trials(levels, wanted, rows, progress=progress)
    rough = wanted >= ROUGH
    in_full = rough or (trials.irregular and not trials.substeps)
    stations = FEWEST if rough else STATIONS * COARSEST
    trials.add(levels.at_least(COARSEST), stations, rows if in_full else few(rows))
    path, estimate = trials.found[0].path, math.inf
    if rough and (trials.substeps or not trials.irregular):
        path, estimate = _coarsest(trials)
    if estimate > wanted:
        path, estimate = _refined(trials)
    path = replace(
        thinned(path, scene, trials.steps // rows),
        accuracy=wanted,
        estimated_error=estimate,
        other_seconds=trials.seconds - path.solve_seconds,
    )
    if path.outcome != "completed":
        raise EquilibriumNotFound(path)
    return path


def _coarsest(trials: Trials) -> tuple[EquilibriumPath, float]:
    """The first path and its error, by one on a finer mesh in fewer steps."""
    (first,), factor = trials.found, MIXED if trials.substeps else COARSE
    trials.add(trials.second, trials.others(SECOND * first.stations), few(trials.steps))
    return first.path, factor * difference(first.path, trials.found[1].path)


def _refined(trials: Trials) -> tuple[EquilibriumPath, float]:
    """A path on a mesh as fine as it takes, and its error; raises `InputError` beyond the finest."""
    if trials.substeps:
        _choose_substeps(trials)
    first = trials.found[0]
    if len(trials.found) == 1:
        if trials.irregular and trials.wanted < ROUGH:
            trials.add(trials.second, first.stations, trials.steps)
        trials.add(trials.second, trials.others(SECOND * first.stations), trials.steps)
    while True:
        last, estimate = trials.found[-1], trials.estimate
        if estimate > trials.wanted:
            trials.add(*_next(trials), trials.steps)
        elif last.path.scene.load.steps == trials.steps:
            return last.path, estimate
        else:
            trials.found.pop()
            trials.add(last.level, last.stations, trials.steps)


def _next(trials: Trials) -> tuple[int, int]:
    """The mesh that is predicted to do, or one on the way; raises `InputError` beyond the finest."""
    last, errors, finest = trials.found[-1], trials.errors, trials.levels.finest
    known = math.isfinite(errors.elements + errors.stations)
    share = (trials.wanted - trials.lost) / (AHEAD * SAFE[4])
    level, stations = errors.cheapest(share) if known else (0.0, 0.0)
    at_end = last.level >= finest and (last.stations >= MOST or not (trials.irregular and known))
    if at_end or max(level / finest, stations / MOST) > BEYOND:
        turn = trials.levels.options(finest)["elements_per_turn"]
        reached = SAFE[4] * errors.at(finest, MOST) + trials.lost
        raise InputError(_refusal(trials.wanted, reached, f"with {turn} elements per turn"))
    most = FAR if trials.irregular else math.inf
    level, stations = (
        min(max(wanted, STRIDE * mine), most * mine)
        for wanted, mine in ((level, last.level), (stations, last.stations))
    )
    return min(trials.levels.at_least(level), finest), trials.others(min(stations, MOST))


def _choose_substeps(trials: Trials) -> None:
    """Choose steps, those of the scene or finer, and estimate the error that their substeps leave.

    It may take half of the accuracy wanted, and is estimated on the coarsest level by fewer steps. Raises
    `InputError` if it takes more in the most steps too.
    """
    (first, *_), rows, coarse, least = trials.found, trials.steps, None, math.inf
    mesh = trials.levels.options(first.level, first.stations)
    for steps in dict.fromkeys((few(rows), *(rows * 2**halving for halving in range(HALVINGS + 1)))):
        path = first.path if steps == first.path.scene.load.steps else trials.solve(mesh, steps)
        if coarse is not None:
            trials.lost = MIXED * difference(coarse, path)
            least = min(least, trials.lost)
            if trials.lost <= 0.5 * trials.wanted:
                if path is not first.path:
                    trials.steps, trials.found, trials.errors = steps, [replace(first, path=path)], Errors()
                return
        coarse = path
    why = "with friction or sticking contact the answer depends on the substeps"
    raise InputError(_refusal(trials.wanted, 2.0 * least, why))


def _refusal(asked: float, reached: float, why: str) -> str:
    """What cannot be reached, and what can."""
    rounded = float(f"{1.05 * reached:.1e}") if math.isfinite(reached) else math.inf
    if rounded <= ACCURACIES[1]:
        return f"accuracy must be at least {rounded:g} for this scene, got {asked:g}: {why}"
    found = (
        f"the estimated error is {reached:.1g}"
        if reached < math.inf
        else "the path ends otherwise on two meshes"
    )
    return f"accuracy cannot be met for this scene, got {asked:g}: {why} {found}"


def few(steps: int) -> int:
    """The fewest steps, `ROWS` at least, whose times are among those of `steps`."""
    return next((count for count in range(ROWS, steps) if steps % count == 0), steps)


def thinned(path: EquilibriumPath, scene: Scene, finer: int) -> EquilibriumPath:
    """The rows of the scene's steps, of a path with steps so many times finer."""
    rows = slice(finer - 1, None, finer)
    times = path.times[rows]
    sums = (
        np.add.reduceat(path.iterations, range(0, len(path.times), finer)) if len(times) else path.iterations
    )
    histories = None if path.histories is None else path.histories[rows]
    iterations = sums[: len(times)]
    return replace(
        path, scene=scene, times=times, states=path.states[rows], histories=histories, iterations=iterations
    )
