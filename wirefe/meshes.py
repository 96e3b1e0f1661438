"""What meshes leave of the error of a load path, as paths on two of them tell it.

A level n has n curved elements a turn (`STRAIGHT` n straight ones where end turns rest on plates). What
elements leave falls with the square of the level, and what stations of wires leave with the square of their
number; where coils touch, both do so irregularly.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

from coilspring.curves import answered, compare_curves
from coilspring.errors import InputError
from coilspring.path import EquilibriumPath
from coilspring.scene import Scene
from coilspring.scene.profile import TWO_PI
from wirefe.contact.points import PER_TURN

FINEST, FINEST_STRAIGHT = 128, 32  # levels
STRAIGHT, STATIONS = 10, 8  # elements of a plate-seated spring, and stations at first, of level 1
MOST = 960  # stations; a few more have to be allowed
FALL = 0.5  # of what paths before have told is what two tell, at least: they may agree by chance
ELEMENT = 10.0  # stations take as long as one element
TINY = 1e-12  # of the time 0..1
FRACTION = 1_000  # of a coil at most, at which a spring or a section of it ends


@dataclass(frozen=True)
class Levels:
    """The meshes of a scene.

    Attributes
    ----------
    scene : what is solved.
    multiple : a level is a multiple of it.
    spheres : a turn, or None with stations.
    """

    scene: Scene
    multiple: int
    spheres: int | None

    @classmethod
    def of(cls, scene: Scene, pairs_per_turn: int | None) -> Levels:
        """Meshes with a node wherever the spring or a section of it ends, and on every sphere."""
        spheres = None
        if scene.contact.geometry == "spheres":
            spheres = PER_TURN["spheres"] if pairs_per_turn is None else pairs_per_turn
        elif pairs_per_turn is not None:
            raise InputError(
                f"pairs_per_turn goes with accuracy for contact of spheres alone, got {pairs_per_turn!r} "
                "with geometry wires"
            )
        ends = [*(scene.spring.profile.knots / TWO_PI), scene.spring.end_turns]
        fits = (q for q in range(1, FRACTION + 1) if all(abs(q * x - round(q * x)) < 1e-6 for x in ends))
        return cls(scene, math.lcm(next(fits, 1), spheres or 1), spheres)

    @property
    def finest(self) -> int:
        """The last level."""
        return self.at_least(FINEST_STRAIGHT if self.scene.supports.seat == "plate" else FINEST)

    def at_least(self, level: float) -> int:
        """The next level from here."""
        return self.multiple * math.ceil(level / self.multiple - 1e-9)

    def options(self, level: int, stations: int | None = None) -> dict[str, Any]:
        """Options of `wirefe.solve`; `STATIONS` a level unless given."""
        plates = self.scene.supports.seat == "plate"
        return {
            "element": "straight" if plates else "curved",
            "elements_per_turn": STRAIGHT * level if plates else level,
            "pairs_per_turn": self.spheres or stations or min(STATIONS * level, MOST),
        }


@dataclass(frozen=True)
class Trial:
    """A path on a level with stations; `FEWEST` where these make no error: of spheres, or nothing touches."""

    level: int
    stations: int
    path: EquilibriumPath


@dataclass(frozen=True)
class Errors:
    """What elements leave, times the square of the level, and stations, times the square of their number."""

    elements: float = 0.0
    stations: float = 0.0

    def at(self, level: int, stations: int) -> float:
        """Error of a mesh."""
        return self.elements / level**2 + self.stations / stations**2

    def seen(self, a: Trial, b: Trial) -> Errors:
        """The errors as a finer path tells them, too.

        Where its elements and its stations are more, it scales both errors if they are known; else each is
        half of the difference. Where paths have ended otherwise nothing is known.
        """
        apart = difference(a.path, b.path)
        known = self if math.isfinite(apart + self.elements + self.stations) else Errors()
        finer, denser = b.level > a.level, b.stations > a.stations
        if finer and denser and known.elements and known.stations:
            scale = max(FALL, apart / known.at(a.level, a.stations))
            return Errors(scale * known.elements, scale * known.stations)
        elements, stations = known.elements, known.stations
        if finer and denser:
            apart *= 0.5
        if finer:
            elements = max(FALL * elements, apart / (a.level**-2 - b.level**-2))
        if denser:
            stations = max(FALL * stations, apart / (a.stations**-2 - b.stations**-2))
        return Errors(elements, stations)

    def cheapest(self, wanted: float) -> tuple[float, float]:
        """Level and stations that leave no more than the error wanted and take the least time."""
        a, b = (each ** (1.0 / 3.0) for each in (self.elements, self.stations * ELEMENT**-2))
        both = math.sqrt((a + b) / wanted)
        return a * both, ELEMENT * b * both


def difference(coarse: EquilibriumPath, fine: EquilibriumPath) -> float:
    """Of two load curves, and of the times at which they end early; infinite where they end otherwise."""
    if coarse.outcome != fine.outcome:
        return math.inf
    found = compare_curves(coarse.times, answered(coarse), fine)
    curve = found.curve_max if found.steps else 0.0
    if coarse.end_bracket is None or fine.end_bracket is None:
        return curve
    mine, other = sum(coarse.end_bracket), sum(fine.end_bracket)
    return max(curve, abs(mine - other) / max(mine, other, TINY))
