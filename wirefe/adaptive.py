"""A load path as accurate as asked for: mesh, stations and substeps are chosen, and the error is estimated.

The error is that of the load curve (`coilspring.curves`), against the wire model of the same scene with a
mesh, stations and substeps without end. It is told by the differences of paths on meshes that are finer and
finer (`wirefe.meshes`), and is taken to fall with the square of their resolution: where wires do not touch
it falls faster at first.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from itertools import count
from typing import Any

from coilspring.errors import EquilibriumNotFound, InputError, require_number
from coilspring.path import EquilibriumPath
from coilspring.scene import Scene, require_scene
from wirefe.mesh import MOST_ELEMENTS
from wirefe.meshes import FEWEST, MOST, STATIONS, Levels, Trial, difference, few, on_plates, thinned
from wirefe.solve import solve

# Accuracies and errors are of `coilspring.curves`: shares of the peak.
ACCURACIES = (1e-5, 1e-2)  # that may be asked for
COARSEST = 4  # first level, which mostly does where wires do not touch
ROUGH = 5e-3  # accuracy from which few more stations mostly do where they touch
# Errors over what differences of paths tell, at most, as measured on random springs.
FIRST = 2.0  # of the first of two paths
MIXED = 5.0  # of the first of two where their substeps differ, too, or errors fall unevenly
SUBSTEPS = 10.0  # of a path in fewer steps where contact remembers: pairs may slide in it alone
SMOOTH = 3.0  # of the last path where errors fall evenly
STEADY = 2.0  # of the last path where they do, and two before it tell alike
UNEVEN = 8.0  # of the last path where errors fall unevenly
ON_PLATES = 10.0  # of the last path where plates make them do so
ALIKE = 1.5  # ratio of the errors that two paths tell, below which they tell alike
CHANCE = 5e-4  # accuracy below which two paths agree too often by chance with stations or friction: three do
SHARE = 0.5  # least resolution of a mesh with few stations, as a share of its level
FALL = 0.5  # least error that a path tells, as a share of what the one before told: two may agree by chance
AHEAD = 1.1  # error wanted, over that of the mesh that is predicted to do
NEXT = 2.0  # second level over the first without stations that touch, or below `ROUGH`
NEXT_ROUGH = 1.5  # second level over the first where they touch, with friction or on plates
NEXT_STATIONS = 1.25  # second level over the first where they touch otherwise
STRIDE = 1.5  # later level over the one before, at least
FAR = 3.5  # any level over the one before, at most: how errors fall is not known beyond
BEYOND = 1.5  # predicted level over the finest, above which it is refused
HALVINGS = 3  # of the answer's substeps, at most, where friction makes it depend on them


class NotReached(InputError):
    """An accuracy that no mesh reaches.

    Attributes
    ----------
    reached : what the finest mesh does, or is predicted to; infinite where that is not known.
    why : with what.
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
    apart : by how much each path before differs from the last one.
    told : error of the last path times the square of its resolution, as each path before tells it.
    enough : error that will do where the one wanted is out of reach.
    solved : what was solved, by its mesh and steps.
    progress : called before each solve with one line: what is solved, the time and the estimate so far.
    """

    levels: Levels
    wanted: float
    steps: int
    lost: float = 0.0
    found: list[Trial] = field(default_factory=list)
    apart: list[float] = field(default_factory=list)
    told: list[float] = field(default_factory=list)
    enough: float = 0.0
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
        """Whether errors fall unevenly: with stations; on plates, on which end turns bear at nodes; and where
        wires overlap in the end, which is looked for between points of them."""
        overlap = bool(self.found) and self.found[-1].path.outcome == "interpenetration"
        return self.irregular or overlap or on_plates(self.levels.scene)

    @property
    def substeps(self) -> bool:
        """Whether the path depends on its substeps."""
        return bool(self.levels.scene.contact.coefficient) and self.touching

    @property
    def erratic(self) -> bool:
        """Whether two paths in substeps with friction may agree by chance on less than is wanted."""
        friction = self.levels.scene.contact.coefficient < math.inf
        return self.substeps and friction and self.wanted < CHANCE

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
        before: two paths with as many would not tell the error of these."""
        regular = not self.irregular
        if regular:
            level, stations = self.levels.at_least(level), FEWEST
        elif stations is None:
            stations = self.others(STATIONS * level)
        mesh = self.levels.options(level, stations, beyond=self.found[-1].elements if self.found else 0)
        if mesh["elements_per_turn"] > MOST_ELEMENTS:
            reached = self.reached if self.found else math.inf
            raise _refusal(self.wanted, reached, f"with {MOST_ELEMENTS} elements per turn")
        path = self.solve(mesh, steps)
        if path.outcome != "completed" and steps < self.steps:
            path = self.solve(mesh, self.steps)  # near its end differences are not smooth
        self.take(*self.found, Trial(level, stations, path))
        if regular and self.irregular:  # only now coils touch
            self.found, self.apart, self.told = [], [], []
            self.add(level, self.steps)

    def take(self, *found: Trial) -> None:
        """Take these paths, and compare the last one with those before."""
        *before, last = self.found = list(found)
        fine, self.told = self.resolution(last) ** -2, []
        self.apart = [difference(each.path, last.path) for each in before]
        for each, apart in zip(before, self.apart, strict=True):
            more = self.resolution(each) ** -2 - fine
            unknown = more <= 0.0 or (self.irregular and each.stations >= last.stations)
            self.told.append(math.inf if unknown else apart / more)

    def others(self, stations: int) -> int:
        """Stations, at least so many, elsewhere than those of the paths so far, but for two.

        Stations that two paths share make the same error in both, which their difference does not tell.
        """
        numbers = count(min(stations, MOST), 2)
        return next(n for n in numbers if all(math.gcd(n, each.stations) == 2 for each in self.found))

    def resolution(self, trial: Trial) -> float:
        """Level of the elements, or where stations matter theirs, which do not make all of a difference."""
        if not self.irregular:
            return self.levels.at_least(trial.level)
        return min(trial.level, max(trial.stations / STATIONS, SHARE * trial.level))

    @property
    def constant(self) -> float:
        """The same as all together tell it; infinite where too few of them end as the last one does.

        Whether a spring passes a critical point or not may change from mesh to mesh: more have to agree.
        """
        if not self.told or self.told[-1] == math.inf:
            return math.inf
        known = [constant * FALL**age for age, constant in enumerate(self.told[::-1]) if constant < math.inf]
        needed = 1 if len(known) == len(self.told) else 2
        if self.found[-1].path.critical_time is not None:
            needed = 3 if self.irregular else 2
        return max(known) if len(known) >= needed else math.inf

    @property
    def safety(self) -> float:
        """Error over what the constant tells, at most."""
        if self.uneven:
            return ON_PLATES if on_plates(self.levels.scene) else UNEVEN
        if len(self.found) > 2 and max(self.told[-2:]) < ALIKE * min(self.told[-2:]):
            return STEADY
        return SMOOTH

    @property
    def by_chance(self) -> bool:
        """Whether the paths so far may agree by chance, and a finer mesh may tell."""
        few_told = self.irregular and self.wanted < CHANCE and len(self.found) < 3
        return few_told and self.found[-1].level < self.finest

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
    EquilibriumNotFound : the path ends before time 1, on two meshes alike, or on three or four at a critical
        point; carries what was reached, and the estimate includes the time at which it ends.
    """
    scene = require_scene(scene).overridden(steps, penalty, geometry)
    wanted = require_number("accuracy", accuracy, *ACCURACIES)
    return solve_to_first(scene, (wanted,), pairs_per_turn=pairs_per_turn, progress=progress)


def solve_to_first(
    scene: Scene,
    accuracies: Sequence[float],
    *,
    pairs_per_turn: int | None = None,
    progress: Callable[[str], None] = lambda line: None,
) -> EquilibriumPath:
    """As `solve_to`, with the first of some accuracies, fine to coarse, that can be reached.

    Nothing is solved twice. Raises `NotReached` of the last one.
    """
    levels, rows = Levels.of(scene, pairs_per_turn), scene.load.steps
    solved: dict[tuple, EquilibriumPath] = {}
    for number, wanted in enumerate(accuracies, 1):
        trials = Trials(levels, wanted, rows, enough=accuracies[-1], solved=solved, progress=progress)
        try:
            path, estimate = _answer(trials)
            break
        except NotReached:
            if number == len(accuracies):
                raise
    path = replace(
        thinned(path, scene, trials.steps // rows),
        accuracy=trials.wanted,
        estimated_error=estimate,
        other_seconds=trials.seconds - path.solve_seconds,
    )
    if path.outcome != "completed":
        raise EquilibriumNotFound(path)
    return path


def _answer(trials: Trials) -> tuple[EquilibriumPath, float]:
    """The path and its error; raises `NotReached` beyond the finest mesh or the most substeps."""
    trials.add(COARSEST, trials.steps, FEWEST)
    if trials.substeps or not trials.irregular:
        path, estimate = _first(trials)
        if estimate <= trials.wanted:
            return path, estimate
    return _refined(trials)


def _first(trials: Trials) -> tuple[EquilibriumPath, float]:
    """The first path and its error, by one on a finer mesh, in fewer steps where these tell as much; infinite
    where more are needed."""
    (first,), factor = trials.found, MIXED if trials.substeps or trials.uneven else FIRST
    # errors are largest where a pair has just closed, or a node has just come to bear
    bent = (trials.touching or trials.uneven) and not trials.substeps
    steps = trials.steps if bent else few(trials.steps)
    if trials.substeps and trials.wanted < CHANCE and not trials.erratic:
        steps = 2 * trials.steps  # sticking pairs may touch alike in all that fewer steps share
    trials.add(_next(trials), steps)
    fine = (trials.irregular and trials.wanted < ROUGH) or trials.erratic
    if fine or len(trials.found) == 1 or first.path.critical_time is not None:
        return first.path, math.inf
    return first.path, factor * trials.apart[0]


def _refined(trials: Trials) -> tuple[EquilibriumPath, float]:
    """A path on a mesh as fine as it takes, and its error; raises `NotReached` beyond the finest."""
    chosen = False
    while True:
        if trials.substeps and not chosen:
            _choose_substeps(trials)
            chosen = True
        last, estimate = trials.found[-1], trials.estimate
        if estimate > trials.wanted or trials.by_chance:
            try:
                trials.add(_next(trials), trials.steps)
            except NotReached:
                if trials.wanted >= trials.enough or estimate > trials.enough:
                    raise
                trials.wanted = trials.enough
        elif last.path.scene.load.steps == trials.steps:
            return last.path, estimate
        else:
            trials.take(*trials.found[:-1])
            trials.add(last.level, trials.steps, last.stations)


def _next(trials: Trials) -> int:
    """The level that is predicted to do, or one on the way; raises `NotReached` beyond the finest."""
    level, finest = trials.found[-1].level, trials.finest
    if not trials.irregular:
        level = trials.levels.at_least(level)
    if len(trials.found) == 1:
        wanted = _second(trials) * level
    else:
        safety = trials.safety if trials.uneven else STEADY
        error, left = safety * trials.constant, trials.wanted - trials.lost
        wanted = max(STRIDE * level, math.sqrt(AHEAD * error / left) if error < math.inf else 0.0)
    if level >= finest or wanted > BEYOND * finest:
        turn = trials.levels.options(finest)["elements_per_turn"]
        about = "" if level >= finest else "about "  # not solved
        why = f"with {turn} elements per turn"
        raise _refusal(trials.wanted, trials.reached, why, about)
    return min(math.ceil(min(wanted, FAR * level)), finest)


def _second(trials: Trials) -> float:
    """Times the first level is the second."""
    if not trials.irregular or trials.wanted < ROUGH:
        return NEXT
    return NEXT_ROUGH if trials.substeps or on_plates(trials.levels.scene) else NEXT_STATIONS


def _choose_substeps(trials: Trials) -> None:
    """Choose steps, those of the scene or finer, and estimate the error that their substeps leave.

    It may take half of the accuracy wanted, and is estimated on the last mesh by a path in fewer steps; where
    two may agree by chance, by one in more steps, too. Raises `NotReached` if it takes more in the most.
    """
    *before, last = trials.found
    rows, given = trials.steps, last.path.scene.load.steps
    paths, lost = ([last.path], [math.inf]) if given < rows else ([], [])
    least, needed = math.inf, 2 if trials.erratic else 1
    for steps in (rows * 2**halving for halving in range(HALVINGS + needed)):
        paths.append(last.path if steps == given else trials.solve(last.mesh, steps))
        lost.append(SUBSTEPS * difference(*paths[-2:]) if len(paths) > 1 else math.inf)
        trials.lost = max(lost[-needed:])
        least = min(least, trials.lost, max(lost[-1], 0.5 * CHANCE))
        if trials.lost <= 0.5 * trials.wanted:
            path = paths[-needed]
            trials.steps = path.scene.load.steps
            trials.take(*(before if trials.steps == rows else ()), replace(last, path=path))
            return
    why = "by the substeps of friction or sticking contact"
    raise _refusal(trials.wanted, 2.0 * least, why)


def _refusal(asked: float, reached: float, why: str, about: str = "") -> NotReached:
    """What cannot be reached, and what can, or what is predicted to."""
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
