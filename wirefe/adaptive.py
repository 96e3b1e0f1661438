"""A load path as accurate as asked for: mesh, stations and substeps are chosen, and the error is estimated.

The error is that of the load curve (`coilspring.curves`), against the wire model of the same scene with a
mesh, stations and substeps without end. A level n has n curved elements a turn (`STRAIGHT` n straight ones
where end turns rest on plates) and 4 n stations of wires; both errors then fall with 1 / n^2.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from itertools import combinations
from typing import Any

import numpy as np

from coilspring.curves import answered, compare_curves
from coilspring.errors import EquilibriumNotFound, InputError, require_number
from coilspring.path import EquilibriumPath
from coilspring.scene import Scene, require_scene
from coilspring.scene.profile import TWO_PI
from wirefe.contact.points import PER_TURN
from wirefe.solve import solve

ACCURACIES = (1e-5, 1e-2)
COARSEST, FINEST, FINEST_STRAIGHT = 4, 128, 32  # levels
STRAIGHT, STATIONS = 10, 4  # elements of a plate-seated spring, and stations a turn, of level 1
ROWS = 5  # of a stage, at least, at which a coarse path is compared with a fine one
SMOOTH, IRREGULAR = 3.0, 4.0  # safety of the estimate, without contact and where coils touch
CLEAR = 0.05  # wire diameters between coils that do not touch on any level
BETWEEN = 0.75  # of the level, of a third path where coils touch: two may agree by chance
AHEAD = 1.1  # times the level that is predicted to do
CLOSE = 0.8  # of a level: the difference from levels beyond tells chance from error too badly
LEAP = 4.0  # times the last level, the most without the evidence of a level between
HALVINGS = 3  # of the substeps, at most, where friction makes the answer depend on them
TINY = 1e-12  # of the time 0..1
FRACTION = 1_000  # of a coil at most, at which a spring or a section of it ends


@dataclass(frozen=True)
class Levels:
    """The meshes of a scene.

    Attributes
    ----------
    scene : what is solved.
    multiple : a level is a multiple of it.
    spheres : a turn, or None with stations.
    """

    scene: Scene
    multiple: int
    spheres: int | None

    @classmethod
    def of(cls, scene: Scene, pairs_per_turn: int | None) -> Levels:
        """Meshes with a node wherever the spring or a section of it ends, and on every sphere."""
        spheres = None
        if scene.contact.geometry == "spheres":
            spheres = PER_TURN["spheres"] if pairs_per_turn is None else pairs_per_turn
        elif pairs_per_turn is not None:
            raise InputError(
                f"pairs_per_turn goes with accuracy for contact of spheres alone, got {pairs_per_turn!r} "
                "with geometry wires"
            )
        ends = [*(scene.spring.profile.knots / TWO_PI), scene.spring.end_turns]
        fits = (q for q in range(1, FRACTION + 1) if all(abs(q * x - round(q * x)) < 1e-6 for x in ends))
        return cls(scene, math.lcm(next(fits, 1), spheres or 1), spheres)

    @property
    def finest(self) -> int:
        """The last level."""
        return self.at_least(FINEST_STRAIGHT if self.scene.supports.seat == "plate" else FINEST)

    def at_least(self, level: float) -> int:
        """The next level from here."""
        return self.multiple * math.ceil(level / self.multiple - 1e-9)

    def options(self, level: int, touching: bool) -> dict[str, Any]:
        """Options of `wirefe.solve`; stations where nothing touches are the fewest."""
        plates = self.scene.supports.seat == "plate"
        return {
            "element": "straight" if plates else "curved",
            "elements_per_turn": STRAIGHT * level if plates else level,
            "pairs_per_turn": self.spheres or min(STATIONS * (level if touching else COARSEST), 1000),
        }


@dataclass
class Trials:
    """Paths of a scene on several levels, coarse to fine.

    Attributes
    ----------
    levels : of the scene.
    steps, few : of the path that is the answer, and of one that only serves the estimate.
    paths : each with its level.
    seconds : CPU time of all solves.
    progress : called before each solve with one line: what is solved, the time and the estimate so far.
    """

    levels: Levels
    steps: int
    few: int
    paths: list[tuple[int, EquilibriumPath]] = field(default_factory=list)
    seconds: float = 0.0
    progress: Callable[[str], None] = lambda line: None

    @property
    def touching(self) -> bool:
        """Whether coils touch, or come near it, on the finest level so far; if none, whether they may."""
        scene = self.levels.scene
        if not scene.contact.enabled or not self.paths:
            return scene.contact.enabled
        return float(self.paths[-1][1].gaps.min(initial=np.inf)) < CLEAR * scene.spring.wire_diameter

    def solve(self, level: int, steps: int) -> EquilibriumPath:
        """The path on a level in some steps, as far as it was reached."""
        options = self.levels.options(level, self.touching)
        so_far = f"; {self.seconds:.0f} s CPU" if self.paths else ""
        if len(self.paths) > 1:
            so_far += f", estimated error {self.estimate:.2g}"
        self.progress(f"{options['elements_per_turn']} elements per turn, {steps} steps{so_far}")
        try:
            path = solve(self.levels.scene, steps=steps, **options)
        except EquilibriumNotFound as found:
            path = found.path
        self.seconds += path.solve_seconds
        return path

    def add(self, level: int, steps: int) -> None:
        """Solve on a level; the finest comes last."""
        self.paths.append((level, self.solve(level, steps)))
        self.paths.sort(key=lambda pair: pair[0])

    @property
    def irregular(self) -> bool:
        """Whether the error falls irregularly: of stations where coils touch."""
        return self.levels.spheres is None and self.touching

    @property
    def estimate(self) -> float:
        """Error of the finest path by the law C / n^2; infinite where the path before ends otherwise.

        Where it falls irregularly, C is also taken, at half the safety, from all pairs of paths.
        """
        level, path = self.paths[-1]
        stations = self.levels.options(level, True)["pairs_per_turn"]
        if self.irregular and path.options["pairs_per_turn"] != stations:
            return math.inf  # what no level before has seen touches
        pairs = [pair for pair in combinations(self.paths, 2) if pair[0][0] <= CLOSE * pair[1][0]]
        last = _constant(*pairs[-1])
        if not self.irregular:
            return SMOOTH * last / level**2
        all_pairs = [found for pair in pairs if math.isfinite(found := _constant(*pair))]
        return max(IRREGULAR * last, 0.5 * IRREGULAR * max(all_pairs, default=0.0)) / level**2

    def confirm(self, wanted: float) -> None:
        """Solve on a level between where the only two paths may agree by chance."""
        if self.irregular and len(self.paths) == 2 and self.estimate <= wanted:
            (low, _), (high, _) = self.paths
            between = self.levels.at_least(BETWEEN * high)
            if low < between < high:
                self.add(between, self.few)


def _constant(coarse: tuple[int, EquilibriumPath], fine: tuple[int, EquilibriumPath]) -> float:
    """C of the error C / n^2 by two levels."""
    return difference(coarse[1], fine[1]) / (1.0 / coarse[0] ** 2 - 1.0 / fine[0] ** 2)


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

    Two paths or more are solved, the coarser ones at few points; their differences give the estimate.

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
    trials = Trials(levels, rows, rows if scene.contact.coefficient else few(rows), progress=progress)
    trials.add(levels.at_least(COARSEST), trials.few)
    lost = _substeps(trials, wanted) if scene.contact.coefficient and trials.touching else 0.0
    _refine(trials, wanted, lost)
    _, path = trials.paths[-1]
    path = replace(
        thinned(path, scene, trials.steps // rows),
        accuracy=wanted,
        estimated_error=trials.estimate + lost,
        other_seconds=trials.seconds - path.solve_seconds,
    )
    if path.outcome != "completed":
        raise EquilibriumNotFound(path)
    return path


def _refine(trials: Trials, wanted: float, lost: float) -> None:
    """Solve on finer levels until the estimate, with what is lost by substeps, is what is wanted.

    Raises
    ------
    InputError : it would take a level beyond the finest.
    """
    least, finest = wanted - lost, trials.levels.finest
    level = trials.levels.at_least(2 * trials.paths[0][0])
    while True:
        trials.add(level, trials.steps)
        trials.confirm(least)
        estimate = trials.estimate
        if estimate <= least:
            return
        predicted = AHEAD * level * math.sqrt(estimate / least) if math.isfinite(estimate) else 2.0 * level
        if level >= finest or predicted > LEAP * finest:
            reached = estimate * (level / finest) ** 2 + lost
            turn = trials.levels.options(finest, True)["elements_per_turn"]
            raise InputError(_refusal(wanted, reached, f"with {turn} elements per turn"))
        farthest = finest if predicted <= finest else min(LEAP * level, finest)
        level = trials.levels.at_least(min(max(predicted, level / CLOSE), farthest))


def _substeps(trials: Trials, wanted: float) -> float:
    """Choose substeps finer than the steps; the estimated error which that leaves.

    It may take half of the accuracy wanted, and is estimated on the coarsest level, where it falls with the
    length of the substeps or not at all.

    Raises
    ------
    InputError : it takes more with the finest substeps too.
    """
    (level, coarse), least = trials.paths[0], math.inf
    for _ in range(HALVINGS):
        fine = trials.solve(level, 2 * trials.steps)
        lost = SMOOTH * difference(coarse, fine)
        if lost <= 0.5 * wanted:
            trials.paths[0] = (level, coarse)
            return lost
        least, coarse = min(least, lost), fine
        trials.steps = trials.few = 2 * trials.steps
    why = "with friction or sticking contact the answer depends on the substeps"
    raise InputError(_refusal(wanted, 2.0 * least, why))


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


def difference(coarse: EquilibriumPath, fine: EquilibriumPath) -> float:
    """Of two load curves, and of the times at which they end early; infinite where they end otherwise."""
    if coarse.outcome != fine.outcome:
        return math.inf
    found = compare_curves(coarse.times, answered(coarse), fine)
    curve = found.curve_max if found.steps else 0.0
    if coarse.end_bracket is None or fine.end_bracket is None:
        return curve
    mine, other = sum(coarse.end_bracket), sum(fine.end_bracket)
    return max(curve, abs(mine - other) / max(mine, other, TINY))


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
