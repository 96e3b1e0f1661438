"""The cheapest law or mesh for a grid of scenes: the first that does on a sample, by the wire model."""

import math
from collections.abc import Callable, Iterator, Sequence
from functools import partial
from itertools import product
from typing import NamedTuple

import numpy as np

from coilspring import EquilibriumPath, InputError, Scene
from coilspring.errors import require_number
from coilspring.scene import SEATS
from coilspring.scene.scene import require_motion
from coilspring.words import counted
from validation.study.models import LAWS
from validation.study.partialsolve import partial_path
from validation.sweep.grid import Point, Varied, require_any
from validation.sweep.run import Choice
from wirefe.adaptive import solve_to_either
from wirefe.meshes import Levels, difference
from wirefe.trials import ACCURACIES, NotReached

LEVELS = (4, 6, 8, 12, 16, 24, 32, 48, 64, 96, 128)
CORNERS, INSIDE = 8, 4  # scenes of a sample, at most
MARGIN = 2.0  # between the worst error of a sample and that of the grid
FINER = (4.0, MARGIN)  # accuracy asked for over that of the references, and where that cannot be reached
Candidate = Callable[[Scene], Choice]


class Chosen(NamedTuple):
    """The cheapest candidate that does."""

    candidate: Candidate  # solves a scene by a law or a mesh
    error: float  # the largest on the sample, the error of its references included
    sampled: int  # scenes
    line: str  # for a reader at the terminal
    grid: list[Point]  # without scenes that the wire model refuses


def choose(
    grid: Sequence[Point], varied: Sequence[Varied], accuracy: float, progress: Callable[[str], None]
) -> Chosen:
    """The cheapest law or mesh whose errors on a sample of a grid are within the accuracy, with a margin.

    Raises `InputError`: no candidate does, the wire model is no reference, or no scene can be solved.
    """
    require_number("accuracy", accuracy, *ACCURACIES)
    grid = [_meshed(point) for point in grid]
    require_any(grid)
    points = sample(grid, varied)
    wires = []
    for number, point in enumerate(points, 1):
        progress(f"sample of the grid by the wire model: {number} of {len(points)}")
        wires.append(_reference(point, varied, accuracy))
    least = math.inf
    for name, candidate in _candidates(grid):
        progress(f"sample of the grid by {name}")
        worst = _worst(candidate, wires, accuracy)
        if MARGIN * worst <= accuracy:
            sampled = f"{counted(len(points), 'scene')} of the grid, solved by the wire model"
            why = f"{name}; error up to {worst:.2g} on {sampled}"
            line = f"chosen for an accuracy of {accuracy:g}: {why}"
            return Chosen(candidate, worst, len(points), line, grid)
        least = min(least, worst)
    raise InputError(f"{_refused(accuracy, least)} by one law or mesh for all its scenes, got {accuracy:g}")


def _meshed(point: Point) -> Point:
    """The point, without its scene where the wire model, from which errors are measured, refuses that."""
    if point.scene is None:
        return point
    try:
        require_motion(point.scene)
        point.scene.supports.require_supported("wirefe", SEATS)
        Levels.of(point.scene, None)
    except InputError as error:
        return Point(point.values, None, str(error))
    return point


def _reference(point: Point, varied: Sequence[Varied], accuracy: float) -> EquilibriumPath:
    """The scene of a point by the wire model; `InputError` where that is no reference for the accuracy."""
    assert point.scene is not None
    values = zip(varied, point.values, strict=True)
    where = f"for the scene with {', '.join(f'{each.key} = {value}' for each, value in values)}"
    wanted, enough = (max(accuracy / each, ACCURACIES[0]) for each in FINER)
    try:
        path = partial_path(solve_to_either, point.scene, wanted=wanted, enough=enough)
        error, why = path.estimated_error or 0.0, f"asked for {enough:g}"
        if MARGIN * error <= accuracy:
            return path
    except NotReached as refused:
        error, why = max(refused.reached, accuracy / MARGIN), refused.why
    except InputError as refused:
        raise InputError(f"{refused}, {where} of the grid") from None
    known = "is not known"
    if error < math.inf:
        known = f"is {error:.2g} or more ({why}); the accuracy must be at least {MARGIN:g} times that error"
    reference = f"{where} the error of the reference, solved by the wire model, {known}"
    raise InputError(f"{_refused(accuracy, error)}, got {accuracy:g}: {reference}")


def _refused(accuracy: float, error: float) -> str:
    """What accuracy a grid can have at best, where one of its scenes has an error."""
    if MARGIN * error < ACCURACIES[1]:
        return f"accuracy must be at least {rounded_up(MARGIN * error):g} on this grid"
    return "accuracy cannot be met on this grid"


def rounded_up(number: float) -> float:
    """A positive number with two digits, the next larger one: what a user may ask for."""
    unit = 10.0 ** (math.floor(math.log10(number)) - 1)
    return float(f"{(math.floor(number / unit) + 1) * unit:.2g}")


def sample(grid: Sequence[Point], varied: Sequence[Varied]) -> list[Point]:
    """Points with a scene, one at least, at corners of a grid and some within, the same each time."""
    counts = [len(each.values) for each in varied]
    rng = np.random.default_rng(0)
    corners = np.array(list(product(*({0, count - 1} for count in counts))))
    if len(corners) > CORNERS:
        corners = corners[rng.permutation(len(corners))[:CORNERS]]
    solvable = [place for place, point in enumerate(grid) if point.scene is not None]
    inside = (solvable[place] for place in rng.integers(len(solvable), size=INSIDE))
    at = [*map(int, np.ravel_multi_index(corners.T, counts)), *inside]
    return [point for place in dict.fromkeys(at) if (point := grid[place]).scene is not None]


def _candidates(grid: Sequence[Point]) -> Iterator[tuple[str, Candidate]]:
    """Laws and meshes that fit all scenes, cheap to dear, with their names for a reader."""

    def beam(scene: Scene, law: str) -> Choice:
        return Choice.of("equivbeam", {"law": law, "sliding": "scene"})

    def wire(scene: Scene, level: int) -> Choice:
        return Choice("wirefe", Levels.of(scene, None).options(level))

    for law in LAWS:  # cheaper than any mesh
        yield f"equivbeam, law {law}", partial(beam, law=law)
    multiple = math.lcm(*{Levels.of(point.scene, None).multiple for point in grid if point.scene})
    for level in dict.fromkeys(multiple * math.ceil(level / multiple) for level in LEVELS):
        yield f"wirefe, {level} curved elements per turn", partial(wire, level=level)


def _worst(candidate: Candidate, wires: Sequence[EquilibriumPath], accuracy: float) -> float:
    """Largest error of a candidate, or the first that is too large; infinite where it refuses a scene."""
    worst = 0.0
    for wire in wires:
        try:
            path = partial_path(candidate(wire.scene), wire.scene)
        except InputError:
            return math.inf
        worst = max(worst, difference(path, wire) + (wire.estimated_error or 0.0))
        if MARGIN * worst > accuracy:
            break
    return worst
