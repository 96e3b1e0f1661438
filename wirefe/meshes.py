"""Meshes that are finer and finer, how paths on them differ, and the rows at which they are compared.

A level n has at least n curved elements a turn, and where wires touch `STATIONS` n stations. Errors fall
with the square of the level; where wires touch they do so irregularly, and stations, which cost less than
elements, make most of them.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import cached_property
from typing import Any

import numpy as np

from coilspring.curves import Curve, compare_curves
from coilspring.errors import InputError
from coilspring.path import EquilibriumPath, shape_of
from coilspring.scene import Scene
from coilspring.scene.profile import TWO_PI
from wirefe.contact.points import PER_TURN, places
from wirefe.mesh import MOST_ELEMENTS, is_whole

FINEST = 128  # level
STATIONS = 12  # of level 1
FEWEST, MOST = 16, 1536  # stations: of first paths, and where nothing touches; a few more have to be allowed
CLEAR = 0.05  # wire diameters between coils that do not touch on any mesh
TINY = 1e-12  # of the time 0..1
FRACTION = 1_000  # of a turn at most, at which the elastic wire or a section of it ends
FEW = 4  # meshes that differ by elements alone, at least
ROWS = 5  # of a stage, at least, at which paths are compared whose differences are smooth


@dataclass(frozen=True)
class Levels:
    """The meshes of a scene.

    Attributes
    ----------
    scene : what is solved.
    multiple : the elements of a turn are a multiple of it.
    spheres : a turn, or None with stations.
    """

    scene: Scene
    multiple: int
    spheres: int | None

    @classmethod
    def of(cls, scene: Scene, pairs_per_turn: int | None) -> Levels:
        """Meshes with a node wherever the elastic wire or a section of it ends, and on every sphere."""
        spheres = None
        if scene.contact.geometry == "spheres":
            spheres = PER_TURN["spheres"] if pairs_per_turn is None else pairs_per_turn
        elif pairs_per_turn is not None:
            raise InputError(
                f"pairs_per_turn goes with accuracy for contact of spheres alone, got {pairs_per_turn!r} "
                "with geometry wires"
            )
        ends = dict(_ends(scene))
        fractions = {name: _fraction(name, turns) for name, turns in ends.items()}
        multiple = math.lcm(*fractions.values(), spheres or 1)
        if multiple > MOST_ELEMENTS:
            name = max(fractions, key=fractions.__getitem__)
            raise InputError(
                f"{name} must fit a mesh of {MOST_ELEMENTS} elements per turn for accuracy, together with "
                f"all other ends of the wire, got {ends[name]:.12g}: they take {multiple}"
            )
        return cls(scene, multiple, spheres)

    @property
    def last(self) -> int:
        """The last level with stations."""
        return FINEST

    @property
    def finest(self) -> int:
        """The last level without: a few differ in their elements, at least."""
        fit = MOST_ELEMENTS // self.options(self.multiple)["elements_per_turn"]
        return max(self.at_least(self.last), min(FEW, fit) * self.multiple)

    def at_least(self, level: float) -> int:
        """The next level from here that is the number of its elements."""
        return self.multiple * math.ceil(level / self.multiple - 1e-9)

    def options(self, level: int, stations: int | None = None, beyond: int = 0) -> dict[str, Any]:
        """Options of `wirefe.solve`: more than `beyond` elements per turn, and stations that go with the
        level unless given."""
        return {
            "element": "curved",
            "elements_per_turn": self.at_least(max(level, beyond + 1)),
            "pairs_per_turn": self.spheres or stations or min(STATIONS * level, MOST),
        }


def _ends(scene: Scene) -> list[tuple[str, float]]:
    """Where the elastic wire or a section of it ends, in turns, and what sets it."""
    spring = scene.spring
    coils = (spring.profile.knots[1:] / TWO_PI).tolist()
    names = [f"spring.sections[{i}]: its end" for i in range(len(spring.sections))] or ["spring.active_coils"]
    turns = [("spring.end_turns", spring.end_turns)] if on_plates(scene) else []
    return [*zip(names, coils, strict=True), *turns]


def _fraction(name: str, turns: float) -> int:
    """The least number of elements per turn of which some turns have a whole number."""
    for elements in range(1, FRACTION + 1):
        if is_whole(elements * turns):
            return elements
    nearest = Fraction(turns).limit_denominator(FRACTION)
    raise InputError(
        f"{name} must be a multiple of 1/n turns, n an integer in [1, {FRACTION}], for accuracy, "
        f"got {turns:.12g}; the nearest is {nearest}, {float(nearest):.12g}"
    )


def on_plates(scene: Scene) -> bool:
    """Whether its end turns rest on plates, and are elastic."""
    return scene.supports.seat == "plate"


@dataclass(frozen=True)
class Trial:
    """A path on a level with stations; `FEWEST` of them where they make no error, and at first."""

    level: int
    stations: int
    path: EquilibriumPath

    @property
    def mesh(self) -> dict[str, Any]:
        """Options of `wirefe.solve` with which it was found."""
        return {name: self.path.options[name] for name in ("element", "elements_per_turn", "pairs_per_turn")}

    @property
    def elements(self) -> int:
        """Per turn."""
        return int(self.mesh["elements_per_turn"])

    @cached_property
    def touching(self) -> bool:
        """Whether coils touch, or come so near it that they may on a finer mesh.

        The last states are looked at first, in which coils are mostly nearest.
        """
        path, near = self.path, CLEAR * self.path.scene.spring.wire_diameter
        may = path.states[path.least_gaps < near]
        ends = () if path.last_state is None else (path.last_state[None],)
        return any((path.shape.pair_gaps(states) < near).any() for states in (*ends, may[-1:], may[:-1]))

    @cached_property
    def corner(self) -> Fraction | None:
        """Where on the wire, in turns, the station stands that is pressed deepest, if none beside it touches:
        there may be a corner, as where a section ends, pressed on less than the spacing of stations.
        """
        path = self.path
        if not len(path.states):
            return None
        shape = shape_of(path, "wirefe", "corner")
        lower = shape.data.contact.pairs[:, 0]
        gaps = shape.pair_gaps(path.states[[path.least_gaps.argmin()]])[0]
        station = lower[gaps.argmin()]
        alone = gaps[np.abs(lower - station) == 1].min(initial=np.inf) > 0.0 > gaps.min()
        index, _ = places(path.scene.spring, self.stations)
        return Fraction(int(index[station]), self.stations) if alone else None


def difference(coarse: EquilibriumPath, fine: EquilibriumPath) -> float:
    """Of two load curves, and of the times at which they end early; infinite where they end otherwise."""
    if coarse.outcome != fine.outcome:
        return math.inf
    found = compare_curves(Curve.of(coarse), fine)
    curve = found.curve_max if found.steps else 0.0
    if coarse.end_bracket is None or fine.end_bracket is None:
        return curve
    mine, other = sum(coarse.end_bracket), sum(fine.end_bracket)
    return max(curve, abs(mine - other) / max(mine, other, TINY))


def few(steps: int) -> int:
    """The fewest steps, `ROWS` at least, whose times are among those of `steps`."""
    return next((count for count in range(ROWS, steps) if steps % count == 0), steps)


def thinned(path: EquilibriumPath, scene: Scene, finer: int) -> EquilibriumPath:
    """The rows of the scene's steps, of a path with steps so many times finer."""
    return path if finer == 1 else replace(path.select(slice(finer - 1, None, finer)), scene=scene)
