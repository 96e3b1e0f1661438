"""What the paper leaves open, as inputs that the study varies; ``inputs.toml`` has their ranges and why."""

import math
import tomllib
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

from coilspring import InputError, Scene
from equivbeam.sensitivity import unit
from validation.study.cases import turned
from validation.study.models import BEAM, MODELS, WIRE
from wirefe.contact.points import PER_TURN

NAMES = {BEAM: "beam", WIRE: "wire model"}
NOT_GIVEN, READING, AGAINST = "not given", "reading", "against its result"
KINDS = {
    NOT_GIVEN: "the paper says nothing",
    READING: "the paper says something that can be read or made in another way",
    AGAINST: "the paper is silent, but its two models would not have agreed",
    "left out by beams": "the paper's two models, and ours unless asked, take the wire for a straight rod",
}
SILENT, OPEN = (NOT_GIVEN,), (NOT_GIVEN, READING)
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
    kind: str  # of `KINDS`, or `VARIED`
    default: str  # what every other run of the project takes
    paper: str  # what the paper says
    reason: str  # why this range
    own: str  # the range for a scene of a user's, and why
    here: str  # its value in a scene of a user's, a format
    contact: bool = False  # whether scenes without contact have no such input
    models: Sequence[str] = MODELS  # those that have it

    def variants(self, scene: Scene, model: str) -> tuple[Variant, ...]:
        """Its values for a scene and a model; none where the model has no such input there."""
        absent = model not in self.models or (self.contact and not scene.contact.enabled)
        return () if absent else tuple(_variants(self.name, scene, model, self.kind == VARIED))


def _variants(name: str, scene: Scene, model: str, own: bool) -> Iterator[Variant]:
    """Values of an input that a scene and a model have; `own`: about the scene's own value."""
    spring, material, contact = scene.spring, scene.material, scene.contact
    spheres = contact.enabled and contact.geometry == "spheres"  # the wires touch at few places
    match name:
        case "E":
            about = (material.E * (1.0 - SHARE), material.E * (1.0 + SHARE))
            for E in about if own else (196e3, 210e3):
                yield Variant(f"{1e-3 * E:g} GPa", _with(scene, "material", E=E))
        case "nu":
            for nu in (material.nu - POISSON, material.nu + POISSON) if own else (0.26, 0.32):
                yield Variant(f"{nu:g}", _with(scene, "material", nu=nu))
        case "reference_height" if scene.supports.seat == "rigid":
            _refuse_unraisable(scene)
            for share, value in ((0.5, "+d/2"), (1.0, "+d")):
                yield Variant(value, scene, rise=share * spring.wire_diameter)
        case "end_contact" if spring.end_turns > 0.0 and scene.supports.seat != "plate":
            yield Variant("no", _with(scene, "spring", end_turns=0.0))
        case "rigid_turns" if scene.supports.seat == "rigid":
            if spring.ends != "closed" or spring.sections:
                raise InputError("varied if spring.ends is closed and there are no spring.sections")
            _refuse_unraisable(scene)
            yield from _rigid(scene, model)
        case "start_phase":
            pairs = {"pairs_per_turn": EVERYWHERE} if spheres and model == WIRE else {}
            for angle in range(30, 360, 30) if model == WIRE else [180] * contact.enabled:
                yield Variant(f"{angle}°", _on(scene, angle), pairs, pairs)
        case "sphere_place" if spheres:
            for angle in (15, 30, 45):
                yield Variant(f"{angle}°", _on(scene, angle))
        case "pairs":
            usual = PER_TURN[contact.geometry]
            for number in (2, 8, EVERYWHERE) if spheres else (usual // 2, 2 * usual):
                yield Variant(f"{number}", scene, {"pairs_per_turn": number})
        case "penalty":
            for factor, value in ((0.1, "K/10"), (10.0, "10 K")):
                yield Variant(value, scene.with_penalty(factor * contact.stiffness))
        case "exponent":
            other = 1.5 if contact.exponent != 1.5 else 1.0
            stiffness = contact.stiffness * LIKE ** (contact.exponent - other)
            yield Variant(f"{other:g}", _with(scene, "contact", exponent=other, stiffness=stiffness))
        case "friction":
            for mu in (0.1, 0.3):
                yield Variant(f"µ = {mu:g}", _with(scene, "contact", sliding="coulomb", friction=mu))
        case "element":
            yield Variant("curved", scene, {"element": "curved"})
        case "wire_rigidity":
            rigidity = "solid" if spring.wire_rigidity == "beam" else "beam"
            yield Variant(rigidity, _with(scene, "spring", wire_rigidity=rigidity))


def _with(scene: Scene, part: str, **changes: Any) -> Scene:
    """The scene with other values in one of its parts."""
    return replace(scene, **{part: replace(getattr(scene, part), **changes)})


def _on(scene: Scene, degrees: float) -> Scene:
    """The scene with the helix started so much farther on."""
    return turned(scene, math.degrees(scene.spring.start_phase) + degrees)


def _refuse_unraisable(scene: Scene) -> None:
    """Refuse a top that turns where `topheight.raised` cannot move the loaded point."""
    contact, load = scene.contact, scene.load
    if "rotz" in scene.supports.top_held:  # it moves without turning, all its points alike
        return
    if load.stages or load.displacement:
        given = "stages" if load.stages else "displacement"
        raise InputError(f"varied if load.force is given or supports.top_held has rotz, got load.{given}")
    if contact.enabled and contact.sliding != "free":
        free = "varied if contact.sliding is free or supports.top_held has rotz"
        raise InputError(f"{free}, got {contact.sliding}")


def _rigid(scene: Scene, model: str) -> Iterator[Variant]:
    """Another rigid part of each end; turns and height of the whole spring and the loaded point stay."""
    spring = scene.spring
    for turns in (spring.end_turns - 0.25, spring.end_turns + 0.25) if spring.end_turns > 0.0 else ():
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


_TEXT = Path(__file__).with_name("inputs.toml").read_text(encoding="utf-8")
INPUTS = tuple(OpenInput(name, **fields) for name, fields in tomllib.loads(_TEXT).items())


def inputs_of(scene: Scene) -> tuple[OpenInput, ...]:
    """What is varied of a user's scene: what the paper leaves open, about the scene's own values."""
    contact = scene.contact
    sliding = {"free": "none", "none": "sticking"}.get(contact.sliding, f"µ = {contact.coefficient:g}")
    other = {"E": 1e-3 * scene.material.E, "pairs": PER_TURN[contact.geometry], "sliding": sliding}
    other["unit"] = unit(scene, "penalty")
    return tuple(replace(i, kind=VARIED, default=i.here.format(scene=scene, **other)) for i in INPUTS)
