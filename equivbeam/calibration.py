"""Fit the equivalent beam to a load curve, of the wire model or measured."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from coilspring.errors import EquilibriumNotFound, InputError, plain, require_names, shown
from coilspring.path import EquilibriumPath
from coilspring.scene import Factors, Scene, require_scene
from equivbeam import fiterrors
from equivbeam.fiterrors import constant_part, independent, undetermined
from equivbeam.loadcurve import LoadCurve, read_curve
from equivbeam.sensitivity import AT_NU, FACTORS, NAMES, sensitivities, unit, values, varied
from equivbeam.solve import ADVICE, solve

if TYPE_CHECKING:
    import pandas as pd

SCATTER = 0.5  # standard error over the value, above which it is not told from 0 with 95 % confidence
ALIKE = 0.1  # of a parameter's relative change: one that changes by more with it can stand for it
FAR = (0.2, 5.0)  # share of its value at the start between which a parameter is searched
OFFSET = "offset"  # of the curve's deflection, mm: a parameter beside those of the scene
CLOSE = 1e-3  # to a bound of the search: the fit has stopped at it
CURVED = 1.0  # relative error of the derivatives over a step of one standard error, at most
ROUNDING = 1e-6  # of the residuals, over the peaks
HELPS = 0.5  # share of the square of the error left that an offset takes away, to be named
LOST = 1.0  # error, over the peak, of rows that a trial does not reach
POOR = 0.03  # rms error, over the peaks, above which a model does not fit
SYSTEMATIC = 1.5  # times the scatter between neighbouring points, above which an rms error is no scatter
EXACT = 1e-8  # rms error, of the peaks, that the iteration may leave
CONFIDENCE = 0.95


@dataclass(frozen=True)
class Calibration:
    """What a fit found, and what the curve does not determine.

    Attributes
    ----------
    scene : the one given, with the fitted parameters.
    names, values, start : of the parameters; those at which the search began.
    errors : their standard errors, from the residuals and the curve's derivatives; nan for undetermined
        parameters, and for all where the curve has no more numbers than `rank` or `misfit` says why.
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

    def __str__(self) -> str:
        """A line for each parameter, and one for the fit."""
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
                what = "standard error unknown" if np.isnan(error) else known
                held = [
                    fixed for fixed, others in zip(self.fixed, self.instead, strict=True) if name in others
                ]
                what += f", with {' and '.join(held)} as given" if held else ""
            lines.append(f"{name} {value:.6g}{of}, {what}")
        fit = f"rms error {self.rms_before:.2g} -> {self.rms_after:.2g} of the curve's peaks"
        lines.append(f"{self.rank} of {len(self.names)} parameters fitted; {fit}")
        return "\n".join([*lines, *([f"warning: {self.misfit}"] if self.misfit else [])])


