"""What holds the ends of a spring."""

from __future__ import annotations

from dataclasses import dataclass

from coilspring.errors import InputError, shown
from coilspring.scene.schema import KEYS, keep_checked

HELD_CHOICES: tuple[str, ...] = KEYS["supports"]["top_held"].checks["some"]
SEATS: tuple[str, ...] = KEYS["supports"]["seat"].checks["choice"]


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
