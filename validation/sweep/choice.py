"""The cheapest law or mesh for a grid of scenes: the first that does on a sample, by the wire model."""

import math
from collections.abc import Callable, Iterator, Sequence
from functools import partial
from itertools import product
from typing import NamedTuple

import numpy as np

import wirefe
from coilspring import EquilibriumPath, InputError, Scene
from coilspring.errors import require_number
from coilspring.words import counted
from validation.study.partialsolve import partial_path
from validation.sweep.grid import Point, Varied
from validation.sweep.run import Choice
from wirefe.adaptive import ACCURACIES
from wirefe.meshes import Levels, difference, on_plates

LAWS = ("haringx", "helix")  # cheap to dear, and cheaper than any mesh
LEVELS = (4, 6, 8, 12, 16, 24, 32, 48, 64, 96, 128)
CORNERS, INSIDE = 8, 4  # scenes of a sample, at most
MARGIN = 2.0  # between the worst error of a sample and that of the grid
FINER = 4.0  # accuracy asked for over that of the references
Candidate = Callable[[Scene], Choice]


class Chosen(NamedTuple):
    """The cheapest candidate that does."""

    candidate: Candidate  # solves a scene by a law or a mesh
    error: float  # the largest on the sample, the error of its references included
    sampled: int  # scenes
    line: str  # for a reader at the terminal


def choose(
    grid: Sequence[Point], varied: Sequence[Varied], accuracy: float, progress: Callable[[str], None]
) -> Chosen:
    """The cheapest law or mesh whose errors on a sample of a grid are within the accuracy, with a margin.

    Raises `InputError`: no candidate does, or the wire model cannot tell.
    """
    require_number("accuracy", accuracy, *ACCURACIES)
    scenes = sample(grid, varied)
    if not scenes:
        raise InputError("accuracy needs a scene of the grid that can be solved, got none")
    wires = []
    for number, scene in enumerate(scenes, 1):
        progress(f"sample of the grid by the wire model: {number} of {len(scenes)}")
        wires.append(partial_path(wirefe.solve_to, scene, accuracy=max(accuracy / FINER, ACCURACIES[0])))
    least = math.inf
    for name, candidate in _candidates(grid):
        progress(f"sample of the grid by {name}")
        worst = _worst(candidate, wires, accuracy)
        if MARGIN * worst <= accuracy:
            sampled = f"{counted(len(scenes), 'scene')} of the grid, solved by the wire model"
            why = f"{name}; error up to {worst:.2g} on {sampled}"
            return Chosen(candidate, worst, len(scenes), f"chosen for an accuracy of {accuracy:g}: {why}")
        least = min(least, worst)
    can = (
        f"must be at least {rounded_up(MARGIN * least):g}"
        if MARGIN * least < ACCURACIES[1]
        else "cannot be met"
    )
    raise InputError(f"accuracy {can} on this grid by one law or mesh for all its scenes, got {accuracy:g}")


def rounded_up(number: float) -> float:
    """A positive number with two digits, the next larger one: what a user may ask for."""
    unit = 10.0 ** (math.floor(math.log10(number)) - 1)
    return float(f"{(math.floor(number / unit) + 1) * unit:.2g}")


def sample(grid: Sequence[Point], varied: Sequence[Varied]) -> list[Scene]:
    """Scenes at corners of a grid and some within, the same each time."""
    counts = [len(each.values) for each in varied]
    rng = np.random.default_rng(0)
    corners = np.array(list(product(*({0, count - 1} for count in counts))))
    if len(corners) > CORNERS:
        corners = corners[rng.permutation(len(corners))[:CORNERS]]
    at = [*np.ravel_multi_index(corners.T, counts), *rng.integers(len(grid), size=INSIDE)]
    return [scene for place in dict.fromkeys(map(int, at)) if (scene := grid[place].scene) is not None]


def _candidates(grid: Sequence[Point]) -> Iterator[tuple[str, Candidate]]:
    """Laws and meshes that fit all scenes, cheap to dear, with their names for a reader."""

    def beam(scene: Scene, law: str) -> Choice:
        return Choice.of("equivbeam", {"law": law, "sliding": "scene"})

    def wire(scene: Scene, level: int) -> Choice:
        return Choice("wirefe", Levels.of(scene, None).options(level))

    for law in LAWS:
        yield f"equivbeam, law {law}", partial(beam, law=law)
    multiple = math.lcm(*{Levels.of(point.scene, None).multiple for point in grid if point.scene})
    one_each = {on_plates(point.scene): point.scene for point in grid if point.scene}.values()
    for level in dict.fromkeys(multiple * math.ceil(level / multiple) for level in LEVELS):
        meshes = (Levels.of(scene, None).options(level) for scene in one_each)
        elements = sorted("{elements_per_turn} {element}".format(**mesh) for mesh in meshes)
        yield f"wirefe, {' or '.join(elements)} elements per turn", partial(wire, level=level)


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
