"""What the paper leaves open, in which range, and why: the inputs that the study varies."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass, field, replace
from typing import Any

from coilspring import Scene
from validation.study.cases import turned

BEAM, WIRE = "equivbeam", "wirefe"
MODELS = (BEAM, WIRE)
NOT_GIVEN, READING, AGAINST, BEAMS = "not given", "reading", "against its result", "left out by beams"
KINDS = {
    NOT_GIVEN: "the paper says nothing",
    READING: "the paper says something that can be read or made in another way",
    AGAINST: "the paper is silent, but its two models would not have agreed",
    BEAMS: "the paper's two models, and ours unless asked, take the wire for a straight rod",
}
LIKE = 0.01  # mm: penetration at which both exponents give one force
EVERYWHERE = 20  # sphere pairs per turn that touch wherever the wires do


@dataclass(frozen=True)
class Variant:
    """One value of an open input.

    Attributes
    ----------
    value : as tables and figure show it.
    scene : the scene with that value.
    options, base_options : of the wire model, for the variant and for the path it is compared with.
    rise : height of the loaded point above the top reference point, mm.
    """

    value: str
    scene: Scene
    options: Mapping[str, Any] = field(default_factory=dict)
    base_options: Mapping[str, Any] = field(default_factory=dict)
    rise: float = 0.0


@dataclass(frozen=True)
class OpenInput:
    """An input that the paper does not pin down.

    Attributes
    ----------
    name : in the CSV file.
    title : for readers.
    kind : of `KINDS`.
    default : what every other run of the project takes.
    paper, reason : what the paper says; why this range.
    make : its values for a scene and a model.
    contact : whether scenes without contact have no such input.
    models : those that have it.
    """

    name: str
    title: str
    kind: str
    default: str
    paper: str
    reason: str
    make: Callable[[Scene, str], Iterable[Variant]]
    contact: bool = False
    models: tuple[str, ...] = MODELS

    def variants(self, scene: Scene, model: str) -> tuple[Variant, ...]:
        """Its values for a scene and a model; none where the model has no such input there."""
        absent = model not in self.models or (self.contact and not scene.contact.enabled)
        return () if absent else tuple(self.make(scene, model))


def _modulus(scene: Scene, model: str) -> Iterator[Variant]:
    for E in (196.0, 210.0):
        yield Variant(f"{E:g} GPa", replace(scene, material=replace(scene.material, E=1e3 * E)))


def _poisson(scene: Scene, model: str) -> Iterator[Variant]:
    for nu in (0.26, 0.32):
        yield Variant(f"{nu:g}", replace(scene, material=replace(scene.material, nu=nu)))


def _penalty(scene: Scene, model: str) -> Iterator[Variant]:
    for factor, value in ((0.1, "K/10"), (10.0, "10 K")):
        yield Variant(value, scene.with_penalty(factor * scene.contact.stiffness))


def _exponent(scene: Scene, model: str) -> Iterator[Variant]:
    stiffness = scene.contact.stiffness * LIKE ** (scene.contact.exponent - 1.5)
    yield Variant("1.5", _with_contact(scene, exponent=1.5, stiffness=stiffness))


def _friction(scene: Scene, model: str) -> Iterator[Variant]:
    for mu in (0.1, 0.3):
        yield Variant(f"µ = {mu:g}", _with_contact(scene, sliding="coulomb", friction=mu))


def _phase(scene: Scene, model: str) -> Iterator[Variant]:
    contact = scene.contact.enabled
    pairs = {"pairs_per_turn": EVERYWHERE} if contact and model == WIRE else {}
    for degrees in range(30, 360, 30) if model == WIRE else [180] * contact:
        yield Variant(f"{degrees}°", turned(scene, degrees), pairs, pairs)


def _spheres(scene: Scene, model: str) -> Iterator[Variant]:
    for degrees in (15, 30, 45):
        yield Variant(f"{degrees}°", turned(scene, degrees))


def _pairs(scene: Scene, model: str) -> Iterator[Variant]:
    for n in (2, 8, EVERYWHERE):
        yield Variant(f"{n}", scene, {"pairs_per_turn": n})


def _height(scene: Scene, model: str) -> Iterator[Variant]:
    for share, value in ((0.5, "+d/2"), (1.0, "+d")):
        yield Variant(value, scene, rise=share * scene.spring.wire_diameter)


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


def _touching_ends(scene: Scene, model: str) -> Iterator[Variant]:
    yield Variant("no", replace(scene, spring=replace(scene.spring, end_turns=0.0)))


def _element(scene: Scene, model: str) -> Iterator[Variant]:
    yield Variant("curved", scene, {"element": "curved"})


def _solid(scene: Scene, model: str) -> Iterator[Variant]:
    yield Variant("solid", replace(scene, spring=replace(scene.spring, wire_rigidity="solid")))


def _with_contact(scene: Scene, **changes: Any) -> Scene:
    return replace(scene, contact=replace(scene.contact, **changes))


INPUTS = (
    OpenInput(
        "E", "Young's modulus", NOT_GIVEN, "206 GPa", "names no material",
        "196: cold-drawn carbon wire in American design tables (28.5e6 psi, from memory); 206: EN 10270-1; "
        "210: steel in textbooks. The 200 GPa that FE programs offer for steel lie between. Stainless "
        "spring wire (185 to 195) is left out.",
        _modulus,
    ),
    OpenInput(
        "nu", "Poisson's ratio", NOT_GIVEN, "0.3", "names no material",
        "0.26: E 206 with G 81.5 GPa, the pair that goes with EN 10270-1; 0.32: E 210 with the G 79.3 of "
        "American tables (11.5e6 psi).",
        _poisson,
    ),
    OpenInput(
        "reference_height", "height of the loaded point", NOT_GIVEN, "28.6 mm",
        "loads a 'central node' of the rigid end turn and does not say where it lies",
        "ours is the end of the active wire, the lowest place there is on the end turn; +d/2: its middle; "
        "+d: its upper end. Load and displacements go with the point. The bottom point is fixed: its height "
        "has no influence. A top that does not turn (Spring B) has none either.",
        _height,
    ),
    OpenInput(
        "end_contact", "contact of the end turns", NOT_GIVEN, "yes",
        "does not say whether the end turns carry contact elements or circles",
        "no: only active coils touch each other.",
        _touching_ends, contact=True,
    ),
    OpenInput(
        "rigid_turns", "rigid turns at each end", READING, "1",
        "one full non-active turn, 'pseudo-rigid' through beams of 'higher stiffness', not given",
        "0.75: as if those beams let a quarter turn take part, and the usual 1.5 lost coils of hot coiled "
        "springs; 1.25: as much to the other side. Turns and height of the whole spring and the "
        "loaded point stay. The active wire then begins 90° off the plane, of which the paper's law does not "
        "know.",
        _rigid,
    ),
    OpenInput(
        "start_phase", "start phase", NOT_GIVEN, "0°",
        "does not say at which angle to the working plane the active wire begins",
        "all round in steps of 30°; with contact by 20 pairs per turn, against 20 pairs at 0°, so that the "
        "place of few spheres plays no part. The paper's law knows the side alone.",
        _phase,
    ),
    OpenInput(
        "sphere_place", "spheres out of the plane by", AGAINST, "0°",
        "4 contact elements per turn (Table 2), at angles not given",
        "15° to 45°, which is farthest, by turning the helix and its spheres. The contact of a bent spring "
        "is in the plane, and its coils overlap where no sphere stands. The paper's FE and beam coincide, "
        "the beam being the softer: its spheres cannot have been far from the plane.",
        _spheres, contact=True, models=(WIRE,),
    ),
    OpenInput(
        "pairs", "sphere pairs per turn", READING, "4",
        "'number contact elements per turn 4' (Table 2)",
        "2: a pair is two elements; 8: each of 4 places faces both neighbours; 20: wires that touch "
        "everywhere, which 4 stand for. The beam has 2 circles per turn by its definition.",
        _pairs, contact=True, models=(WIRE,),
    ),
    OpenInput(
        "penalty", "contact stiffness", NOT_GIVEN, "K = 1e4 N/mm", "'appropriate stiffness'",
        "a decade to either side.",
        _penalty, contact=True,
    ),
    OpenInput(
        "exponent", "contact exponent", NOT_GIVEN, "1", "'appropriate exponent'",
        "1.5, Hertz's for spheres, with the same force at 0.01 mm: within a tenth of Hertz's stiffness of "
        "two steel spheres of the wire's diameter.",
        _exponent, contact=True,
    ),
    OpenInput(
        "friction", "friction of the coils", READING, "A: none; B: no sliding",
        "FE of Spring B with 'no sliding'; nothing on Spring A; the beam's law (12) has no friction",
        "0.1 and 0.3, oiled and dry steel; for B in the place of no sliding, should the option yield.",
        _friction, contact=True, models=(WIRE,),
    ),
    OpenInput(
        "element", "wire element", READING, "straight",
        "40 beam elements per turn (Table 2), their kind not given",
        "curved: elements with the exact linear flexibility of their piece of wire, as elements of higher "
        "order approach it. The beam's element is the paper's own.",
        _element, models=(WIRE,),
    ),
    OpenInput(
        "wire_rigidity", "wire as a solid body", BEAMS, "beam",
        "FE of beams; stiffnesses of a half coil after Haringx",
        "solid: the coiled wire by three-dimensional elasticity.",
        _solid,
    ),
)  # fmt: skip
