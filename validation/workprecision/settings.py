"""What the work-precision study runs: springs, and every setting of both models."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import asdict, dataclass, replace

from coilspring import Scene
from equivbeam.laws import LAWS

STEPS = 50  # of the paper, and of every scene here
PAIRS = 4  # a turn, as in the paper's mesh; other numbers are other contact models
PAPER_LAW, PAPER_ELEMENTS = "haringx", 40
SERIES = ("straight", "curved", *LAWS)
PEER = "opensees"


@dataclass(frozen=True)
class Setting:
    """One model with its numerics; columns of the result."""

    series: str  # element of the wire model, law of the equivalent beam, or `PEER`
    elements_per_turn: int = 0  # 0 for the equivalent beam, which has one length of element
    pairs_per_turn: int = 0  # sphere pairs; 0 for the equivalent beam
    tangent: str = ""  # of the equivalent beam; empty for the wire model
    sliding: str = ""  # of the equivalent beam; empty for the wire model
    steps: int = STEPS  # equal steps of time

    @property
    def model(self) -> str:
        """The model's package, or `PEER`."""
        if self.series == PEER:
            return PEER
        return "wirefe" if self.elements_per_turn else "equivbeam"

    @property
    def options(self) -> dict[str, object]:
        """Keyword arguments of the model's `solve`."""
        chosen = {name: value for name, value in asdict(self).items() if value and name != "series"}
        return chosen | {"element" if self.elements_per_turn else "law": self.series}

    @property
    def label(self) -> str:
        """Name for a reader."""
        if self.series == PEER:
            return f"OpenSees {self.elements_per_turn}, {self.steps} steps"
        mesh, pairs = self.elements_per_turn, self.pairs_per_turn
        parts = [f"wire {self.series} {mesh}" if mesh else f"beam {self.series}"]
        parts += ["paper’s tangent"] if self.tangent == "paper" else []
        parts += ["scene’s sliding"] if self.sliding == "scene" else []
        parts += [f"{pairs} pairs per turn"] if mesh and pairs != PAIRS else []
        return ", ".join([*parts, f"{self.steps} step{'s' if self.steps != 1 else ''}"])

    @property
    def is_paper_mesh(self) -> bool:
        """Whether it is the paper's FE mesh with a scene's usual steps."""
        return self == Setting("straight", PAPER_ELEMENTS, PAIRS)

    @property
    def is_paper_model(self) -> bool:
        """Whether it is the paper's equivalent beam, solved with the exact tangent."""
        return self == Setting(PAPER_LAW, tangent="exact", sliding="ignore")


@dataclass(frozen=True)
class Extent:
    """How much is run."""

    straight: tuple[int, ...]  # elements per turn, straight ones
    curved: tuple[int, ...]  # elements per turn, curved ones
    reference: int  # curved elements per turn of the reference; half of it tells the reference's error
    steps: tuple[int, ...]  # other numbers of steps; divisors of `Extent.finest`
    pairs: tuple[int, ...]  # other sphere pairs per turn
    rounds: int  # timed rounds
    peers: tuple[tuple[int, int], ...] = ()  # elements per turn and steps of OpenSees, which is slow
    peer_rounds: int = 1  # timed rounds of OpenSees
    finest = 200  # steps of the reference: every number of steps here divides it


QUICK = Extent((8, 20, 40), (4, 8), 32, (1, 10), (8,), 3, ((40, STEPS),))
NORMAL = Extent(
    straight=(8, 12, 20, 40, 80, 160),
    curved=(4, 8, 12, 16, 32),
    reference=64,
    steps=(1, 2, 5, 10, 25, 100, 200),
    pairs=(2, 8, 16),
    rounds=7,
    peers=((20, STEPS), (40, STEPS), (80, STEPS), (40, 10), (40, 100)),
    peer_rounds=3,
)
FULL = replace(
    NORMAL,
    straight=(4, 8, 12, 20, 40, 80, 160, 320),
    curved=(4, 8, 12, 16, 32, 64, 160),
    reference=320,
    pairs=(2, 8, 16, 32),
)


TITLES = {
    "spring-a": "Spring A",
    "spring-a-no-contact": "Spring A, no contact",
    "spring-b": "Spring B",
    "spring-b-no-contact": "Spring B, no contact",
    "cylinder-lateral": "cylinder C = 10, lateral load",
    "slender-axial": "slender cylinder, axial load",
}


def settings(scene: Scene, extent: Extent) -> tuple[Setting, ...]:
    """Every setting that makes sense for a scene."""
    return tuple(dict.fromkeys((*_wires(scene, extent), *_beams(scene, extent))))


def _wires(scene: Scene, extent: Extent) -> Iterable[Setting]:
    meshes = [("straight", mesh) for mesh in extent.straight] + [("curved", mesh) for mesh in extent.curved]
    yield from (Setting(element, mesh, PAIRS) for element, mesh in meshes)
    for steps in extent.steps:
        yield Setting("straight", PAPER_ELEMENTS, PAIRS, steps=steps)
        yield Setting("curved", extent.curved[0], PAIRS, steps=steps)
    if scene.contact.enabled:
        yield from (Setting("curved", max(16, pairs), pairs) for pairs in (PAIRS, *extent.pairs))


def _beams(scene: Scene, extent: Extent) -> Iterable[Setting]:
    sticking = scene.contact.enabled and scene.contact.sliding != "free"
    for series in LAWS:
        for steps in (STEPS, *extent.steps):
            yield Setting(series, steps=steps, tangent="exact", sliding="ignore")
        if sticking:
            yield Setting(series, tangent="exact", sliding="scene")
    yield Setting(PAPER_LAW, tangent="paper", sliding="ignore")


EXTENTS = {"quick": QUICK, "normal": NORMAL, "full": FULL}
