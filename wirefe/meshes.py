"""Meshes that are finer and finer, and how paths on them differ.

A level n has n curved elements a turn (`STRAIGHT` n straight ones where end turns rest on plates), and where
wires touch `STATIONS` n stations. Errors fall with the square of the level, where wires touch irregularly;
most of it comes from the stations, which cost less.
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
STRAIGHT, STATIONS = 10, 12  # elements of a plate-seated spring, and stations, of level 1
FEWEST, MOST = 16, 1536  # stations: where nothing touches; a few more have to be allowed
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
        """Options of `wirefe.solve`; stations that go with the level unless given."""
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
