"""Deviation of two equilibrium paths of one scene: load curves and shapes."""

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from coilspring.path import EquilibriumPath

COMPONENTS = ("ux", "uy", "rotz")
# A component whose reference peak is below this share of the largest one is fixed, or only rounding.
NEGLIGIBLE = 1e-9
NAN = float("nan")


@dataclass(frozen=True)
class Comparison:
    """Differences of a path from a reference; not a number where no time, or no shape, is common to both.

    Attributes
    ----------
    curve_max, curve_rms : difference at the same load over the reference's peak, of the component
        with the largest maximum, and of the one with the largest root mean square.
    shape_max, shape_rms : distance of the centres of the contact circles at `last_time`, mm.
    component_max, component_rms : the curve errors of UX, UY, ROTZ alone; components that the
        reference does not move are left out; "uy" is the axial force where UY is prescribed.
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
    """
    times, mine, theirs = np.intersect1d(path.times, reference.times, return_indices=True)
    curve = compare_curves(path.times, answered(path), reference)
    if times.size == 0:
        return curve
    vectors = path.circle_centres(mine[-1]) - reference.circle_centres(theirs[-1])
    distance = np.linalg.norm(vectors, axis=1)
    return replace(curve, shape_max=float(distance.max()), shape_rms=float(np.sqrt(np.mean(distance**2))))


def compare_curves(
    times: np.ndarray, responses: Mapping[str, np.ndarray], reference: EquilibriumPath
) -> Comparison:
    """Compare a load curve alone with a path; the shape is not a number.

    Parameters
    ----------
    times : (steps,) of the load.
    responses : of each of `COMPONENTS`, (steps,): mm, rad; "uy" the axial force, N, where UY is prescribed.
    reference : the path whose peaks the curve errors are divided by.
    """
    # equal fractions of time are equal numbers, whatever the two numbers of steps
    common, mine, theirs = np.intersect1d(times, reference.times, return_indices=True)
    if common.size == 0:
        return Comparison(NAN, NAN, NAN, NAN, {}, {}, 0, 0.0)
    curves, wanted = stacked(responses), stacked(answered(reference))
    moved = peaks(wanted)
    relative = (curves[mine] - wanted[theirs]) / moved
    kept = [i for i, peak in enumerate(moved) if peak < np.inf]
    names, relative = [COMPONENTS[i] for i in kept], relative[:, kept]
    largest = dict(zip(names, np.abs(relative).max(axis=0).tolist(), strict=True))
    rms = dict(zip(names, np.sqrt(np.mean(relative**2, axis=0)).tolist(), strict=True))
    ends = (common.size, float(common[-1]))
    return Comparison(max(largest.values()), max(rms.values()), NAN, NAN, largest, rms, *ends)


def answered(path: EquilibriumPath) -> dict[str, np.ndarray]:
    """What a path answers to its load, each (steps,): the reaction where UY is prescribed."""
    answers = dict(zip(COMPONENTS, path.tips.T, strict=True))
    if path.scene.load.displacement:
        answers["uy"] = path.loads[:, 1]
    return answers


def stacked(answers: Mapping[str, np.ndarray]) -> np.ndarray:
    """Answers of all `COMPONENTS`, (steps, components)."""
    return np.column_stack([answers[name] for name in COMPONENTS])


def peaks(curves: np.ndarray) -> np.ndarray:
    """Peaks of curves (steps, components), which differences are divided by; infinite where one is fixed."""
    largest = np.abs(curves).max(axis=0)
    return np.where(largest > NEGLIGIBLE * largest.max(), largest, np.inf)
