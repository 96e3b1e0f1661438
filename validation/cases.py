"""The paper's four cases, what it prints of them, and their paths, each solved once."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

import equivbeam
import wirefe
from coilspring import CATALOGUE, EquilibriumNotFound, EquilibriumPath, Scene
from validation.reached import as_far

# the paper's FE mesh (its Table 2)
PAPER_MESH = {"element": "straight", "elements_per_turn": 40, "pairs_per_turn": 4}
FINE_MESH = PAPER_MESH | {"elements_per_turn": 80}  # to estimate the error of that mesh


@dataclass(frozen=True)
class Case:
    """One row of the paper's Table 3.

    Attributes
    ----------
    name : scene of the catalogue.
    title : as the paper calls it.
    paper_wire, paper_beam : the paper's solution times of FE and of the proposed model, s.
    paper_reduction : as the paper prints it, %.
    """

    name: str
    title: str
    paper_wire: float
    paper_beam: float
    paper_reduction: float

    @property
    def scene(self) -> Scene:
        """The scene that is solved."""
        return CATALOGUE[self.name]()


CASES = (
    Case("spring-a", "Spring A", 154.0, 24.0, 84.0),
    Case("spring-a-no-contact", "Spring A w/o contacts", 81.0, 38.0, 53.0),
    Case("spring-b", "Spring B", 122.0, 8.0, 93.0),
    Case("spring-b-no-contact", "Spring B w/o contacts", 68.0, 4.0, 94.0),
)


def case(name: str) -> Case:
    """The case of a catalogue scene."""
    return next(item for item in CASES if item.name == name)


def solve_beam(scene: Scene, **options: object) -> EquilibriumPath:
    """Path of the equivalent beam, solved anew."""
    return equivbeam.solve(scene, **options)


def solve_wire(scene: Scene, **options: object) -> EquilibriumPath:
    """Path of the wire model, solved anew; by default on the paper's mesh."""
    return wirefe.solve(scene, **(PAPER_MESH | options))


@dataclass
class PathStore:
    """Paths of both models, solved when first asked for and kept.

    Attributes
    ----------
    announce : called with one line before each solve.
    """

    announce: Callable[[str], None]
    _paths: dict[tuple, EquilibriumPath] = field(default_factory=dict)

    def beam(self, scene: Scene, **options: object) -> EquilibriumPath:
        """Path of the equivalent beam; raises `EquilibriumNotFound` unless completed."""
        return _completed(self._reached(solve_beam, scene, options))

    def wire(self, scene: Scene, **options: object) -> EquilibriumPath:
        """Path of the wire model; raises `EquilibriumNotFound` unless completed."""
        return _completed(self._reached(solve_wire, scene, options))

    def beam_as_far(self, scene: Scene, **options: object) -> EquilibriumPath:
        """Path of the equivalent beam as far as it was reached; its outcome says why it ended."""
        return self._reached(solve_beam, scene, options)

    def wire_as_far(self, scene: Scene, **options: object) -> EquilibriumPath:
        """Path of the wire model as far as it was reached; its outcome says why it ended."""
        return self._reached(solve_wire, scene, options)

    def _reached(
        self, solve: Callable[..., EquilibriumPath], scene: Scene, options: dict[str, object]
    ) -> EquilibriumPath:
        key = (solve.__name__, scene, tuple(sorted(options.items())))
        if key not in self._paths:
            self.announce(f"{solve.__name__.replace('_', ' ')}: {scene.name}")
            self._paths[key] = as_far(solve, scene, **options)
        return self._paths[key]


def _completed(path: EquilibriumPath) -> EquilibriumPath:
    if path.outcome != "completed":
        raise EquilibriumNotFound(path)
    return path
