"""The paper's four cases, what it prints of them, and their paths, each solved once and kept."""

import math
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from functools import cache
from io import BytesIO
from typing import Any

import equivbeam
import wirefe
from coilspring import CATALOGUE, EquilibriumNotFound, EquilibriumPath, Scene, load_path, spring_b
from coilspring.solver.startup import background
from equivbeam.laws import law_of
from validation.study.keys import run_key
from validation.study.partialsolve import partial_path
from validation.study.store import Store

WIRE_KERNELS = (
    "from wirefe.solve import KERNELS; "
    "from coilspring.solver.startup import compile_kernels; compile_kernels(KERNELS)"
)
PATH = "path.npz"  # of an entry of the store
# the paper's proposed model, solved with the exact tangent
PAPER_BEAM: dict[str, Any] = {"law": "haringx", "tangent": "exact", "sliding": "ignore"}
# the paper's FE mesh (its Table 2)
PAPER_MESH: dict[str, Any] = {"element": "straight", "elements_per_turn": 40, "pairs_per_turn": 4}
FINE_MESH = PAPER_MESH | {"elements_per_turn": 80}  # to estimate the error of that mesh


def paper_mesh(scene: Scene) -> dict[str, Any]:
    """The paper's mesh for a scene; of stations of wires, which it lacks, the wire model's own number."""
    return PAPER_MESH if scene.contact.geometry == "spheres" else PAPER_MESH | {"pairs_per_turn": None}


@dataclass(frozen=True)
class Case:
    """One row of the paper's Table 3."""

    name: str  # scene of the catalogue
    title: str  # as the paper calls it
    paper_wire: float  # the paper's solution time of FE, s
    paper_beam: float  # the paper's solution time of the proposed model, s
    paper_reduction: float  # as the paper prints it, %

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


def solve_beam(scene: Scene, **options: Any) -> EquilibriumPath:
    """Path of the equivalent beam, solved anew; by default the paper's."""
    return equivbeam.solve(scene, **(PAPER_BEAM | options))


def solve_wire(scene: Scene, **options: Any) -> EquilibriumPath:
    """Path of the wire model, solved anew; by default on the paper's mesh."""
    return wirefe.solve(scene, **(paper_mesh(scene) | options))


@cache
def make_ready() -> None:
    """Compile the wire model's kernels in a subprocess while this process compiles the others; once."""
    with background(WIRE_KERNELS):
        partial_path(equivbeam.solve, spring_b(), steps=1)  # an edited law may have no path


@dataclass
class PathStore:
    """Paths of both models, solved when first asked for unless they are in the store."""

    announce: Callable[[str], None]  # called with one line before each solve
    store: Store = field(default_factory=lambda: Store(None))  # of what was solved before
    _paths: dict[str, EquilibriumPath] = field(default_factory=dict)
    _ready: bool = False

    def beam(self, scene: Scene, **options: object) -> EquilibriumPath:
        """Path of the equivalent beam; raises `EquilibriumNotFound` unless completed."""
        return _completed(self.partial_beam(scene, **options))

    def wire(self, scene: Scene, **options: object) -> EquilibriumPath:
        """Path of the wire model; raises `EquilibriumNotFound` unless completed."""
        return _completed(self.partial_wire(scene, **options))

    def partial_beam(self, scene: Scene, **options: object) -> EquilibriumPath:
        """Path of the equivalent beam as far as it was reached; its outcome says why it ended."""
        chosen = PAPER_BEAM | options
        return self._reached("equivbeam", solve_beam, scene, chosen | {"law": law_of(chosen["law"])})

    def partial_wire(self, scene: Scene, **options: object) -> EquilibriumPath:
        """Path of the wire model as far as it was reached; its outcome says why it ended."""
        return self._reached("wirefe", solve_wire, scene, paper_mesh(scene) | options)

    def make_ready(self) -> None:
        """Make the kernels ready, from the sources as they are: what is solved is kept under their digest."""
        if not self._ready:
            self.announce("making the kernels ready")
            make_ready()
            self._ready = True

    def _reached(
        self, model: str, solve: Callable[..., EquilibriumPath], scene: Scene, options: dict[str, object]
    ) -> EquilibriumPath:
        key = run_key(model, scene, options)
        if key not in self._paths:
            files = self.store.get(key)
            if files is None:
                self.make_ready()
                self.announce(f"{solve.__name__.replace('_', ' ')}: {scene.name}")
                path, stream = partial_path(solve, scene, **options), BytesIO()
                path.save(stream)
                self.store.put(key, {PATH: stream.getvalue()})
            else:
                path = load_path(BytesIO(files[PATH]))
            self._paths[key] = path
        return self._paths[key]


def _completed(path: EquilibriumPath) -> EquilibriumPath:
    if path.outcome != "completed":
        raise EquilibriumNotFound(path)
    return path


def turned(scene: Scene, degrees: float) -> Scene:
    """The scene with the helix started at another phase."""
    return replace(scene, spring=replace(scene.spring, start_phase=math.radians(degrees)))
