"""What goes wrong: refused input, and an equilibrium that was not found."""

import math
import numbers
from collections.abc import Collection, Iterable
from typing import Any

from coilspring.words import shown


class InputError(ValueError):
    """Input that is refused, in one sentence that names field, value and allowed range."""


class EquilibriumNotFound(RuntimeError):
    """The load path could not be followed to its end.

    Attributes
    ----------
    path : the part that was reached, an EquilibriumPath or the RodPath of any wire; its
        ``residual_history`` holds the Newton decrements of the last attempts.
    outcome : ``limit_point``, ``bifurcation``, ``jump``, ``interpenetration``, ``not_converged`` or
        ``unsupported``.
    message : one sentence.
    critical_time : middle of the time bracket of the critical point, or None.
    """

    def __init__(self, path: Any) -> None:
        super().__init__(path.message)
        self.path = path
        self.outcome = path.outcome
        self.message = path.message
        self.critical_time = path.critical_time

    def __reduce__(self) -> tuple:
        return EquilibriumNotFound, (self.path,)


def require_names(field: str, names: Iterable[str], allowed: Collection[str]) -> None:
    """Raise `InputError` unless all of `names` are `allowed`."""
    for name in names:
        if name not in allowed:
            raise InputError(f"{field} must hold names of {', '.join(allowed)}, got {name!r}")


def require_number(field: str, value: object, low: float, high: float) -> float:
    """Return `value` as a float, or raise `InputError` unless it is a finite number in [low, high].

    `field` is its name in the message.
    """
    allowed = f"[{low:g}, {high:g}]"
    if isinstance(value, bool) or not isinstance(value, numbers.Real):
        raise InputError(f"{field} must be a number in {allowed}, got {shown(value)}")
    try:
        number = float(value)
    except OverflowError:
        number = math.inf
    if not (math.isfinite(number) and low <= number <= high):
        raise InputError(f"{field} must be a finite number in {allowed}, got {shown(value)}")
    return number


def require_integer(field: str, value: object, low: int, high: int) -> int:
    """Return `value` as an int, or raise `InputError` unless it is an integer in [low, high]."""
    if isinstance(value, numbers.Integral) and not isinstance(value, bool) and low <= int(value) <= high:
        return int(value)
    raise InputError(f"{field} must be an integer in [{low}, {high}], got {shown(value)}")


def require_choice(field: str, value: object, choices: tuple[str, ...]) -> str:
    """Return `value`, or raise `InputError` unless it is one of `choices`."""
    if not isinstance(value, str) or value not in choices:
        raise InputError(f"{field} must be one of {', '.join(choices)}, got {shown(value)}")
    return value
