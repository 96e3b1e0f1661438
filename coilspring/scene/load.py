"""Load at the top over time: one force, several stages, or a prescribed displacement."""

from dataclasses import dataclass, field

import numpy as np

from coilspring.errors import InputError, require_number
from coilspring.scene.profile import LONGEST
from coilspring.scene.schema import keep_checked
from coilspring.words import shown

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
    stages: tuple[tuple[float, float], ...] = field(default=(), kw_only=True)
    displacement: tuple[float, ...] = field(default=(), kw_only=True)
    steps: int = 50

    def __post_init__(self) -> None:
        keep_checked(self, "load")
        for name in ("force", "stages", "displacement"):
            if isinstance(given := getattr(self, name), np.ndarray | np.number):
                object.__setattr__(self, name, given.tolist())
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
            both = f"{shown(self.stages)} and {shown(self.displacement)}"
            raise InputError(f"load takes stages or displacement, not both, got {both}")
        if not isinstance(self.stages, list | tuple):
            raise InputError(f"load.stages must be a list of forces [Fx, Fy], got {shown(self.stages)}")
        stages = [_force(f"load.stages[{i}]", stage) for i, stage in enumerate(self.stages)]
        object.__setattr__(self, "stages", _changing("load.stages", stages, (0.0, 0.0)))
        if any(self.force) and self.force != stages[-1]:
            raise InputError(
                f"load.force must be left out beside load.stages, or be the last of them, got {self.force!r}"
            )
        object.__setattr__(self, "force", stages[-1])

    def _keep_displacement(self) -> None:
        if any(self.force):
            raise InputError(f"load.force must be left out beside load.displacement, got {self.force!r}")
        given = self.displacement if isinstance(self.displacement, list | tuple) else (self.displacement,)
        kept = [require_number("load.displacement", uy, -LONGEST, LONGEST) for uy in given]
        object.__setattr__(self, "displacement", _changing("load.displacement", kept, 0.0))

    @property
    def rows(self) -> int:
        """Results wanted in all."""
        return self.steps * (len(self.stages) or len(self.displacement) or 1)


def _force(name: str, value: object) -> tuple[float, float]:
    """Fx and Fy."""
    if not isinstance(value, list | tuple) or len(value) != 2:
        raise InputError(f"{name} must be two numbers [Fx, Fy], got {shown(value)}")
    x, y = (require_number(name, item, -MOST_FORCE, MOST_FORCE) for item in value)
    return x, y


def _changing(name: str, values: list, start: object) -> tuple:
    """Values reached one after the other, each of which differs from the one before."""
    if not 1 <= len(values) <= MOST_STAGES:
        raise InputError(f"{name} must be 1 to {MOST_STAGES} stages, got {len(values)}")
    for place, (before, after) in enumerate(zip([start, *values], values, strict=False)):
        if before == after:
            raise InputError(f"{name}[{place}] must differ from what it begins with, {before}, got {after}")
    return tuple(values)


def stage_ends(load: Load) -> np.ndarray:
    """Forces at the ends of the stages, the beginning included, shape (stages + 1, 2), N; of a prescribed
    displacement its UX, left at 0, and UY, mm."""
    ends = [(0.0, uy) for uy in load.displacement] or load.stages or [load.force]
    return np.array([(0.0, 0.0), *ends])


def given_loads(load: Load, times: np.ndarray) -> np.ndarray:
    """Forces on the top at some times, shape (steps, 2), N."""
    if not load.stages:
        return times[:, None] * np.array(load.force)  # a traced path may go beyond time 1
    ends = stage_ends(load)
    at = np.linspace(0.0, 1.0, len(ends))
    return np.stack([np.interp(times, at, column) for column in ends.T], axis=1)
