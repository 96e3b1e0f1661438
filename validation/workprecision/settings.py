"""What the work-precision study runs: springs, and every setting of both models."""

from contextlib import suppress
from dataclasses import asdict, dataclass, replace
from typing import Self

from coilspring import InputError, Scene
from coilspring.words import counted
from validation.study.models import LAWS, PAPER_LAW
from wirefe.contact.points import PER_TURN
from wirefe.mesh import mesh_wire

STEPS = 50  # of the paper, and of every scene here
PAIRS = PER_TURN["spheres"]  # a turn, as in the paper's mesh; other numbers are other contact models
PAPER_ELEMENTS = 40
SERIES = ("straight", "curved", *LAWS)
PEER = "opensees"


@dataclass(frozen=True)
class Setting:
    """One model with its numerics; columns of the result."""

    series: str  # element of the wire model, law of the equivalent beam, or `PEER`
    elements_per_turn: int = 0  # 0 for the equivalent beam, which has one length of element
    pairs_per_turn: int = 0  # of spheres or stations; 0 for the equivalent beam
    tangent: str = ""  # of the equivalent beam; empty for the wire model
    sliding: str = ""  # of the equivalent beam; empty for the wire model
    steps: int = STEPS  # equal steps of time
    geometry: str = ""  # of the wire model's contact, the scene's; empty for the equivalent beam

    @classmethod
    def wire(cls, scene: Scene, series: str, mesh: int, pairs: int = 0, steps: int = STEPS) -> Self:
        """Of the wire model, or `PEER`; by default with the usual number of pairs."""
        geometry = scene.contact.geometry
        return cls(series, mesh, pairs or PER_TURN[geometry], steps=steps, geometry=geometry)

    @property
    def usual_pairs(self) -> bool:
        """Whether the pairs are as many as the scene's kind of contact has unless asked otherwise."""
        return self.pairs_per_turn == PER_TURN.get(self.geometry, 0)

    @property
    def model(self) -> str:
        """The model's package, or `PEER`."""
        if self.series == PEER:
            return PEER
        return "wirefe" if self.elements_per_turn else "equivbeam"

    @property
    def options(self) -> dict[str, object]:
        """Keyword arguments of the model's `solve`."""
        chosen = {name: value for name, value in asdict(self).items() if value}
        del chosen["series"]
        chosen.pop("geometry", None)  # which the scene has
        return chosen | {"element" if self.elements_per_turn else "law": self.series}

    @property
    def label(self) -> str:
        """Name for a reader."""
        mesh, model = self.elements_per_turn, "wire" if self.elements_per_turn else "beam"
        name = "OpenSees" if self.series == PEER else f"{model} {self.series}"
        parts = {
            f"{name} {mesh}" if mesh else name: True,
            "paper’s tangent": self.tangent == "paper",
            "scene’s sliding": self.sliding == "scene",
            f"{self.pairs_per_turn} pairs per turn": not self.usual_pairs,
            counted(self.steps, "step"): True,
        }
        return ", ".join(part for part, said in parts.items() if said)

    @property
    def is_paper_mesh(self) -> bool:
        """Whether it is the paper's FE mesh with a scene's usual steps."""
        mesh = (self.series, self.elements_per_turn, self.steps)
        return self.usual_pairs and mesh == ("straight", PAPER_ELEMENTS, STEPS)


PAPER_MODEL = Setting(PAPER_LAW, tangent="exact", sliding="ignore")


@dataclass(frozen=True)
class Extent:
    """How much is run."""

    straight: tuple[int, ...]  # elements per turn, straight ones
    curved: tuple[int, ...]  # elements per turn, curved ones
    reference: int  # curved elements per turn of the reference; half of it gives the reference's error
    steps: tuple[int, ...]  # other numbers of steps; divisors of `Extent.finest`
    pairs: tuple[int, ...]  # other sphere pairs per turn; of stations of wires as many times more
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
EXTENTS = {"quick": QUICK, "normal": NORMAL, "full": FULL}

TITLES = {
    "spring-a": "Spring A",
    "spring-a-no-contact": "Spring A, no contact",
    "spring-b": "Spring B",
    "spring-b-no-contact": "Spring B, no contact",
    "cylinder-lateral": "cylinder C = 10, lateral load",
    "slender-axial": "slender cylinder, axial load",
}


def title(scene: str) -> str:
    """Name of a scene for a reader; of a user's, its own."""
    return TITLES.get(scene, scene)


def fitted(scene: Scene, mesh: int, pairs: int = PAIRS) -> int:
    """Elements per turn, `mesh` or a few more, whose nodes meet the ends of the coils, and spheres.

    The paper's mesh has to meet them, too, so that farther than to its next multiple none is looked for.
    """
    pairs = pairs if scene.contact.geometry == "spheres" else 1
    for count in range(mesh, mesh + PAPER_ELEMENTS):
        with suppress(InputError):
            mesh_wire(scene.spring, count, scene.supports.seat == "plate")
            if count % pairs == 0:
                return count
    return mesh  # which the wire model refuses, and says why


def settings(scene: Scene, extent: Extent) -> tuple[Setting, ...]:
    """Every setting that makes sense for a scene, the wire model's first, each once."""
    found, contact = [], scene.contact
    for element, meshes in (("straight", extent.straight), ("curved", extent.curved)):
        found += [Setting.wire(scene, element, fitted(scene, mesh)) for mesh in meshes]
    for steps in extent.steps:
        found.append(Setting.wire(scene, "straight", PAPER_ELEMENTS, steps=steps))
        found.append(Setting.wire(scene, "curved", fitted(scene, extent.curved[0]), steps=steps))
    for pairs in (PAIRS, *extent.pairs) if contact.enabled else ():
        mesh, times = fitted(scene, max(16, pairs), pairs), PER_TURN[contact.geometry] // PAIRS
        found.append(Setting.wire(scene, "curved", mesh, times * pairs))
    for law in LAWS:
        usual = Setting(law, tangent="exact", sliding="ignore")
        found += [replace(usual, steps=steps) for steps in (STEPS, *extent.steps)]
        if contact.enabled and contact.sliding != "free":
            found.append(replace(usual, sliding="scene"))
    return tuple(dict.fromkeys((*found, replace(PAPER_MODEL, tangent="paper"))))
