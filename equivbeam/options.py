"""Numerics of the equivalent beam: what `equivbeam.solve` is asked for beside the scene."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, dataclass, fields
from typing import Any

from coilspring.errors import InputError, require_choice, require_number, shown
from equivbeam.laws import law_of
from equivbeam.laws.helixrows import Refinements
from equivbeam.laws.userlaw import UserLaw

EXACT, PAPER, PRINTED = 0, 1, 2
TANGENTS = {"exact": EXACT, "paper": PAPER, "paper-printed": PRINTED}
SLIDING = ("ignore", "scene")
ALL = Refinements()
ONES = (1.0, 1.0, 1.0)


@dataclass(frozen=True)
class BeamOptions:
    """Options of `equivbeam.solve`, checked; see there.

    Raises
    ------
    InputError : a value that is no choice, or what goes with one law alone, in one sentence.
    """

    law: str | UserLaw = "haringx"
    tangent: str = "exact"
    sliding: str = "ignore"
    refinements: Refinements | None = None
    factors: tuple[float, float, float] = ONES

    def __post_init__(self) -> None:
        object.__setattr__(self, "law", law_of(self.law))
        law, tangent, factors, refinements = str(self.law), self.tangent, self.factors, self.refinements
        require_choice("tangent", tangent, tuple(TANGENTS))
        require_choice("sliding", self.sliding, SLIDING)
        if not isinstance(factors, list | tuple) or len(factors) != 3:
            raise InputError(f"factors must be three numbers, got {shown(factors)}")
        for factor in factors:
            require_number("factors", factor, 1e-3, 1e3)
        if law != "haringx" and tuple(factors) != ONES:
            raise InputError(f"factors must be 1 unless the law is haringx, got {factors!r} with {law!r}")
        if law != "haringx" and tangent != "exact":
            raise InputError(f"tangent must be exact with law {law}, got {tangent!r}")
        if refinements is not None and not isinstance(refinements, Refinements):
            raise InputError(f"refinements must be equivbeam.Refinements, got {shown(refinements)}")
        if refinements is not None and law != "helix":
            raise InputError(f"refinements must be left out unless the law is helix, got them with {law!r}")

    @classmethod
    def of(cls, stored: Mapping[str, Any]) -> BeamOptions:
        """The options that a path keeps; see `stored`."""
        given = {item.name: stored[item.name] for item in fields(cls) if item.name in stored}
        if isinstance(given.get("refinements"), Mapping):
            given["refinements"] = Refinements(**given["refinements"])
        return cls(**given)

    def stored(self) -> dict[str, object]:
        """The options as a path keeps them: numbers, texts and tables; the last two where they are given."""
        options: dict[str, object] = {"law": str(self.law), "tangent": self.tangent, "sliding": self.sliding}
        if self.refinements is not None:
            options["refinements"] = asdict(self.refinements)
        if tuple(self.factors) != ONES:
            options["factors"] = tuple(self.factors)
        return options
