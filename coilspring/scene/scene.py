"""A scene: the physics of one experiment on one spring, with its supports and the law of its contact."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from typing import Self

import numpy as np

from coilspring.errors import InputError, require_number
from coilspring.scene.load import Load, stage_ends
from coilspring.scene.material import Material
from coilspring.scene.profile import SAME
from coilspring.scene.schema import KEYS, keep_checked
from coilspring.scene.solidwire import SOLID_POISSON
from coilspring.scene.spring import Spring
from coilspring.words import shown

HELD_CHOICES: tuple[str, ...] = KEYS["supports"]["top_held"].checks["some"]
SEATS: tuple[str, ...] = KEYS["supports"]["seat"].checks["choice"]
PAIRS_OF_STIFFNESS = 4.0  # per turn: the scene's contact stiffness is that of each of them
# Of the height, and of E d^2: below, rounding is seen in the answer.
LEAST_MOTION, LEAST_STRAIN = 3e-10, 2e-13


@dataclass(frozen=True)
class Contact:
    """Penalty law of the coil contact, F = K max(0, d - h)^exponent between neighbouring coils.

    Attributes
    ----------
    enabled : False lets coils pass through each other.
    stiffness : K of each pair at 4 pairs per turn, N/mm^exponent; more pairs share it.
    exponent : of the penetration.
    sliding : "free", "none" (sticking contact), or "coulomb" (with friction).
    friction : coefficient, with "coulomb" alone.
    geometry : of the wire model's contact: the "wires" themselves, whose gap is taken across both, or
        "spheres" on them, as the paper has it; the equivalent beam has circles either way.
    """

    enabled: bool = True
    stiffness: float = 1.0e4
    exponent: float = 1.0
    sliding: str = "free"
    geometry: str = "wires"
    friction: float | None = None

    def __post_init__(self) -> None:
        keep_checked(self, "contact")
        if self.sliding == "coulomb":
            if self.friction is None:
                raise InputError('contact.friction is missing; contact.sliding = "coulomb" requires it')
            value = require_number("contact.friction", self.friction, 1e-6, 10.0)
            object.__setattr__(self, "friction", value)
        elif self.friction is not None:
            raise InputError(
                f'contact.friction goes with contact.sliding = "coulomb" alone, got {shown(self.friction)} '
                f"with {shown(self.sliding)}"
            )

    def pair_stiffness(self, pairs_per_turn: float) -> float:
        """K of each pair, N/mm^exponent, where so many of them share a turn."""
        return self.stiffness * PAIRS_OF_STIFFNESS / pairs_per_turn

    @property
    def coefficient(self) -> float:
        """Coefficient of friction: 0 for sliding "free", infinite for "none"."""
        return {"free": 0.0, "none": math.inf}.get(self.sliding, self.friction or 0.0)


@dataclass(frozen=True)
class Supports:
    """What holds the two ends in the plane; UZ = ROTX = ROTY = 0 at both reference points always.

    Attributes
    ----------
    top_held : of "ux", "uy", "rotz".
    bottom_held : the same; less than all is in no model.
    seat : with "rigid" the end turns move with their ends. With "plate" they are elastic, ground flat, and
        rest on plates, which move with the ends and press without friction; the wire's tips are fixed along
        their plates and against turning on them.
    """

    top_held: tuple[str, ...] = ()
    bottom_held: tuple[str, ...] = HELD_CHOICES
    seat: str = "rigid"

    def __post_init__(self) -> None:
        keep_checked(self, "supports")

    @property
    def free(self) -> tuple[float, float]:
        """1 for each of X and Y in which the top can move, else 0."""
        return float("ux" not in self.top_held), float("uy" not in self.top_held)

    def require_supported(self, model: str, seats: tuple[str, ...] = ("rigid",)) -> str:
        """The seat, if `model` can represent these supports with one of its `seats`, else `InputError`."""
        if self.bottom_held != HELD_CHOICES:
            raise InputError(
                f"supports.bottom_held is unsupported by {model} unless it is all of "
                f"{', '.join(HELD_CHOICES)}, got {shown(list(self.bottom_held))}; the end that may move must "
                f"be the top: turn the spring over"
            )
        if self.seat not in seats:
            raise InputError(
                f"supports.seat is unsupported by {model} unless it is {' or '.join(seats)}, got "
                f"{shown(self.seat)}: end turns move with their end, there is no contact with a plate"
            )
        return self.seat


@dataclass(frozen=True)
class Factors:
    """Factors of the paper's three stiffnesses of a half coil; the wire model has no use for them."""

    axial: float = 1.0
    shearing: float = 1.0
    bending: float = 1.0

    def __post_init__(self) -> None:
        keep_checked(self, "factors")

    @classmethod
    def of(cls, three: Sequence[float] | np.ndarray) -> Self:
        """Factors of three numbers: axial, shearing, bending."""
        three = three.tolist() if isinstance(three, np.ndarray) else three
        if not isinstance(three, list | tuple) or len(three) != 3:
            raise InputError(f"factors must be three numbers, got {shown(three)}")
        return cls(*three)

    @property
    def given(self) -> bool:
        """Whether one of them is not 1."""
        return (self.axial, self.shearing, self.bending) != (1.0, 1.0, 1.0)


SECTIONS: dict[str, type] = {  # in the order of a file
    each.__name__.lower(): each for each in (Material, Spring, Load, Supports, Contact, Factors)
}