def calibrate(
    scene: Scene,
    curve: EquilibriumPath | pd.DataFrame | str | Path,
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
        (rad), as in ``path.csv``. See `coilspring.measured`.
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
    scene, names = require_scene(scene), tuple(parameters)
    if "factors" in options:
        scene = replace(scene, factors=Factors.of(options.pop("factors")))
    if isinstance(parameters, str) or not names or len(set(names)) < len(names):
        got = parameters if isinstance(parameters, str) else ",".join(map(str, names))
        raise InputError(f"parameters must be a list of different names, got {shown(got)}")
    require_names("parameters", names, (*NAMES, OFFSET))
    law, factor = options.get("law", "haringx"), next((name for name in names if name in FACTORS), None)
    if factor and law != "haringx":
        raise InputError(f"parameters may hold {factor} with the law haringx alone, got the law {shown(law)}")
    fit = CurveFit(names, read_curve(curve, scene, OFFSET not in names), options)
    before = fit.at_start()
    shares, J, fitted, doubtful = fit.solved()
    after, path, evaluations = fit.residuals(shares), fit.path, fit.evaluations
    assert path is not None  # the best point is one that was reached
    lost, left = undetermined(J, fitted, doubtful), [i for i in range(len(names)) if i not in fitted]
    spread, freedom = fiterrors.spread(J, fitted, after, fit.curve.times)
    doubt = fit.doubt(shares, J, spread, fitted)
    rows = fiterrors.means(after, fit.curve.times)
    scatter, rms = fiterrors.scatter(rows), fiterrors.root_mean_square(after)
    slow = fiterrors.root_mean_square(rows) > max(SYSTEMATIC * scatter, EXACT)
    return Calibration(
        scene=fit.scene_of(shares, scene),
        names=names,
        values=fit.values(shares),
        start=fit.values(np.ones(len(names))),
        errors=np.where(lost | bool(doubt), np.nan, fit.scale * np.diag(spread)),
        freedom=freedom,
        rank=fitted.size,
        undetermined=tuple(name for name, gone in zip(names, lost, strict=True) if gone),
        fixed=tuple(names[i] for i in left),
        instead=tuple(tuple(names[j] for j in fiterrors.instead_of(J, fitted, i)) for i in left),
        misfit="; ".join(
            filter(None, (_misfit(rms, scatter, slow, constant_part(J[:, fitted], after)), doubt))
        ),
        path=path,
        rms_before=fiterrors.root_mean_square(before),
        rms_after=rms,
        scatter=scatter,
        evaluations=evaluations,
    )


def _misfit(rms: float, scatter: float, systematic: bool, constant: float) -> str:
    """In words that the error left is no scatter, or nothing; `constant`: the share of an offset in it."""
    poor = rms > POOR
    if not (poor or systematic):
        return "" if np.isfinite(scatter) else "fewer than 3 points do not tell how well the model fits"
    what = "the model does not fit the curve" if poor else "the error left is systematic"
    found = f"{what}: {plain(100 * rms)} % of the peaks rms"
    if not np.isfinite(scatter):
        return found
    found += f", where neighbouring points scatter by {plain(100 * scatter)} %"
    cure = f"; an offset of the deflection takes {100 * constant:.0f} % of its square away: fit offset too"
    return found + (cure if constant > HELPS else "")


class CurveFit:
    """Residuals, their derivatives by the parameters' shares of their values at the start, and the least.

    `path` is of the shares that were asked for last, None where it does not reach the curve's end.
    `evaluations` counts the paths followed.
    """

    def __init__(self, names: tuple[str, ...], curve: LoadCurve, options: Mapping[str, Any]) -> None:
        if OFFSET in names and curve.peaks.size > 1:
            raise InputError(f"{OFFSET} can be fitted to force and deflection, got a curve in ux, uy or rotz")
        self.names, self.curve, self.options = names, curve, options
        E = "E" if "G" in names else AT_NU
        self.of_scene = tuple(E if name == "E" else name for name in names if name != OFFSET)
        self.lag = np.array([name == OFFSET for name in names])  # of these parameters the one, if any
        self.scale = np.full(len(names), curve.peaks[0])  # of the shares
        self.scale[~self.lag] = values(curve.scene, self.of_scene)
        self.lowest = np.array([1.0 if name == "exponent" else 0.0 for name in names])  # of the values
        self.path: EquilibriumPath | None = None
        self.evaluations = 0
        self._at: np.ndarray | None = None

    def values(self, shares: np.ndarray) -> np.ndarray:
        """Values of the parameters; an offset starts at 0, with a share of 1."""
        return np.maximum(self.scale * (shares - self.lag), np.where(self.lag, -np.inf, self.lowest))

    def scene_of(self, shares: np.ndarray, scene: Scene) -> Scene:
        """A scene with the values of its parameters."""
        return varied(scene, self.of_scene, self.values(shares)[~self.lag])

    def at_start(self) -> np.ndarray:
        """Residuals of the scene as given; raises why it does not reach the curve's end."""
        start = np.ones(len(self.names))
        try:
            solve(self.scene_of(start, self.curve.scene), **self.options)
        except EquilibriumNotFound as failure:
            # a fit is of this model: another one is no advice
            message = self.curve.beyond(replace(failure.path, message=failure.message.replace(ADVICE, "")))
            raise EquilibriumNotFound(replace(failure.path, message=message)) from None
        return self.residuals(start)

    def solved(self) -> tuple[np.ndarray, np.ndarray, np.ndarray, list[int]]:
        """Shares of the best fit, its derivatives, which were fitted, and which were left for their scatter.

        Parameters that the curve does not determine stay at their start, and the others are fitted once more.
        """
        fitted = np.arange(len(self.names))
        doubtful: list[int] = []
        while True:
            shares = self.best(fitted)
            J = self.rates(shares)
            known = fitted[independent(J[:, fitted])]
            if known.size == fitted.size:
                spread, _ = fiterrors.spread(J, fitted, self.residuals(shares), self.curve.times)
                relative = (np.diag(spread) / shares)[fitted]
                if not (relative > SCATTER).any():
                    return shares, J, fitted, doubtful
                # of those that change with the worst one the first is fitted
                worst = int(np.nanargmax(relative))
                tied = np.abs(spread[fitted, fitted[worst]] / shares[fitted]) > ALIKE * relative[worst]
                last = int(np.flatnonzero(tied & (relative > SCATTER))[-1])
                doubtful.append(int(fitted[last]))
                known = np.delete(fitted, last)
            fitted = known

    def best(self, fitted: np.ndarray) -> np.ndarray:
        """Shares of the least squares, with those that are not `fitted` at the start."""
        from scipy.optimize import least_squares

        ones = np.ones(len(self.names))
        if not fitted.size:
            return ones

        def shares(x: np.ndarray) -> np.ndarray:
            new = ones.copy()
            new[fitted] = x
            return new

        low = np.where(self.lowest > 0.0, np.minimum(self.lowest / self.scale, 1.0 - 1e-9), FAR[0])
        found = least_squares(
            lambda x: self.residuals(shares(x)),
            ones[fitted],
            jac=lambda x: self.rates(shares(x))[:, fitted],
            bounds=(low[fitted], np.full(fitted.size, FAR[1])),
            xtol=1e-10,
            ftol=1e-12,
            gtol=1e-15,  # of squares: with more, a parameter that moves the curve little is left at its start
        )
        return shares(found.x)

    def doubt(self, shares: np.ndarray, J: np.ndarray, spread: np.ndarray, fitted: np.ndarray) -> str:
        """Why standard errors would mislead, in one sentence; empty where they hold.

        One error off in a parameter, the residuals must have changed as their derivatives say.
        """
        for name, share in zip(self.names, shares, strict=True):
            if np.abs(share - FAR).min() < CLOSE:
                return f"the search ended at {FAR[0]:g} or {FAR[1]:g} times the start of {name}: begin nearer"
        for i in fitted:
            for near in (1.0 - CLOSE, 1.0 + CLOSE):
                beyond = shares.copy()
                beyond[i] *= near
                try:
                    self.scene_of(beyond, self.curve.scene)
                except InputError as error:
                    allowed = str(error).partition(", got ")[0]  # what is no value of the user's
                    return f"the search ended at a bound of {self.names[i]}, beyond which {allowed}"
        before = self.residuals(shares)
        for i in fitted if np.isfinite(spread).any() else ():
            for step in (spread[:, i], -spread[:, i]):
                if (self.scale * (shares + step) < self.lowest)[~self.lag].any():
                    continue  # out of its range, as an exponent below 1
                change = self.residuals(shares + step) - before - J @ step
                if self.path is None or np.linalg.norm(change) > CURVED * np.linalg.norm(J @ step) + ROUNDING:
                    return self._vague(i, spread[:, i] / shares)
        return ""

    def _vague(self, i: int, relative: np.ndarray) -> str:
        """That one standard error is too much to be added, in words; with it all parameters change so."""
        others = [self.names[j] for j in np.flatnonzero(np.abs(relative) > ALIKE * relative[i]) if j != i]
        off = f"{self.names[i]} off by its standard error ({plain(100 * relative[i])} %)"
        by = f"no standard errors: with {off}"
        by += f" and {' and '.join(others)} making up for it" if others else ""
        ends, bends = "the path ends before the largest force", "the curve changes out of proportion"
        return f"{by}, {ends if self.path is None else bends}"

    def residuals(self, shares: np.ndarray) -> np.ndarray:
        """Differences of the columns over their peaks, flat."""
        self._follow(shares)
        if self.path is None:
            return np.full(self.curve.shares.size, LOST)
        offset = float((shares - 1.0) @ self.lag)
        return (self.curve.along(self.path, self.path.tips) + offset - self.curve.shares).ravel()

    def rates(self, shares: np.ndarray) -> np.ndarray:
        """Derivatives of the residuals, shape (residuals, parameters)."""
        self._follow(shares)
        J = np.zeros((self.curve.shares.size, len(self.names)))
        if self.path is not None:
            J[:, self.lag] = 1.0
            found = sensitivities(self.path, self.of_scene).tips * self.scale[~self.lag, None]
            for column, rates in zip(np.flatnonzero(~self.lag), found.swapaxes(0, 1), strict=True):
                J[:, column] = self.curve.along(self.path, rates).ravel()
        return J

    def _follow(self, shares: np.ndarray) -> None:
        if self._at is not None and np.array_equal(self._at, shares):
            return
        self._at, self.path = shares.copy(), None
        self.evaluations += 1
        with suppress(EquilibriumNotFound, InputError):
            self.path = solve(self.scene_of(shares, self.curve.scene), **self.options)
