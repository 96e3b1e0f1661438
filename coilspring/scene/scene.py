"""A scene: the physics of one experiment on one spring, and nothing of how it is solved."""

from __future__ import annotations

import math
from dataclasses import dataclass, field, replace

from coilspring.errors import InputError, keep_numbers, require_choice, require_integer, require_number, shown
from coilspring.scene.material import Material
from coilspring.scene.profile import LONGEST
from coilspring.scene.spring import Spring

HELD_CHOICES = ("ux", "uy", "rotz")
SEATS = ("rigid", "plate")
SLIDING = ("free", "none", "coulomb")
MOST_FORCE = 1e12  # N
MOST_STAGES = 1000


@dataclass(frozen=True)
class Load:
    """Load at the top reference point over time 0..1: one of `force`, `stages` and `displacement`.

    Attributes
    ----------
    force : dead load (Fx, Fy) at time 1, growing in proportion to time, N; of stages, the last one.
    steps : equal steps of time of each stage at which results are wanted.
    stages : dead loads (Fx, Fy) reached one after the other at equal intervals of time, along straight
        lines, N.
    displacement : UY of the top, prescribed in the same way, mm; one or several.
    """

    force: tuple[float, float] = (0.0, 0.0)
    steps: int = 50
    stages: tuple[tuple[float, float], ...] = ()
    displacement: tuple[float, ...] = ()

    def __post_init__(self) -> None:
        object.__setattr__(self, "steps", require_integer("load.steps", self.steps, 1, 100_000))
        given = self.force
        object.__setattr__(self, "force", _force("load.force", given))
        if self.stages != ():
            self._keep_stages()
        elif self.displacement != ():
            self._keep_displacement()
        elif not any(self.force):
            raise InputError(
                f"load.force must be two numbers in [{-MOST_FORCE:g}, {MOST_FORCE:g}], not both zero, "
                f"got {shown(given)}"
            )

    def _keep_stages(self) -> None:
        if self.displacement != ():
            raise InputError("load takes stages or displacement, not both")
        if not isinstance(self.stages, list | tuple):
            raise InputError(f"load.stages must be a list of forces [Fx, Fy], got {shown(self.stages)}")
        stages = [_force(f"load.stages[{i}]", stage) for i, stage in enumerate(self.stages, 1)]
        object.__setattr__(self, "stages", _changing("load.stages", stages, (0.0, 0.0)))
        if any(self.force) and self.force != stages[-1]:
            raise InputError(
                f"load.force must be left out beside load.stages, or be the last of them, got {self.force!r}"
            )
        object.__setattr__(self, "force", stages[-1])

    def _keep_displacement(self) -> None:
        if any(self.force):
            raise InputError(f"load.force must be left out beside load.displacement, got {self.force!r}")
        ways = self.displacement if isinstance(self.displacement, list | tuple) else (self.displacement,)
        kept = [require_number("load.displacement", way, -LONGEST, LONGEST) for way in ways]
        object.__setattr__(self, "displacement", _changing("load.displacement", kept, 0.0))

    @property
    def rows(self) -> int:
        """Results wanted in all."""
        return self.steps * (len(self.stages) or len(self.displacement) or 1)


def _force(field: str, value: object) -> tuple[float, float]:
    """Fx and Fy."""
    if not isinstance(value, list | tuple) or len(value) != 2:
        raise InputError(f"{field} must be two numbers [Fx, Fy], got {shown(value)}")
    x, y = (require_number(field, item, -MOST_FORCE, MOST_FORCE) for item in value)
    return x, y


def _changing(field: str, values: list, start: object) -> tuple:
    """Values reached one after the other, each of which differs from the one before."""
    if not 1 <= len(values) <= MOST_STAGES:
        raise InputError(f"{field} must be 1 to {MOST_STAGES} stages, got {len(values)}")
    for number, (before, after) in enumerate(zip([start, *values], values, strict=False), 1):
        if before == after:
            raise InputError(f"{field}[{number}] must differ from what it begins with, {before}, got {after}")
    return tuple(values)


@dataclass(frozen=True)
class Supports:
    """What holds the two ends in the plane; UZ = ROTX = ROTY = 0 at both reference points always.

    Attributes
    ----------
    top_held : of "ux", "uy", "rotz".
    bottom_held : the same; less than all is in no model.
    seat : with "rigid" the end turns move with their ends. With "plate" they are elastic, ground flat, and
        rest on plates, which move with the ends and push without friction; the wire's tips are held along
        their plates and against turning on them.
    """

    top_held: tuple[str, ...] = ()
    bottom_held: tuple[str, ...] = HELD_CHOICES
    seat: str = "rigid"

    def __post_init__(self) -> None:
        for end in ("top_held", "bottom_held"):
            object.__setattr__(self, end, _held(f"supports.{end}", getattr(self, end)))
        require_choice("supports.seat", self.seat, SEATS)

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


