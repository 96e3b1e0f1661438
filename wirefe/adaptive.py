"""A load path as accurate as asked for: mesh, stations and substeps are chosen, and the error is estimated.

What is solved next is decided here, by the error estimated from the paths so far (`wirefe.trials`).
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace

from coilspring.errors import EquilibriumNotFound, require_number
from coilspring.path import EquilibriumPath
from coilspring.scene import Scene, require_scene
from wirefe.meshes import FEWEST, Levels, difference, few, on_plates, thinned
from wirefe.trials import ACCURACIES, CHANCE, STEADY, NotReached, Trials, refusal

COARSEST = 4  # first level, which mostly does where wires do not touch
ROUGH = 5e-3  # accuracy from which few more stations mostly do where they touch
# Errors over their estimates from differences of paths, at most, as measured on random springs.
FIRST = 2.0  # of the first of two paths
MIXED = 5.0  # of the first of two where their substeps differ, too, or errors fall unevenly
SUBSTEPS = 10.0  # of a path in fewer steps where contact remembers: pairs may slide in it alone
AHEAD = 1.1  # error wanted, over that of the mesh that is predicted to do
NEXT = 2.0  # second level over the first without stations that touch, or below `ROUGH`
NEXT_ROUGH = 1.5  # second level over the first where they touch, with friction or on plates
NEXT_STATIONS = 1.25  # second level over the first where they touch otherwise
STRIDE = 1.5  # later level over the one before, at least
FAR = 3.5  # any level over the one before, at most: how errors fall is not known beyond
BEYOND = 1.5  # predicted level over the finest, above which it is refused
HALVINGS = 3  # of the answer's substeps, at most, where friction makes it depend on them


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
    return solve_to_either(scene, wanted, wanted, pairs_per_turn=pairs_per_turn, progress=progress)


def solve_to_either(
    scene: Scene,
    wanted: float,
    enough: float,
    *,
    pairs_per_turn: int | None = None,
    progress: Callable[[str], None] = lambda line: None,
) -> EquilibriumPath:
    """As `solve_to`, with the accuracy wanted, or where that is out of reach a coarser one that is enough.

    Nothing is solved twice. Raises `NotReached` of the coarser one.
    """
    levels, rows = Levels.of(scene, pairs_per_turn), scene.load.steps
    solved: dict[tuple, EquilibriumPath] = {}

    def answer(accuracy: float) -> tuple[Trials, EquilibriumPath, float]:
        guarded = wanted <= CHANCE
        trials = Trials(
            levels, accuracy, rows, enough=enough, guarded=guarded, solved=solved, progress=progress
        )
        return trials, *_answer(trials)

    try:
        trials, path, estimate = answer(wanted)
    except NotReached:
        if enough <= wanted:
            raise
        trials, path, estimate = answer(enough)
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
    # errors are largest where a pair has just closed, or the wire has just come to bear
    bent = (trials.touching or trials.uneven) and not trials.substeps
    steps = trials.steps if bent else few(trials.steps)
    if trials.guarded and trials.substeps and not trials.erratic:
        steps = 2 * trials.steps  # sticking pairs may touch alike in all that fewer steps share
    trials.add(_next(trials), steps)
    fine = (trials.irregular and trials.wanted < ROUGH) or trials.erratic
    if fine or len(trials.found) == 1 or first.path.critical_time is not None:
        return first.path, math.inf
    return first.path, factor * trials.deviations[0]


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
        raise refusal(trials.wanted, trials.reached, why, about)
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
    raise refusal(trials.wanted, 2.0 * least, why)
