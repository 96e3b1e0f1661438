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
from wirefe.contact.points import PER_TURN

BEAM, WIRE = "equivbeam", "wirefe"
MODELS = (BEAM, WIRE)
NOT_GIVEN, READING, AGAINST = "not given", "reading", "against its result"
KINDS = {
    NOT_GIVEN: "the paper says nothing",
    READING: "the paper says something that can be read or made in another way",
    AGAINST: "the paper is silent, but its two models would not have agreed",
    "left out by beams": "the paper's two models, and ours unless asked, take the wire for a straight rod",
}
VARIED = "varied"  # kind of the inputs of a user's scene
SHARE, POISSON = 0.05, 0.03  # changes of a user's modulus and Poisson's ratio
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
    own: str  # the range for a scene of a user's, and why
    here: str  # its value in a scene of a user's, a format
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


def _on(scene: Scene, degrees: float) -> Scene:
    """The scene with the helix started so much farther on."""
    return turned(scene, math.degrees(scene.spring.start_phase) + degrees)


def _exponent(scene: Scene, model: str) -> list[Variant]:
    other = 1.5 if scene.contact.exponent != 1.5 else 1.0
    stiffness = scene.contact.stiffness * LIKE ** (scene.contact.exponent - other)
    return [Variant(f"{other:g}", _with(scene, "contact", exponent=other, stiffness=stiffness))]


def _spheres(scene: Scene) -> bool:
    """Whether the wire model's contact is of spheres, at few places."""
    return scene.contact.enabled and scene.contact.geometry == "spheres"


def _phase(scene: Scene, model: str) -> list[Variant]:
    pairs = {"pairs_per_turn": EVERYWHERE} if _spheres(scene) and model == WIRE else {}
    angles = range(30, 360, 30) if model == WIRE else [180] * scene.contact.enabled
    return [Variant(f"{degrees}°", _on(scene, degrees), pairs, pairs) for degrees in angles]


def _pairs(scene: Scene, model: str) -> list[Variant]:
    usual = PER_TURN[scene.contact.geometry]
    numbers = (2, 8, EVERYWHERE) if _spheres(scene) else (usual // 2, 2 * usual)
    return [Variant(f"{number}", scene, {"pairs_per_turn": number}) for number in numbers]


def _raisable(scene: Scene) -> bool:
    """Whether `topheight.raised` takes it: rigid ends, one force, no path that matters to a turning top."""
    contact, load, held = scene.contact, scene.load, scene.supports.top_held
    free = "rotz" in held or not contact.enabled or contact.sliding == "free"
    return free and scene.supports.seat == "rigid" and not (load.stages or load.displacement)


def _height(scene: Scene, model: str) -> Iterator[Variant]:
    for share, value in ((0.5, "+d/2"), (1.0, "+d")) if _raisable(scene) else ():
        yield Variant(value, scene, rise=share * scene.spring.wire_diameter)


def _without_ends(scene: Scene, model: str) -> list[Variant]:
    bare = scene.spring.end_turns == 0.0 or scene.supports.seat == "plate"
    return [] if bare else [Variant("no", _with(scene, "spring", end_turns=0.0))]


def _other_rigidity(scene: Scene, model: str) -> list[Variant]:
    other = "solid" if scene.spring.wire_rigidity == "beam" else "beam"
    return [Variant(other, _with(scene, "spring", wire_rigidity=other))]


def _rigid(scene: Scene, model: str) -> Iterator[Variant]:
    """Another rigid part of each end; turns and height of the whole spring and the loaded point stay."""
    spring = scene.spring
    closed = spring.end_turns > 0.0 and spring.ends == "closed" and not spring.sections
    for turns in (spring.end_turns - 0.25, spring.end_turns + 0.25) if closed and _raisable(scene) else ():
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


def _moduli(scene: Scene, values: Iterable[float]) -> Iterator[Variant]:
    yield from (Variant(f"{1e-3 * E:g} GPa", _with(scene, "material", E=E)) for E in values)


def _ratios(scene: Scene, values: Iterable[float]) -> Iterator[Variant]:
    yield from (Variant(f"{nu:g}", _with(scene, "material", nu=nu)) for nu in values)


Make = dict[str, Callable[[Scene, str], Iterable[Variant]]]  # variants of a scene in a model, by input
MAKE: Make = {
    "E": lambda scene, _: _moduli(scene, (196e3, 210e3)),
    "nu": lambda scene, _: _ratios(scene, (0.26, 0.32)),
    "reference_height": _height,
    "end_contact": _without_ends,
    "rigid_turns": _rigid,
    "start_phase": _phase,
    "sphere_place": lambda scene, _: (
        Variant(f"{angle}°", _on(scene, angle)) for angle in (15, 30, 45) if _spheres(scene)
    ),
    "pairs": _pairs,
    "penalty": lambda scene, _: (
        Variant(value, scene.with_penalty(factor * scene.contact.stiffness))
        for factor, value in ((0.1, "K/10"), (10.0, "10 K"))
    ),
    "exponent": _exponent,
    "friction": lambda scene, _: (
        Variant(f"µ = {mu:g}", _with(scene, "contact", sliding="coulomb", friction=mu)) for mu in (0.1, 0.3)
    ),
    "element": lambda scene, _: [Variant("curved", scene, {"element": "curved"})],
    "wire_rigidity": _other_rigidity,
}


# inputs of a user's scene whose values are about its own
MAKE_OWN: Make = {
    "E": lambda scene, _: _moduli(scene, [scene.material.E * (1.0 + change) for change in (-SHARE, SHARE)]),
    "nu": lambda scene, _: _ratios(scene, [scene.material.nu + change for change in (-POISSON, POISSON)]),
}
_TEXT = Path(__file__).with_name("inputs.toml").read_text(encoding="utf-8")
INPUTS = tuple(OpenInput(name, make=MAKE[name], **fields) for name, fields in tomllib.loads(_TEXT).items())


def inputs_of(scene: Scene) -> tuple[OpenInput, ...]:
    """What is varied of a user's scene: what the paper leaves open, about the scene's own values."""
    contact = scene.contact
    sliding = {"free": "none", "none": "sticking"}.get(contact.sliding, f"µ = {contact.coefficient:g}")
    other = {"E": 1e-3 * scene.material.E, "pairs": PER_TURN[contact.geometry], "sliding": sliding}
    here = {item.name: item.here.format(scene=scene, **other) for item in INPUTS}
    made = MAKE | MAKE_OWN
    return tuple(replace(i, kind=VARIED, default=here[i.name], make=made[i.name]) for i in INPUTS)
