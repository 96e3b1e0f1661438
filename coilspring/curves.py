"""Deviation of two equilibrium paths of one scene: load curves and shapes."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from coilspring.errors import InputError
from coilspring.path import EquilibriumPath, require_path
from coilspring.scene.load import stage_ends
from coilspring.scene.sizing import middle_diameter

COMPONENTS = ("ux", "uy", "rotz")
# A component whose reference peak is below this share of the largest one is fixed, or only rounding.
NEGLIGIBLE = 1e-9
SYMMETRIC = 1e-5  # the same of what symmetry would leave at zero, and a mesh or contact moves
NAN = float("nan")


@dataclass(frozen=True)
class Curve:
    """What a top answers to its load, as far as it goes."""

    times: np.ndarray  # (steps,)
    answers: np.ndarray  # (steps, components) UX, UY, mm, ROTZ, rad; for a prescribed UY the axial force, N

    @classmethod
    def of(cls, path: EquilibriumPath) -> Curve:
        """Curve of a path."""
        return cls.answered(path.times, path.tips, path.loads[:, 1] if path.scene.load.displacement else None)

    @classmethod
    def answered(cls, times: np.ndarray, tips: np.ndarray, force: np.ndarray | None) -> Curve:
        """Curve of tips, (steps, components), and of the axial force that holds a prescribed UY."""
        return cls(times, tips if force is None else np.column_stack((tips[:, 0], force, tips[:, 2])))

    @property
    def by_name(self) -> dict[str, np.ndarray]:
        """Answers of each of `COMPONENTS`, (steps,)."""
        return dict(zip(COMPONENTS, self.answers.T, strict=True))


@dataclass(frozen=True)
class Comparison:
    """Differences of a path from a reference; not a number where no time, or no shape, is common to both.

    Attributes
    ----------
    curve_max, curve_rms : difference at the same load over the reference's peak, of the component
        with the largest maximum, and of the one with the largest root mean square.
    shape_max, shape_rms : distance of the centres of the contact circles at `last_time`, mm.
    component_max, component_rms : the curve errors of UX, UY, ROTZ alone; components that the
        reference does not move, or by less than 1e-5 of its largest motion, are left out; "uy" is the axial
        force where UY is prescribed.
    steps : number of common times.
    last_time : last common time, 0 where there is none.
    """

    curve_max: float
    curve_rms: float
    shape_max: float
    shape_rms: float
    component_max: dict[str, float]
    component_rms: dict[str, float]
    steps: int
    last_time: float


def compare_paths(path: EquilibriumPath, reference: EquilibriumPath) -> Comparison:
    """Compare two paths of one spring under one load at the times that both reached.

    Parameters
    ----------
    path : the path that is compared.
    reference : the path whose peaks the curve errors are divided by.

    Raises
    ------
    InputError : their loads differ, or how often their wires cross the working plane.
    """
    for name, each in (("path", path), ("reference", reference)):
        require_path(each, f"{name} must be an EquilibriumPath")
    mine, theirs = path.scene.load, reference.scene.load
    prescribed = bool(mine.displacement) != bool(theirs.displacement)
    if prescribed or not np.array_equal(stage_ends(mine), stage_ends(theirs)):
        raise InputError(f"paths that are compared must have one load, got {mine} and {theirs}")
    circles = [each.scene.spring.circle_phases().size for each in (path, reference)]
    if circles[0] != circles[1]:
        raise InputError(
            "paths that are compared must be of one spring, got wires that cross the working plane "
            f"{circles[0]} and {circles[1]} times"
        )
    times, here, there = np.intersect1d(path.times, reference.times, return_indices=True)
    curve = compare_curves(Curve.of(path), reference)
    if times.size == 0:
        return curve
    vectors = path.circle_centres(here[-1]) - reference.circle_centres(there[-1])
    distance = np.linalg.norm(vectors, axis=1)
    return replace(curve, shape_max=float(distance.max()), shape_rms=float(np.sqrt(np.mean(distance**2))))


def compare_curves(curve: Curve, path: EquilibriumPath) -> Comparison:
    """Compare a load curve with that of a path at the times of both; the shape is not a number.

    Parameters
    ----------
    curve : what is compared.
    path : the reference, by whose peaks, of all its times, the curve errors are divided. Motions are compared
        in mm, of ROTZ that of a coil's radius; what symmetry would leave at zero is left out.
    """
    reference = Curve.of(path)
    # equal fractions of time are equal numbers, whatever the two numbers of steps
    common, mine, theirs = np.intersect1d(curve.times, reference.times, return_indices=True)
    if common.size == 0:
        return Comparison(NAN, NAN, NAN, NAN, {}, {}, 0, 0.0)
    moves = moved(path.tips * (1.0, 1.0, 0.5 * middle_diameter(path.scene.spring)), SYMMETRIC)
    names = np.array(COMPONENTS)[moves].tolist()
    peaks = np.abs(reference.answers[:, moves]).max(axis=0, initial=0.0)
    relative = (curve.answers[mine] - reference.answers[theirs])[:, moves] / peaks
    sizes = (np.abs(relative).max(axis=0), np.sqrt(np.mean(relative**2, axis=0)))
    curve_max, curve_rms = (float(each.max()) for each in sizes)
    largest, rms = (dict(zip(names, each.tolist(), strict=True)) for each in sizes)
    ends = (common.size, float(common[-1]))
    return Comparison(curve_max, curve_rms, NAN, NAN, largest, rms, *ends)


def over_peak(
    answers: np.ndarray, reference: np.ndarray, rows: np.ndarray | slice = slice(None)
) -> np.ndarray:
    """Difference of answers (steps, components) from some rows of a reference, over its peaks in all rows.

    Not a number where the reference does not move.
    """
    peaks = np.abs(reference).max(axis=0, initial=0.0)
    return (answers - reference[rows]) / np.where(moved(reference), peaks, NAN)


def moved(answers: np.ndarray, share: float = NEGLIGIBLE) -> np.ndarray:
    """Which components of answers (steps, components) move by more than a share of the largest peak; unless
    given, the others are fixed, or only rounding.

    One that is not a number counts as moving: a deviation from it is then no number either, and not left out.
    """
    peaks = np.abs(answers).max(axis=0, initial=0.0)
    return ~(peaks <= share * np.nanmax(peaks, initial=0.0))
