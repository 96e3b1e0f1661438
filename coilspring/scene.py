"""A scene: the physics of one experiment on one spring, and nothing of how it is solved."""

from __future__ import annotations

import math
from dataclasses import dataclass, field, replace

from coilspring.errors import InputError, keep_numbers, require_choice, require_integer, require_number, shown
from coilspring.material import Material
from coilspring.spring import Spring

HELD_CHOICES = ("ux", "uy", "rotz")
SEATS = ("rigid", "plate")
SLIDING = ("free", "none", "coulomb")
MOST_FORCE = 1e12  # N


@dataclass(frozen=True)
class Load:
    """Dead load at the top reference point, growing in proportion to time 0..1."""

    force: tuple[float, float]  # (Fx, Fy) at time 1, N
    steps: int = 50  # equal steps of time at which results are wanted

    def __post_init__(self) -> None:
        if not isinstance(self.force, list | tuple) or len(self.force) != 2:
            raise InputError(f"load.force must be two numbers [Fx, Fy], got {shown(self.force)}")
        pair = tuple(require_number("load.force", value, -MOST_FORCE, MOST_FORCE) for value in self.force)
        if not any(pair):
            raise InputError(
                f"load.force must be two numbers in [{-MOST_FORCE:g}, {MOST_FORCE:g}], not both zero, "
                f"got {shown(self.force)}"
            )
        object.__setattr__(self, "force", pair)
        object.__setattr__(self, "steps", require_integer("load.steps", self.steps, 1, 100_000))


@dataclass(frozen=True)
class Supports:
    """What holds the two ends in the plane; UZ = ROTX = ROTY = 0 at both reference points always."""

    top_held: tuple[str, ...] = ()  # of "ux", "uy", "rotz"
    bottom_held: tuple[str, ...] = HELD_CHOICES  # clamped; less is in no model yet
    seat: str = "rigid"  # end turns move with their end; "plate": they rest on it, which is in no model yet

    def __post_init__(self) -> None:
        for end in ("top_held", "bottom_held"):
            object.__setattr__(self, end, _held(f"supports.{end}", getattr(self, end)))
        require_choice("supports.seat", self.seat, SEATS)

    def require_supported(self, model: str) -> None:
        """Raise `InputError` for what `model` cannot represent: neither model has it."""
        if self.bottom_held != HELD_CHOICES:
            raise InputError(
                f"supports.bottom_held is unsupported by {model} unless it is all of "
                f"{', '.join(HELD_CHOICES)}, got {shown(list(self.bottom_held))}; the end that may move must "
                f"be the top: turn the spring over"
            )
        if self.seat != "rigid":
            raise InputError(
                f"supports.seat is unsupported by {model} unless it is rigid, got {shown(self.seat)}: "
                f"end turns move with their end, there is no contact with a plate"
            )


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
        forces = dict(zip(("ux", "uy"), self.load.force, strict=True))
        if not any(force for way, force in forces.items() if way not in self.supports.top_held):
            raise InputError(
                f"load.force must have a component other than 0 in a direction that is free, got "
                f"{self.load.force!r} with supports.top_held = {list(self.supports.top_held)!r}"
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
