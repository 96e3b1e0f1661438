"""Sampled scenes of the campaign: each follows from the seed and its id alone.

Ids are `b000123` (equivalent beam) and `w00012` (wire model): the model's letter and the place in a scrambled
Sobol sequence; `b000121s` and `w00013s` have springs of sections in place of a cylinder or cone, as every
fourth scene of a campaign. Every eighth scene is a pathological corner. In a fifth of all scenes a
displacement of the top is prescribed, in place of the force; half of the wires touch as wires, the others by
spheres.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import lru_cache
from typing import Any

import numpy as np
from scipy.stats import qmc

from coilspring import Contact, InputError, Load, Scene, Spring, Supports
from coilspring.scene.sizing import solid_height
from validation.study.models import BEAM, WIRE
from validation.study.sections import in_sections

BLOCK = 1024  # of the sequence
CORNERS = ("touching", "solid", "buckling", "telescoping", "tiny", "huge", "hard")
EVERY = 8  # scenes, one of which is a corner
HELD: tuple[tuple[str, ...], ...] = ((), (), ("rotz",), ("ux",), ("ux", "rotz"))
LETTERS = {"b": BEAM, "w": WIRE}  # of an id, and the model
SECTIONS, FOURTH = "s", 1  # ends ids of springs of sections; the first of them in a campaign
DIGITS = {"b": 6, "w": 5}  # of a number in an id, at least
MOST_DIGITS = 9
MOST_ELEMENTS = 200  # of a wire
DRIVEN = 0.2  # of the scenes
WIRES = 0.5  # of the wire model's scenes: contact of wires
# Multiples of irrational numbers tell which: sequences as even as Sobol's, which they leave as it is.
GOLDEN, SILVER = 0.5 * (math.sqrt(5.0) - 1.0), math.sqrt(2.0) - 1.0
STATIONS = (8, 32)  # a turn, whatever the mesh
OF_SIZE = 0.8  # of the distance to solid for a size of 1: 4 to 104 %, solid corners 80 to 120 %
SHORTEST = 0.05  # of the height: least height left, and distance to solid of coils that touch at rest
LEAST_ANGLE = 0.05  # a mostly axial load is inclined at least by this, rad: exact symmetry is a corner
UNITS = {"tiny": (1e-3, 1e-6), "huge": (1e3, 1e6)}  # factors of lengths and forces in these corners
COUNTS = {"curved": (4, 8, 12, 16), "straight": (8, 12, 16, 20, 24, 32, 40)}  # elements a turn


@dataclass(frozen=True)
class Case:
    """One scene and how it is solved."""

    id: str
    corner: str  # one of `CORNERS`, or "" for an ordinary scene
    scene: Scene
    size: float  # load over the one that makes it solid, or bends it over its height; or the `pressed` share
    number: int  # place in the sequence
    options: Mapping[str, Any] = field(default_factory=dict)  # of `equivbeam.solve` or `wirefe.solve`

    @property
    def model(self) -> str:
        """Package that solves it."""
        return LETTERS[self.id[0]]


def case_id(letter: str, number: int) -> str:
    """Id of a case of a campaign."""
    return _id(letter, number, number % 4 == FOURTH)


def _id(letter: str, number: int, of_sections: bool) -> str:
    """Id of a case by its parts."""
    return f"{letter}{number:0{DIGITS[letter]}d}{SECTIONS if of_sections else ''}"


def is_of_sections(name: str) -> bool:
    """Whether the spring of an id is one of sections."""
    return name.endswith(SECTIONS)


def make_case(name: str, seed: int) -> Case:
    """The case of an id (`InputError` where it is none)."""
    letter, digits, of_sections = name[:1], name[1:].removesuffix(SECTIONS), is_of_sections(name)
    if letter not in LETTERS or not digits.isdecimal() or len(digits) > MOST_DIGITS:
        raise InputError(
            f"case must be b or w with a number of at most {MOST_DIGITS} digits, as b000123, got {name!r}"
        )
    number = int(digits)
    name, is_corner = _id(letter, number, of_sections), number % EVERY == EVERY - 1 and not of_sections
    draw = Draw(_block(letter, seed, number // BLOCK)[number % BLOCK])
    corner = CORNERS[number // EVERY % len(CORNERS)] if is_corner else ""
    spring = _spring(draw, corner, half_coils=draw.whole("coils", 4, 40 if letter == "b" else 20))
    if of_sections:
        spring = in_sections(np.random.default_rng((seed, 3 + (letter == "w"), number)), spring)
    scene, size = _scene(name, draw, corner, spring)
    options = {"law": draw.of("law", "haringx", "helix")}
    if letter == "w":
        geometry = "wires" if _chosen((seed, 2), SILVER, number, WIRES) else "spheres"
        scene, options = _of_wire(scene, draw, geometry)
    scene = in_units(scene, *UNITS.get(corner, (1.0, 1.0)))
    if is_driven(letter, number, seed):
        size *= OF_SIZE
        scene = pressed(scene, size)
    return Case(name, corner, scene, size, number, options)


def _of_wire(scene: Scene, draw: "Draw", geometry: str) -> tuple[Scene, dict[str, Any]]:
    """The scene with what resists sliding, and how its wire is solved."""
    sliding = draw.of("sliding", "free", "none", "coulomb")
    friction = draw.log("kind", 0.05, 0.5) if sliding == "coulomb" else None
    contact = replace(scene.contact, sliding=sliding, friction=friction, geometry=geometry)
    element = draw.of("law", *COUNTS)  # long wires take the coarser meshes
    counts = [count for count in COUNTS[element] if count * scene.spring.active_coils <= MOST_ELEMENTS]
    count = draw.of("mesh", *(counts or COUNTS[element][:1]))
    pairs = draw.of("pairs", 2, 4) if geometry == "spheres" else draw.whole("pairs", *STATIONS)
    options = {"element": element, "elements_per_turn": count, "pairs_per_turn": pairs}
    return replace(scene, contact=contact), options


def is_driven(letter: str, number: int, seed: int) -> bool:
    """Whether a displacement is prescribed in a scene."""
    return _chosen((seed, int(letter == "w")), GOLDEN, number, DRIVEN)


def _chosen(seed: tuple[int, int], irrational: float, number: int, share: float) -> bool:
    """Whether a scene is among a share of all."""
    return bool((np.random.default_rng(seed).random() + irrational * number) % 1.0 < share)


def pressed(scene: Scene, share: float) -> Scene:
    """The scene with a share of the distance to solid prescribed in place of its force."""
    height = scene.spring.active_height
    travel = max(height - solid_height(scene.spring), SHORTEST * height)
    shortening = min(share * travel, (1.0 - SHORTEST) * height)
    return replace(scene, load=Load(steps=scene.load.steps, displacement=(-shortening,)))


@lru_cache(maxsize=4)
def _block(letter: str, seed: int, block: int) -> np.ndarray:
    """A block of the sequence; the prefix of a Sobol sequence does not depend on its length."""
    sobol = qmc.Sobol(len(Draw.NAMES), rng=seed + (letter == "w"))
    if block:
        sobol.fast_forward(block * BLOCK)
    return sobol.random(BLOCK)


class Draw:
    """One point of the sequence; every question has a coordinate of its own."""

    NAMES = (
        "d", "index", "cone", "taper", "coils", "pitch", "angle", "size", "held", "penalty", "exponent",
        "steps", "law", "ends", "side", "contact", "mesh", "pairs", "sliding", "kind",
    )  # fmt: skip

    def __init__(self, point: np.ndarray) -> None:
        self.point = dict(zip(self.NAMES, point.tolist(), strict=True))

    def even(self, name: str, low: float, high: float) -> float:
        """Evenly distributed number."""
        return low + (high - low) * self.point[name]

    def log(self, name: str, low: float, high: float) -> float:
        """Number whose logarithm is evenly distributed."""
        return math.exp(self.even(name, math.log(low), math.log(high)))

    def whole(self, name: str, low: int, high: int) -> int:
        """Whole number, both ends included."""
        return min(low + int(self.point[name] * (high - low + 1)), high)

    def of(self, name: str, *choices: Any) -> Any:
        """One of the choices."""
        return choices[self.whole(name, 0, len(choices) - 1)]


def _spring(draw: Draw, corner: str, half_coils: int) -> Spring:
    """A cylinder or a cone whose coils do not overlap at rest."""
    d, coils = draw.log("d", 0.4, 5.0), 0.5 * half_coils
    ends = 0.0 if draw.point["ends"] < 0.15 else draw.of("ends", 1.0, 1.0, 0.5, 1.5)
    bottom = top = draw.even("index", 4.0, 15.0) * d
    if (draw.point["cone"] < 0.5 and corner != "buckling") or corner == "telescoping":
        top = min(max(draw.log("taper", 0.4, 2.5) * bottom, 4.0 * d), 15.0 * d)
    pitch = d * draw.log("pitch", 1.05, max(1.6, 0.2 * min(bottom, top) / d))
    if corner == "touching":
        pitch = d
    if corner == "buckling":
        coils = min(max(coils, math.ceil(draw.even("taper", 3.0, 6.0) * bottom / pitch)), 40.0)
    if corner == "telescoping":
        # each coil clears the next: the half difference of diameters passes the wire's
        bottom, top, coils = 15.0 * d, 4.0 * d, min(coils, 5.0)
    return Spring(d, (bottom, top), coils, coils * pitch, ends, math.pi * (draw.point["side"] < 0.5))


def _scene(name: str, draw: Draw, corner: str, spring: Spring) -> tuple[Scene, float]:
    """A scene and the size of its load."""
    held = draw.of("held", *HELD)
    size = draw.even("size", 1.0, 1.5) if corner == "solid" else draw.even("size", 0.05, 1.3)
    angle, third = 0.0, draw.point["angle"] * 3.0
    if "ux" not in held and corner not in ("buckling", "solid", "telescoping"):
        # from the axis downwards: a third nearly axial, a third lateral, the rest between; beyond 90 degrees
        # the spring is drawn out
        nearly_axial, between = LEAST_ANGLE + 0.1 * third, (third - 2.0) * math.pi * 0.75
        angle = nearly_axial if third < 1.0 else math.pi / 2.0 if third < 2.0 else between
        angle *= 1.0 if draw.point["side"] * 2.0 % 1.0 < 0.5 else -1.0
    if corner == "buckling":
        held = ()
    contact = Contact(
        enabled=draw.point["contact"] < 0.85 or bool(corner),
        stiffness=draw.log("penalty", 1e8, 1e10) if corner == "hard" else draw.log("penalty", 1e2, 1e8),
        exponent=1.0 if draw.point["exponent"] < 0.4 else draw.even("exponent", 1.0, 2.0),
    )
    load = Load(_force(spring, size, angle, held), round(draw.log("steps", 1, 200)))
    return Scene(name, spring, load, supports=Supports(held), contact=contact), size


def _force(spring: Spring, size: float, angle: float, held: tuple[str, ...]) -> tuple[float, float]:
    """Load that takes up `size` of the spring's free travel, or bends it that far, in the linear range; by
    rigidities of a helical spring with G = E / 2.6."""
    d, n, D = spring.wire_diameter, spring.active_coils, sum(spring.mean_diameter) / 2.0
    E, G, height = 206_000.0, 206_000.0 / 2.6, spring.active_height
    cubes = sum(coils.coils / n * _cubes(*coils.mean_diameter) for coils in spring.coils)
    rate = G * d**4 / (8.0 * n * cubes / 3.0)
    bending = E * G * d**4 / (32.0 * n * D * (2.0 * G + E)) * height * 2.0
    stiff = 12.0 if "rotz" in held else 3.0
    lateral = 1.0 / (height**3 / (stiff * bending * height / 2.0) / height + 1.0 / (rate * E / G))
    axial = size * rate * max(height - n * d, 0.1 * height)
    sideways = size * lateral * 1.2 * height
    return sideways * math.sin(angle), -axial * math.cos(angle)


def _cubes(bottom: float, top: float) -> float:
    """Cubes of a section's diameters at three of its coils."""
    return sum((bottom * (1 - x) + top * x) ** 3 for x in (0.1, 0.5, 0.9))


