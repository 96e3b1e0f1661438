"""Fit the equivalent beam to a load curve, of the wire model or measured."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from coilspring.benchfile import Source
from coilspring.errors import InputError, require_names
from coilspring.path import EquilibriumPath
from coilspring.scene import Factors, Scene, require_scene
from coilspring.words import plain, shown
from equivbeam import fiterrors
from equivbeam.curvefit import OFFSET, CurveFit
from equivbeam.fiterrors import constant_part, undetermined
from equivbeam.loadcurve import read_curve
from equivbeam.sensitivity import FACTORS, NAMES, distinct_names, unit

HELPS = 0.5  # share of the square of the error left that an offset takes away, to be named
POOR = 0.03  # rms error, over the peaks, above which a model does not fit
SYSTEMATIC = 1.5  # times the scatter between neighbouring points, above which an rms error is no scatter
EXACT = 1e-8  # rms error, of the peaks, that the iteration may leave
CONFIDENCE = 0.95
TOO_FEW = "fewer than 3 different points do not tell how well the model fits"
ALIKE = 0.99  # correlation of two errors, beyond which the curve hardly tells one parameter from the other


@dataclass(frozen=True)
class Calibration:
    """What a fit found, and what the curve does not determine.

    Attributes
    ----------
    scene : the one given, with the fitted parameters.
    names, values, start : of the parameters; those at which the search began.
    errors : their standard errors, from the residuals and the curve's derivatives; nan for undetermined
        parameters, and for all where the curve has no more numbers than `rank`, where its points lie on the
        model, or where `misfit` says why.
    correlations : of the errors, (parameters, parameters); nan of parameters that were not fitted.
    freedom : degrees of freedom of Student's distribution of the errors.
    rank : of the curve's derivatives by the parameters: so many were fitted.
    undetermined : names of parameters that can change, some together, without moving the curve, or whose
        standard error is more than half of the value.
    fixed : those of them that stay at their start; the values of the others hold for these.
    instead : of each of `fixed`, the fitted parameters that can stand for it.
    misfit : what tells that the model does not follow the curve, or that nothing tells it, in one sentence;
        empty where it does.
    path : of the fitted scene, under the curve's load.
    rms_before, rms_after : root mean square error over the peaks of the columns.
    scatter : of the curve's points from their neighbours, in the same measure.
    evaluations : paths followed.
    """

    scene: Scene
    names: tuple[str, ...]
    values: np.ndarray
    start: np.ndarray
    errors: np.ndarray
    correlations: np.ndarray
    freedom: int
    rank: int
    undetermined: tuple[str, ...]
    fixed: tuple[str, ...]
    instead: tuple[tuple[str, ...], ...]
    misfit: str
    path: EquilibriumPath
    rms_before: float
    rms_after: float
    scatter: float
    evaluations: int

    @property
    def intervals(self) -> np.ndarray:
        """Confidence intervals of 95 %, (parameters, 2); nan without a standard error."""
        from scipy.special import stdtrit

        half = self.errors * stdtrit(max(self.freedom, 1), 0.5 + 0.5 * CONFIDENCE)
        return np.stack((self.values - half, self.values + half), axis=1)

    @property
    def units(self) -> tuple[str, ...]:
        """Of the values; empty for pure numbers."""
        return tuple("mm" if name == OFFSET else unit(self.scene, name) for name in self.names)

    @property
    def alike(self) -> list[tuple[str, str, float]]:
        """Names of two fitted parameters that nearly stand for each other, and their errors' correlation."""
        pairs = np.argwhere(np.triu(np.abs(self.correlations) > ALIKE, 1))
        return [(self.names[i], self.names[j], float(self.correlations[i, j])) for i, j in pairs]

    def __str__(self) -> str:
        """A line for each parameter, one for the fit, and one for any two that are `alike`."""
        lines = []
        columns = (self.names, self.values, self.errors, self.intervals, self.units)
        for name, value, error, (low, high), measure in zip(*columns, strict=True):
            of = f" {measure}" if measure else ""
            if name in self.fixed:
                others = " and ".join(self.instead[self.fixed.index(name)])
                why = f"tell it from {others}" if others else "determine it"
                what = f"left at its start: the curve does not {why}"
            elif name in self.undetermined:
                what = "with those left that can stand for it: the curve does not determine it alone"
            else:
                known = f"standard error {plain(error)}{of}, 95 % interval {low:.6g} to {high:.6g}{of}"
                exact = (
                    ": the points lie on the model, so there is no scatter to take it from"
                    if self.rms_after <= EXACT
                    else ""
                )
                what = f"standard error unknown{exact}" if np.isnan(error) else known
                held = [
                    fixed for fixed, others in zip(self.fixed, self.instead, strict=True) if name in others
                ]
                what += f", with {' and '.join(held)} as given" if held else ""
            lines.append(f"{name} {value:.6g}{of}, {what}")
        fit = f"rms error {self.rms_before:.2g} -> {self.rms_after:.2g} of the curve's peaks"
        lines.append(f"{self.rank} of {len(self.names)} parameters fitted; {fit}")
        lines += [
            f"{one} and {other} nearly stand for each other (correlation {of:.3f}): each is known "
            "only as far as the other one is"
            for one, other, of in self.alike
        ]
        return "\n".join([*lines, *([f"warning: {self.misfit}"] if self.misfit else [])])


