"""Paths of both models, by default as in the paper: solved anew, or once and kept."""

from collections.abc import Callable
from dataclasses import dataclass, field
from functools import cache
from io import BytesIO
from typing import Any

import equivbeam
import wirefe
from coilspring import EquilibriumNotFound, EquilibriumPath, Scene, load_path, spring_b
from coilspring.solver.startup import background
from equivbeam.laws import law_of
from validation.study.cases import PAPER_BEAM, paper_mesh
from validation.study.keys import run_key
from validation.study.models import BEAM, WIRE
from validation.study.partialsolve import partial_path
from validation.study.store import Store

PATH = "path.npz"  # of an entry of the store

WIRE_KERNELS = (
    "from wirefe.solve import KERNELS; "
    "from coilspring.solver.startup import compile_kernels; compile_kernels(KERNELS)"
)


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
        return self._reached(BEAM, solve_beam, scene, chosen | {"law": law_of(chosen["law"])})

    def partial_wire(self, scene: Scene, **options: object) -> EquilibriumPath:
        """Path of the wire model as far as it was reached; its outcome says why it ended."""
        return self._reached(WIRE, solve_wire, scene, paper_mesh(scene) | options)

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