def scaled_load(load: Load, force: float, length: float) -> Load:
    """The load with its force, or the displacement it prescribes, times a factor."""
    x, y = load.force
    displacement = tuple(length * value for value in load.displacement)
    return replace(load, force=(x * force, y * force), displacement=displacement)


def in_units(scene: Scene, length: float, force: float) -> Scene:
    """The same scene in other units: all lengths and forces times a factor."""
    contact = scene.contact
    return replace(
        scene,
        spring=resized(scene.spring, length),
        material=replace(scene.material, E=scene.material.E * force / length**2),
        load=scaled_load(scene.load, force, length),
        contact=replace(contact, stiffness=contact.stiffness * force / length**contact.exponent),
    )


def resized(spring: Spring, length: float, taller: float = 1.0) -> Spring:
    """The spring with all lengths times a factor, and its height times another one, too."""
    along = length * taller
    sections = (
        replace(each, pitch=_times(each.pitch, along), mean_diameter=_times(each.mean_diameter, length))
        for each in spring.sections
    )
    return replace(
        spring,
        wire_diameter=spring.wire_diameter * length,
        mean_diameter=_times(spring.mean_diameter, length),
        active_height=spring.active_height * along,
        sections=tuple(sections),
    )


def _times(ends: tuple[float, float], factor: float) -> tuple[float, float]:
    return ends[0] * factor, ends[1] * factor