def _held(field: str, names: object) -> tuple[str, ...]:
    """Names of held freedoms in their usual order, each once."""
    if not isinstance(names, list | tuple):
        raise InputError(
            f"{field} must be a list with items of {', '.join(HELD_CHOICES)}, got {shown(names)}"
        )
    held = tuple(require_choice(field, item, HELD_CHOICES) for item in names)
    return tuple(name for name in HELD_CHOICES if name in held)


FRICTION = (1e-6, 10.0)
RANGES = {"stiffness": (1e-9, 1e12), "exponent": (1.0, 5.0)}


@dataclass(frozen=True)
class Contact:
    """Penalty law of the coil contact, F = K max(0, d - h)^exponent between neighbouring coils."""

    enabled: bool = True
    stiffness: float = 1.0e4  # K, N/mm^exponent, of each sphere pair at 4 pairs a turn
    exponent: float = 1.0
    sliding: str = "free"  # "none": no sliding while in contact; "coulomb": with friction
    friction: float | None = None  # coefficient, for "coulomb" alone

    def __post_init__(self) -> None:
        if not isinstance(self.enabled, bool):
            raise InputError(f"contact.enabled must be true or false, got {shown(self.enabled)}")
        keep_numbers(self, "contact", RANGES)
        require_choice("contact.sliding", self.sliding, SLIDING)
        if self.sliding == "coulomb":
            value = require_number("contact.friction", self.friction, *FRICTION)
            object.__setattr__(self, "friction", value)
        elif self.friction is not None:
            raise InputError(
                f'contact.friction goes with contact.sliding = "coulomb" alone, got {shown(self.friction)} '
                f"with {shown(self.sliding)}"
            )

    @property
    def coefficient(self) -> float:
        """Coefficient of friction: 0 for sliding "free", infinite for "none"."""
        return {"free": 0.0, "none": math.inf}.get(self.sliding, self.friction or 0.0)


@dataclass(frozen=True)
class Scene:
    """Spring, material, load, supports and contact law of one experiment."""

    name: str
    spring: Spring
    load: Load
    material: Material = field(default_factory=Material)
    supports: Supports = field(default_factory=Supports)
    contact: Contact = field(default_factory=Contact)

    def __post_init__(self) -> None:
        if not isinstance(self.name, str) or not self.name.strip():
            raise InputError(f"name must be a text that is not empty, got {shown(self.name)}")
        if self.supports.seat == "plate":
            self._check_plates()
        if self.load.displacement:
            self._check_displacement()
            return
        free = [way not in self.supports.top_held for way in ("ux", "uy")]
        before = (0.0, 0.0)
        for force in self.load.stages or (self.load.force,):
            if not any(old != new and way for old, new, way in zip(before, force, free, strict=True)):
                key = "load.stages" if self.load.stages else "load.force"
                raise InputError(
                    f"{key} must change in a direction that is free, got {force!r} with "
                    f"supports.top_held = {list(self.supports.top_held)!r}"
                )
            before = force

    def _check_displacement(self) -> None:
        if "uy" in self.supports.top_held:
            raise InputError("supports.top_held must be without uy where load.displacement prescribes it")
        least = -self.spring.active_height
        for way in self.load.displacement:
            if way <= least:
                raise InputError(
                    f"load.displacement must be above {least:g}, where the top meets the bottom, got {way!r}"
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

    def without_contact(self) -> Scene:
        """The same scene with contact switched off."""
        return replace(self, contact=replace(self.contact, enabled=False))

    def with_steps(self, steps: int) -> Scene:
        """The same scene with another output grid."""
        return replace(self, load=replace(self.load, steps=steps))

    def with_penalty(self, stiffness: float) -> Scene:
        """The same scene with another contact stiffness K, N/mm^exponent."""
        return replace(self, contact=replace(self.contact, stiffness=stiffness))

    def overridden(self, steps: int | None = None, penalty: float | None = None) -> Scene:
        """The scene with the number of steps and the penalty a caller asked for."""
        scene = self if steps is None else self.with_steps(steps)
        return scene if penalty is None else scene.with_penalty(penalty)


def require_scene(value: object) -> Scene:
    """Return `value`, or raise `InputError` unless it is a `Scene`."""
    if isinstance(value, Scene):
        return value
    raise InputError(
        f"scene must be a coilspring.Scene, got {shown(value)}; coilspring.load_scene makes one of a "
        "catalogue name or a file"
    )