@dataclass(frozen=True)
class Scene:
    """What one experiment is made of; the factors are the equivalent beam's alone."""

    name: str
    spring: Spring
    load: Load
    material: Material = field(default_factory=Material)
    supports: Supports = field(default_factory=Supports)
    contact: Contact = field(default_factory=Contact)
    factors: Factors = field(default_factory=Factors)

    def __post_init__(self) -> None:
        if not isinstance(self.name, str) or not self.name.strip():
            raise InputError(f"name must be a text that is not empty, got {shown(self.name)}")
        for part, kind in SECTIONS.items():
            if not isinstance(getattr(self, part), kind):
                raise InputError(f"{part} must be a {kind.__name__}, got {shown(getattr(self, part))}")
        low, high = SOLID_POISSON
        if self.spring.wire_rigidity == "solid" and not low <= self.material.nu <= high:
            raise InputError(
                f"material.nu must be in [{low:g}, {high:g}] with spring.wire_rigidity = 'solid', "
                f"got {self.material.nu!r}"
            )
        if self.supports.seat == "plate":
            self._check_plates()
        if self.load.displacement:
            self._check_displacement()
            return
        ends = stage_ends(self.load)
        changes = np.any(np.diff(ends, axis=0) * self.supports.free, axis=1)
        if not changes.all():
            key = "load.stages" if self.load.stages else "load.force"
            force = tuple(ends[1:][~changes][0].tolist())
            raise InputError(
                f"{key} must change in a direction that is free, got {force!r} with "
                f"supports.top_held = {list(self.supports.top_held)!r}"
            )

    def _check_displacement(self) -> None:
        if "uy" in self.supports.top_held:
            held = list(self.supports.top_held)
            raise InputError(
                f"supports.top_held must be without uy where load.displacement prescribes it, got {held!r}"
            )
        least = -self.spring.active_height
        for uy in self.load.displacement:
            if uy <= least:
                raise InputError(
                    f"load.displacement must be above {least:g}, where the top meets the bottom, got {uy!r}"
                )

    def _check_plates(self) -> None:
        """Refuse what would lift the spring off its plates, and a spring without end turns to lie there."""
        if self.spring.end_turns == 0.0:
            raise InputError("spring.end_turns must be in [0.5, 100] with supports.seat = 'plate', got 0")
        load = self.load
        axial = load.displacement or tuple(y for _, y in load.stages or (load.force,))
        if max(axial) >= 0.0:
            key = "displacement" if load.displacement else "stages" if load.stages else "force"
            raise InputError(
                f"load.{key} must press throughout with supports.seat = 'plate', whose plates do not pull: "
                f"along Y below 0, got {max(axial)!r}"
            )

    @property
    def direction(self) -> tuple[float, float]:
        """Direction (x, y) of the load where the top can move, of length 1.

        Raises
        ------
        InputError : stages load the top in several directions.
        """
        if self.load.displacement:
            return 0.0, math.copysign(1.0, max(self.load.displacement, key=abs))
        forces = (stage_ends(self.load)[1:] * self.supports.free).tolist()
        x, y = max(forces, key=lambda force: math.hypot(*force))
        size = math.hypot(x, y)
        others = [[a, b] for a, b in forces if abs(a * y - b * x) > SAME * size * math.hypot(a, b)]
        if others:
            raise InputError(
                "load.stages must be in one direction where force is taken over deflection, "
                f"got {[x, y]!r} and {others[0]!r}"
            )
        return x / size, y / size

    def without_contact(self) -> Self:
        """The same scene with contact switched off."""
        return replace(self, contact=replace(self.contact, enabled=False))

    def with_steps(self, steps: int) -> Self:
        """The same scene with another output grid."""
        return replace(self, load=replace(self.load, steps=steps))

    def with_penalty(self, stiffness: float) -> Self:
        """The same scene with another contact stiffness K, N/mm^exponent."""
        return replace(self, contact=replace(self.contact, stiffness=stiffness))

    def overridden(
        self, steps: int | None = None, penalty: float | None = None, geometry: str | None = None
    ) -> Self:
        """The scene with the number of steps, the penalty and the contact geometry a caller asked for."""
        scene = self if steps is None else self.with_steps(steps)
        scene = scene if penalty is None else scene.with_penalty(penalty)
        if geometry is None:
            return scene
        return replace(scene, contact=replace(scene.contact, geometry=geometry))


def load_directions(scene: Scene, times: np.ndarray) -> np.ndarray:
    """Directions in which the load grows on the free top at some times, shape (times, 2), of length 1."""
    grows = np.diff(stage_ends(scene.load), axis=0) * scene.supports.free
    grows /= np.linalg.norm(grows, axis=1)[:, None]
    stage = np.ceil(np.clip(times, 0.0, 1.0) * len(grows) - 1e-9).astype(int) - 1
    return grows[np.maximum(stage, 0)]


def require_motion(scene: Scene) -> None:
    """Refuse a load that moves a spring by hardly more than rounding its points, or strains it so."""
    load, spring = scene.load, scene.spring
    key, unit = ("displacement", "mm") if load.displacement else ("force", "N")
    stiffness = scene.material.E * spring.wire_diameter**2
    least = LEAST_MOTION * spring.active_height if load.displacement else LEAST_STRAIN * stiffness
    if (largest := float(np.abs(stage_ends(load)).max())) < least:
        enough = f"{1.01 * least:.3g} {unit}"  # rounded, too
        raise InputError(f"load.{key} must be {enough} at least for this spring, got {largest:g}")


def require_scene(value: object) -> Scene:
    """Return `value`, or raise `InputError` unless it is a `Scene`."""
    if isinstance(value, Scene):
        return value
    raise InputError(
        f"scene must be a coilspring.Scene, got {shown(value)}; coilspring.load_scene makes one of a "
        "catalogue name or a file"
    )
