"""A load path as accurate as asked for: mesh, stations and substeps are chosen, and the error is estimated.

The error is that of the load curve (`coilspring.curves`), against the wire model of the same scene with a
mesh, stations and substeps without end. A level n has n curved elements a turn (`STRAIGHT` n straight ones
where end turns rest on plates) and about 4 n stations of wires; both errors then fall with 1 / n^2.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from itertools import count, pairwise
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
FEWEST, MOST = 16, 960  # stations: where nothing touches; a few more than the most have to be allowed
ROWS = 5  # of a stage, at least, at which paths are compared whose differences are smooth
ROUGH = 5e-3  # accuracies from here on are mostly met by the coarsest mesh
# The errors of two paths over their difference, at most (as measured on random springs): of the coarser one;
# of the finer one, and over what it is where errors fall with the square of the level; where substeps differ.
COARSE, FINE, SAFE, MIXED = 2.0, 1.5, 3.0, 3.0
CLEAR = 0.05  # wire diameters between coils that do not touch on any level
AHEAD = 1.1  # times the level that is predicted to do
STRIDE = 1.4  # times the last level, at least: nearer levels differ by less than their errors
SECOND = 2.0  # times the first level
LEAP, LEAP_IRREGULAR = 4.0, 2.0  # times the last level, at most
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
            "pairs_per_turn": self.spheres or (min(STATIONS * level, MOST) if touching else FEWEST),
        }


@dataclass
class Trials:
    """Paths of a scene on several levels, coarse to fine.

    Attributes
    ----------
    levels : of the scene.
    wanted : largest error.
    steps : of a path that can be the answer.
    lost : error that is left by substeps.
    paths : each with its level.
    seconds : CPU time of all solves.
    progress : called before each solve with one line: what is solved, the time and the estimate so far.
    """

    levels: Levels
    wanted: float
    steps: int
    lost: float = 0.0
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

    @property
    def irregular(self) -> bool:
        """Whether the error falls irregularly: of stations where coils touch."""
        return self.levels.spheres is None and self.touching

    @property
    def substeps(self) -> bool:
        """Whether the path depends on its substeps."""
        return bool(self.levels.scene.contact.coefficient) and self.touching

    @property
    def fewest(self) -> int:
        """Paths that an estimate takes at least: where errors fall irregularly two may agree by chance."""
        return 3 if self.irregular and self.wanted < ROUGH else 2

    @property
    def second(self) -> int:
        """The level after the first."""
        return self.levels.at_least(SECOND * self.paths[0][0])

    def mesh(self, level: int) -> dict[str, Any]:
        """Options of `wirefe.solve`, with stations elsewhere than those of the paths so far, but for two.

        Stations that two paths share make the same error in both, which their difference does not tell.
        """
        mesh = self.levels.options(level, self.touching)
        if self.irregular:
            known: list[Any] = [path.options["pairs_per_turn"] for _, path in self.paths]
            numbers = count(mesh["pairs_per_turn"], 2)
            mesh["pairs_per_turn"] = next(n for n in numbers if all(math.gcd(n, m) == 2 for m in known))
        return mesh

    def solve(self, mesh: dict[str, Any], steps: int) -> EquilibriumPath:
        """The path on a mesh in some steps, as far as it was reached."""
        so_far = f"; {self.seconds:.0f} s CPU" if self.paths else ""
        if len(self.paths) > 1:
            so_far += f", estimated error {self.estimate:.2g}"
        self.progress(f"{mesh['elements_per_turn']} elements per turn, {steps} steps{so_far}")
        try:
            path = solve(self.levels.scene, steps=steps, **mesh)
        except EquilibriumNotFound as found:
            path = found.path
        self.seconds += path.solve_seconds
        return path

    def add(self, level: int, steps: int) -> None:
        """Solve on a level, the finest so far; it takes the place of a path on the same one."""
        path = self.solve(mesh := self.mesh(level), steps)
        if path.outcome != "completed" and steps < self.steps:
            path = self.solve(mesh, self.steps)  # near its end differences are not smooth
        self.paths = [*(pair for pair in self.paths if pair[0] < level), (level, path)]

    @property
    def estimate(self) -> float:
        """Error of the finest path, by its difference from the one before; infinite if it ends otherwise.

        Where it falls irregularly two paths may agree by chance: it is no less than the error of each path
        before, fallen with the square of the level since.
        """
        (low, coarse), (high, fine) = self.paths[-2:]
        if self.irregular and fine.options["pairs_per_turn"] == FEWEST:
            return math.inf  # what no level before has seen touches
        error = min(FINE, SAFE / ((high / low) ** 2 - 1.0)) * difference(coarse, fine)
        if self.irregular:
            fallen = (difference(a, b) * (n / high) ** 2 for (n, a), (_, b) in pairwise(self.paths[:-1]))
            error = max([error, *(COARSE * each for each in fallen if math.isfinite(each))])
        return error + self.lost


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
    in_full = wanted >= ROUGH or (trials.irregular and not trials.substeps)
    trials.add(levels.at_least(COARSEST), rows if in_full else few(rows))
    path, estimate = _coarsest(trials) if wanted >= ROUGH else (trials.paths[0][1], math.inf)
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
    """The first path and its error, by one with a finer mesh and, where that tells as much, in fewer steps;
    infinite where two in full do as well."""
    in_full, factor = trials.irregular, MIXED if trials.substeps else COARSE
    trials.add(trials.second, trials.steps if in_full else few(trials.steps))
    (_, path), (_, fine) = trials.paths
    return path, math.inf if in_full else factor * difference(path, fine)


def _refined(trials: Trials) -> tuple[EquilibriumPath, float]:
    """A path on a level as fine as it takes, and its error; raises `InputError` beyond the finest."""
    if trials.substeps:
        _choose_substeps(trials)
    if len(trials.paths) == 1:
        trials.add(trials.second, trials.steps)
    while True:
        (level, path), estimate = trials.paths[-1], trials.estimate
        enough = estimate <= trials.wanted and len(trials.paths) >= trials.fewest
        if enough and path.scene.load.steps == trials.steps:
            return path, estimate
        trials.add(level if enough else _next(trials, estimate - trials.lost), trials.steps)


def _next(trials: Trials, error: float) -> int:
    """The level that is predicted to do, from the last one's error; raises `InputError` beyond the finest."""
    level, finest = trials.paths[-1][0], trials.levels.finest
    growth = AHEAD * math.sqrt(error / (trials.wanted - trials.lost)) if math.isfinite(error) else 2.0
    if level >= finest or growth * level > LEAP * finest:
        turn = trials.levels.options(finest, True)["elements_per_turn"]
        reached = error * (level / finest) ** 2 + trials.lost
        raise InputError(_refusal(trials.wanted, reached, f"with {turn} elements per turn"))
    growth = min(max(growth, STRIDE), LEAP_IRREGULAR if trials.irregular else LEAP)
    return trials.levels.at_least(min(growth * level, finest))


def _choose_substeps(trials: Trials) -> None:
    """Choose steps, those of the scene or finer, and estimate the error that their substeps leave.

    It may take half of the accuracy wanted, and is estimated on the coarsest level by fewer steps. Raises
    `InputError` if it takes more in the most steps too.
    """
    (level, first), rows, coarse, least = trials.paths[0], trials.steps, None, math.inf
    mesh = {name: first.options[name] for name in trials.mesh(level)}
    for steps in dict.fromkeys((few(rows), *(rows * 2**halving for halving in range(HALVINGS + 1)))):
        path = first if steps == first.scene.load.steps else trials.solve(mesh, steps)
        if coarse is not None:
            trials.lost = MIXED * difference(coarse, path)
            least = min(least, trials.lost)
            if trials.lost <= 0.5 * trials.wanted:
                if path is not first:
                    trials.steps, trials.paths = steps, [(level, path)]
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
