"""Numerics of the equivalent beam: what `equivbeam.solve` is asked for beside the scene."""

from collections.abc import Mapping
from dataclasses import asdict, dataclass, fields
from typing import Any, Self

from coilspring.errors import InputError, require_choice
from coilspring.words import shown
from equivbeam.laws import law_of, name_of
from equivbeam.laws.helix import Refinements
from equivbeam.laws.userlaw import UserLaw

EXACT, PAPER, PRINTED = 0, 1, 2
TANGENTS = {"exact": EXACT, "paper": PAPER, "paper-printed": PRINTED}


@dataclass(frozen=True)
class BeamOptions:
    """Options of `equivbeam.solve`, checked: `InputError` for no choice, or what goes with one law alone."""

    law: str | UserLaw = "haringx"
    tangent: str = "exact"
    sliding: str = "ignore"
    refinements: Refinements | None = None

    def __post_init__(self) -> None:
        object.__setattr__(self, "law", law_of(self.law))
        law, tangent, refinements = name_of(self.law), self.tangent, self.refinements
        require_choice("tangent", tangent, tuple(TANGENTS))
        require_choice("sliding", self.sliding, ("ignore", "scene"))
        if law != "haringx" and tangent != "exact":
            raise InputError(f"tangent must be exact with law {law}, got {tangent!r}")
        if refinements is not None and not isinstance(refinements, Refinements):
            raise InputError(f"refinements must be equivbeam.Refinements, got {shown(refinements)}")
        if refinements is not None and law != "helix":
            raise InputError(f"refinements must be left out unless the law is helix, got them with {law!r}")

    @classmethod
    def of(cls, stored: Mapping[str, Any]) -> Self:
        """The options that a path keeps; see `stored`."""
        given = {item.name: stored[item.name] for item in fields(cls) if item.name in stored}
        if isinstance(given.get("refinements"), Mapping):
            given["refinements"] = Refinements(**given["refinements"])
        return cls(**given)

    def stored(self) -> dict[str, object]:
        """The options as a path keeps them: texts, and a table where it is given."""
        options: dict[str, object] = {"law": str(self.law), "tangent": self.tangent, "sliding": self.sliding}
        if self.refinements is not None:
            options["refinements"] = asdict(self.refinements)
        return options
