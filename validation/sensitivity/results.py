"""What the sensitivity study finds: changes of the load curves by one input at a time."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from validation.sensitivity.inputs import BEAM, INPUTS, MODELS, WIRE, OpenInput
from validation.sensitivity.topheight import TipCurve
from validation.study.cases import Case
from validation.study.metrics import COMPONENTS, NEGLIGIBLE

ROUNDING = 1e-6  # %: what is smaller is told as nothing


@dataclass(frozen=True)
class Change:
    """What one value of an input does to one model.

    Attributes
    ----------
    input, model, value : which.
    base, curve : with our default and with the value.
    """

    input: OpenInput
    model: str
    value: str
    base: TipCurve
    curve: TipCurve

    @property
    def completed(self) -> bool:
        """Whether full load was reached; only then there is a number."""
        return self.curve.outcome == "completed"

    @cached_property
    def by_load(self) -> np.ndarray:
        """Change of UX, UY, ROTZ at every load, %, (steps, 3); not a number where a component is held."""
        return farther(self.curve.tips, self.base.tips)

    @property
    def at_full(self) -> np.ndarray:
        """Change of UX, UY, ROTZ at full load, %, (3,)."""
        return _plain(self.by_load[-1])

    @property
    def place(self) -> tuple[int, int]:
        """Step and component of the largest change."""
        step, component = np.unravel_index(np.nanargmax(np.abs(self.by_load)), self.by_load.shape)
        return int(step), int(component)

    @property
    def largest(self) -> float:
        """Largest change of the load curve with its sign, %."""
        return float(_plain(self.by_load[self.place]))


@dataclass(frozen=True)
class Study:
    """All open inputs of one case.

    Attributes
    ----------
    case : of the paper.
    bases : tip curve of each model with our defaults.
    changes : of both models, in the order of `INPUTS`.
    """

    case: Case
    bases: dict[str, TipCurve]
    changes: tuple[Change, ...]

    def of(self, item: OpenInput, model: str) -> list[Change]:
        """Changes by one input in one model; none where the model has no such input."""
        return [change for change in self.changes if change.input is item and change.model == model]

    def size(self, item: OpenInput, model: str) -> float:
        """Largest change by an input, %; 0 where there is none."""
        return max((abs(change.largest) for change in self.of(item, model) if change.completed), default=0.0)

    def ranked(self) -> list[OpenInput]:
        """Inputs of the case, the largest in either model first."""
        present = [item for item in INPUTS if any(change.input is item for change in self.changes)]
        return sorted(present, key=lambda item: -max(self.size(item, model) for model in MODELS))

    def together(self, model: str, kinds: Iterable[str]) -> float:
        """Root of the sum of squares of the sizes of all inputs of some kinds, %."""
        return math.hypot(*(self.size(item, model) for item in INPUTS if item.kind in kinds))

    def worst(self, model: str, kinds: Iterable[str]) -> Change:
        """The largest change of a model by inputs of some kinds."""
        able = [c for c in self.changes if c.model == model and c.completed and c.input.kind in kinds]
        return max(able, key=lambda change: abs(change.largest))

    @property
    def apart(self) -> float:
        """Largest difference of the two models with our defaults, %."""
        return _most(self.bases[BEAM], self.bases[WIRE])

    def apart_with(self, change: Change) -> float | None:
        """Largest difference of the models, %, with a value in each that has it; None short of full load."""
        curves = self.bases | {
            other.model: other.curve
            for other in self.changes
            if other.input is change.input and other.value == change.value
        }
        if any(curve.outcome != "completed" for curve in curves.values()):
            return None
        return _most(curves[BEAM], curves[WIRE])


def farther(tips: np.ndarray, base: np.ndarray) -> np.ndarray:
    """How much farther the top moves than in the base, % of the base's peak, (steps, 3)."""
    steps = min(len(tips), len(base))
    peaks = np.abs(base).max(axis=0)
    held = peaks <= NEGLIGIBLE * peaks.max()
    way = np.sign(base[np.abs(base).argmax(axis=0), range(len(COMPONENTS))])
    return 100.0 * way * (tips[:steps] - base[:steps]) / np.where(held, np.nan, peaks)


def _most(curve: TipCurve, base: TipCurve) -> float:
    """Largest difference as far as both curves go, %."""
    return float(np.nanmax(np.abs(farther(curve.tips, base.tips))))


def _plain(change: np.ndarray) -> np.ndarray:
    """Without what is only rounding."""
    return np.where(np.abs(change) < ROUNDING, 0.0, change)
