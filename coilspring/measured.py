"""Measured load curves: force and deflection along the load of a scene."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from coilspring.benchfile import CurveTable, Source, named, read_table
from coilspring.errors import InputError
from coilspring.scene import Scene
from coilspring.scene.sizing import sizes
from coilspring.words import counted

MOST_STEPS = 1000  # of a path at the points of a curve, or with interpolation between them
TOE = 5e-3  # of the largest force: below it a bench may not touch the spring yet
ROUNDING = 1e-9  # of it
# Of the largest: no spring is pressed further than there and gives so little. Of the range, by which it is
# further: as a bench lets go it may record a little more.
HARDLY, LATER = 0.05, 0.02
REST = "it counts from the spring at rest, along the load"
BACKWARDS = 0.05  # of the largest deflection: more of a negative one is no scatter


@dataclass(frozen=True)
class Measured:
    """Force along a scene's load, and deflection in its direction; both grow as the spring is loaded."""

    force: np.ndarray  # (points,) N; in the file's order, which need not be monotone
    deflection: np.ndarray  # (points,) mm
    left_out: int  # points with hardly any load, which may be of no spring
    warnings: tuple[str, ...] = ()  # sentences on what is possible, but far off

    def from_rest(self, offset: float, scene: Scene) -> Measured:
        """The same from a spring at rest whose deflection the file counts as `offset`, mm; points before that
        are left out."""
        deflection = self.deflection - offset
        kept = deflection >= -BACKWARDS * deflection.max()
        left_out = self.left_out + int(np.count_nonzero(~kept))
        return Measured(self.force[kept], deflection[kept], left_out, _warnings(deflection, scene))

    @property
    def passed_over(self) -> str:
        """What was left out, in words; empty where nothing was."""
        points = counted(self.left_out, "point")
        return f"{points} before the spring is loaded left out" if self.left_out else ""


def measured(source: Source, scene: Scene, from_rest: bool = True) -> Measured:
    """Force and deflection of a table or a CSV file, in the direction of a scene's load.

    Signs are those of the load, whatever the file's: both columns count up where the force is largest. Where
    the deflection does not count from rest, it may begin anywhere.

    Raises
    ------
    InputError : what is no measured curve, or a scene whose load has several directions, in one sentence.
    """
    table, direction = read_table(source), scene.direction
    with named(table.file):
        found = _along_load(table, direction)
        _refuse_impossible(found.deflection, scene, from_rest)
        return replace(found, warnings=_warnings(found.deflection, scene)) if from_rest else found


def equal_steps(times: np.ndarray, otherwise: int = MOST_STEPS) -> int:
    """Number of equal steps that include the times above 0, or so many that one can interpolate."""
    steps = round(1.0 / np.diff(np.unique(np.append(0.0, times))).min())
    exact = np.allclose(np.rint(times * steps), times * steps, rtol=0.0, atol=1e-9 * steps)
    return steps if steps <= MOST_STEPS and exact else otherwise


def _along_load(table: CurveTable, direction: tuple[float, float]) -> Measured:
    """Force and deflection of a curve, along the direction of a scene's load."""
    columns, (x, y) = table.columns, direction
    if "force" in columns:
        force, deflection = columns["force"], columns["deflection"]
    else:
        parts = [[("load_x", x), ("load_y", y)], [("ux", x), ("uy", y)]]
        needed = [name for kind in parts for name, part in kind if part]
        if missing := [name for name in needed if name not in columns]:
            raise InputError(f"curve must have columns force and deflection, or {', '.join(needed)}; "
                             f"{missing[0]} is missing")  # fmt: skip
        force, deflection = (np.sum([p * columns[name] for name, p in kind if p], axis=0) for kind in parts)
    if not len(force):
        raise InputError("curve must have at least one line of numbers, got none")
    peak = int(np.argmax(np.abs(force)))
    force, deflection = force * np.sign(force[peak]), deflection * (np.sign(deflection[peak]) or 1.0)
    loaded = force >= (1.0 - ROUNDING) * TOE * force[peak]
    if force[peak] == 0.0 or not (deflection[loaded] != 0.0).any():
        found = f"{force[peak]:.4g} N and {np.abs(deflection[loaded]).max(initial=0.0):.4g} mm"
        raise InputError(
            f"curve must have forces and deflections that are not zero throughout, got {found} at most"
        )
    pressed, moved = force[loaded], deflection[loaded]
    if not np.allclose(pressed, pressed[0]) and (slope := np.polyfit(pressed, moved, 1)[0]) <= 0.0:
        raise InputError(f"deflection must grow with the force, got {slope:.3g} mm/N on the whole: {REST}")
    _refuse_thousandths(("force", "N", force), ("deflection", "mm", deflection), table.places)
    _refuse_thousandths(("deflection", "mm", deflection), ("force", "N", force), table.places)
    return Measured(pressed, moved, int(np.count_nonzero(~loaded)))


def _refuse_thousandths(
    kind: tuple[str, str, np.ndarray], other: tuple[str, str, np.ndarray], places: list[str]
) -> None:
    """Refuse points of hardly any force at more deflection than that of the largest force, and the other way
    round: a separator of thousands reads as a decimal sign."""
    (name, unit, values), (of, its_unit, others) = kind, other
    peak = int(np.argmax(values))
    least, most = HARDLY * values[peak], others[peak] + LATER * np.ptp(others)
    for i in np.flatnonzero((values > 0.0) & (values < least) & (others > most))[:1]:
        raise InputError(
            f"{places[i]} must have a {name} of at least {least:.4g} {unit}, since its {of} of "
            f"{others[i]:.4g} {its_unit} is above that of the largest {name}, {values[peak]:.4g} {unit}, "
            f"got {values[i]:.4g} {unit}: has it a thousands separator?"
        )


def _refuse_impossible(deflection: np.ndarray, scene: Scene, from_rest: bool) -> None:
    """Refuse negative deflections from rest, and a compression by more than the spring's height."""
    least, most, height = deflection.min(), deflection.max(), scene.spring.active_height
    if from_rest and least < -BACKWARDS * most:
        raise InputError(f"deflection must not be negative, got {least:.4g} to {most:.4g} mm: {REST}")
    start = 0.0 if from_rest else least
    if scene.direction[1] == -1.0 and most - start > height:
        raise InputError(
            f"deflection must grow by at most spring.active_height = {height:g} mm, got {start:.4g} to "
            f"{most:.4g} mm"
        )


def _warnings(deflection: np.ndarray, scene: Scene) -> tuple[str, ...]:
    """What is possible, but far off."""
    most = deflection.max()
    if scene.direction[1] != -1.0 or most <= (travel := sizes(scene).travel):
        return ()
    return (f"the measured deflection of {most:.4g} mm is beyond solid: there are {travel:.4g} mm",)
