"""What the paper leaves open, as inputs that the study varies; ``inputs.toml`` has their ranges and why."""

from __future__ import annotations

import math
import tomllib
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

from coilspring import Scene
from validation.study.cases import turned

BEAM, WIRE = "equivbeam", "wirefe"
MODELS = (BEAM, WIRE)
NOT_GIVEN, READING, AGAINST = "not given", "reading", "against its result"
KINDS = {
    NOT_GIVEN: "the paper says nothing",
    READING: "the paper says something that can be read or made in another way",
    AGAINST: "the paper is silent, but its two models would not have agreed",
    "left out by beams": "the paper's two models, and ours unless asked, take the wire for a straight rod",
}
LIKE = 0.01  # mm: penetration at which both exponents give one force
EVERYWHERE = 20  # sphere pairs per turn that touch wherever the wires do


@dataclass(frozen=True)
class Variant:
    """One value of an open input."""

    value: str  # as tables and figure show it
    scene: Scene  # the scene with that value
    options: Mapping[str, Any] = field(default_factory=dict)  # of the wire model
    base_options: Mapping[str, Any] = field(default_factory=dict)  # of the path it is compared with
    rise: float = 0.0  # height of the loaded point above the top reference point, mm


@dataclass(frozen=True)
class OpenInput:
    """An input that the paper does not pin down."""

    name: str  # in the CSV file
    title: str  # for readers
    kind: str  # of `KINDS`
    default: str  # what every other run of the project takes
    paper: str  # what the paper says
    reason: str  # why this range
    make: Callable[[Scene, str], Iterable[Variant]]  # its values for a scene and a model
    contact: bool = False  # whether scenes without contact have no such input
    models: Sequence[str] = MODELS  # those that have it

    def variants(self, scene: Scene, model: str) -> tuple[Variant, ...]:
        """Its values for a scene and a model; none where the model has no such input there."""
        absent = model not in self.models or (self.contact and not scene.contact.enabled)
        return () if absent else tuple(self.make(scene, model))


def _with(scene: Scene, part: str, **changes: Any) -> Scene:
    """The scene with other values in one of its parts."""
    return replace(scene, **{part: replace(getattr(scene, part), **changes)})


def _exponent(scene: Scene, model: str) -> list[Variant]:
    stiffness = scene.contact.stiffness * LIKE ** (scene.contact.exponent - 1.5)
    return [Variant("1.5", _with(scene, "contact", exponent=1.5, stiffness=stiffness))]


def _phase(scene: Scene, model: str) -> list[Variant]:
    contact = scene.contact.enabled
    pairs = {"pairs_per_turn": EVERYWHERE} if contact and model == WIRE else {}
    angles = range(30, 360, 30) if model == WIRE else [180] * contact
    return [Variant(f"{degrees}°", turned(scene, degrees), pairs, pairs) for degrees in angles]


def _rigid(scene: Scene, model: str) -> Iterator[Variant]:
    """Another rigid part of each end; turns and height of the whole spring and the loaded point stay."""
    spring = scene.spring
    for turns in (0.75, 1.25):
        less = spring.end_turns - turns
        drop = less * spring.wire_diameter
        changed = replace(
            spring,
            end_turns=turns,
            active_coils=spring.active_coils + 2.0 * less,
            active_height=spring.active_height + 2.0 * drop,
            # the beam's stations are half coils from the first active point, wherever that lies
            start_phase=spring.start_phase - (2.0 * math.pi * less if model == WIRE else 0.0),
        )
        yield Variant(f"{turns:g}", replace(scene, spring=changed), rise=-drop)


MAKE: dict[str, Callable[[Scene, str], Iterable[Variant]]] = {
    "E": lambda scene, _: (
        Variant(f"{E:g} GPa", _with(scene, "material", E=1e3 * E)) for E in (196.0, 210.0)
    ),
    "nu": lambda scene, _: (Variant(f"{nu:g}", _with(scene, "material", nu=nu)) for nu in (0.26, 0.32)),
    "reference_height": lambda scene, _: (
        Variant(value, scene, rise=share * scene.spring.wire_diameter)
        for share, value in ((0.5, "+d/2"), (1.0, "+d"))
    ),
    "end_contact": lambda scene, _: [Variant("no", _with(scene, "spring", end_turns=0.0))],
    "rigid_turns": _rigid,
    "start_phase": _phase,
    "sphere_place": lambda scene, _: (Variant(f"{angle}°", turned(scene, angle)) for angle in (15, 30, 45)),
    "pairs": lambda scene, _: (Variant(f"{n}", scene, {"pairs_per_turn": n}) for n in (2, 8, EVERYWHERE)),
    "penalty": lambda scene, _: (
        Variant(value, scene.with_penalty(factor * scene.contact.stiffness))
        for factor, value in ((0.1, "K/10"), (10.0, "10 K"))
    ),
    "exponent": _exponent,
    "friction": lambda scene, _: (
        Variant(f"µ = {mu:g}", _with(scene, "contact", sliding="coulomb", friction=mu)) for mu in (0.1, 0.3)
    ),
    "element": lambda scene, _: [Variant("curved", scene, {"element": "curved"})],
    "wire_rigidity": lambda scene, _: [Variant("solid", _with(scene, "spring", wire_rigidity="solid"))],
}


def _read(file: Path) -> tuple[OpenInput, ...]:
    found = tomllib.loads(file.read_text(encoding="utf-8"))
    return tuple(OpenInput(name, make=MAKE[name], **fields) for name, fields in found.items())


INPUTS = _read(Path(__file__).with_name("inputs.toml"))