def calibrate(
    scene: Scene,
    curve: EquilibriumPath | Source,
    parameters: Sequence[str],
    **options: Any,
) -> Calibration:
    """Fit parameters of a scene so that the equivalent beam follows a load curve; least squares.

    A parameter that does not move the curve, or that others before it in `parameters` can stand for, stays
    at its start and is named in the result.

    Parameters
    ----------
    scene : Scene
        What is fitted; its parameters are where the search begins.
    curve : EquilibriumPath, table or CSV file
        Columns ``force`` (N) and ``deflection`` (mm), both in the direction of the scene's load and in any
        order; or ``time`` (share of the scene's load) and one or more of ``ux``, ``uy`` (mm), ``rotz``
        (rad), as in ``path.csv``. See `coilspring.benchfile`.
    parameters : sequence of str
        penalty, exponent, E, G, the dimensions, and with the paper's law the factors axial, shearing,
        bending; names as in `equivbeam.sensitivities`. Of those that stand for each other the first is
        fitted. E alone keeps Poisson's ratio, G alone keeps E. Besides, ``offset``: the curve's deflection
        of the spring at rest, mm.
    **options
        Those of `equivbeam.solve`.

    Raises
    ------
    InputError : a curve or a name that cannot be used, in one sentence.
    EquilibriumNotFound : the scene as given does not reach the curve's end.
    """
    scene = require_scene(scene)
    if "factors" in options:
        scene = replace(scene, factors=Factors.of(options.pop("factors")))
    names = _named(parameters, options.get("law", "haringx"))
    fit = CurveFit(names, read_curve(curve, scene, OFFSET not in names), options)
    return _fitted(scene, fit, fit.at_start())


def _named(parameters: Sequence[str], law: object) -> tuple[str, ...]:
    """Names of parameters that can be fitted with a law; `InputError` where they are not."""
    names = distinct_names(parameters)
    require_names("parameters", names, (*NAMES, OFFSET))
    factor = next((name for name in names if name in FACTORS), None)
    if factor and law != "haringx":
        raise InputError(f"parameters may hold {factor} with the law haringx alone, got the law {shown(law)}")
    return names


def _fitted(scene: Scene, fit: CurveFit, before: np.ndarray) -> Calibration:
    """Fit a scene, whose residuals are `before` as it is given."""
    names = fit.names
    shares, J, fitted, doubtful = fit.solved()
    after, path = fit.residuals(shares), fit.path
    assert path is not None  # the best point is one that was reached
    lost, left = undetermined(J, fitted, doubtful), [i for i in range(len(names)) if i not in fitted]
    spread, freedom = fiterrors.spread(J, fitted, after, fit.curve.times)
    warning = fit.warning(shares, J, spread, fitted)
    parts = fiterrors.branches(after, fit.curve.times)
    unknown = lost | bool(warning) | (fiterrors.root_mean_square(after) <= EXACT)
    errors = np.where(unknown, np.nan, fit.scale * np.diag(spread))
    misfit = _misfit(after, parts, J[:, fitted])
    if misfit and misfit != TOO_FEW and np.isfinite(errors).any():
        misfit += "; the intervals take the error left for chance, and can miss the true values"
    return Calibration(
        scene=fit.scene_of(shares, scene),
        names=names,
        values=fit.values(shares),
        start=fit.values(np.ones(len(names))),
        errors=errors,
        correlations=fiterrors.correlations(J, fitted),
        freedom=freedom,
        rank=fitted.size,
        undetermined=tuple(name for name, gone in zip(names, lost, strict=True) if gone),
        fixed=tuple(names[i] for i in left),
        instead=tuple(tuple(names[j] for j in fiterrors.instead_of(J, fitted, i)) for i in left),
        misfit="; ".join(filter(None, (misfit, warning))),
        path=path,
        rms_before=fiterrors.root_mean_square(before),
        rms_after=fiterrors.root_mean_square(after),
        scatter=fiterrors.scatter(parts),
        evaluations=fit.evaluations,
    )


def _misfit(residuals: np.ndarray, parts: Sequence[fiterrors.Branch], J: np.ndarray) -> str:
    """In words that the residuals are no scatter, or nothing; `parts`: their `fiterrors.branches`."""
    rms, scatter = fiterrors.root_mean_square(residuals), fiterrors.scatter(parts)
    left = fiterrors.root_mean_square(np.concatenate([part.means for part in parts]))
    poor, systematic = rms > POOR, left > max(SYSTEMATIC * scatter, EXACT)
    if not (poor or systematic):
        return "" if np.isfinite(scatter) else TOO_FEW
    what = "the model does not fit the curve" if poor else "the error left is systematic"
    found = f"{what}: {plain(100 * rms)} % of the peaks rms"
    if not np.isfinite(scatter):
        return found
    found += f", where neighbouring points scatter by {plain(100 * scatter)} %"
    apart = fiterrors.hysteresis(parts)
    if apart > SYSTEMATIC * scatter:
        found += f"; loading and unloading differ by {plain(100 * apart)} %, and the model has no hysteresis"
    constant = constant_part(J, residuals)
    cure = f"; an offset of the deflection takes {100 * constant:.0f} % of its square away: fit offset too"
    return found + (cure if constant > HELPS else "")
