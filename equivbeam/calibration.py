"""Fit the equivalent beam to a load curve, of the wire model or measured."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from coilspring.errors import EquilibriumNotFound, InputError, shown
from coilspring.path import EquilibriumPath
from coilspring.scene import Factors, Scene, require_scene
from equivbeam.loadcurve import LoadCurve, read_curve
from equivbeam.parameters import FACTORS, values, varied
from equivbeam.sensitivity import sensitivities
from equivbeam.solve import solve

if TYPE_CHECKING:
    import pandas as pd

# Singular values of the derivatives, of residuals over peaks by relative changes, over the largest one or 1:
# differences leave up to 6e-10 of what is zero; the weakest direction that was met in the paper's springs
# and in guided ones is 2e-7 (an exponent beside a penalty).
RESOLVED = 1e-8
SCATTER = 0.5  # standard error over the value, above which it is not told from 0 with 95 % confidence
FAR = (0.2, 5.0)  # share of its value at the start between which a parameter is searched
LOST = 1.0  # error, over the peak, of rows that a trial does not reach
TRADED = 1e-3  # relative change of a parameter, for another's by its whole value, that counts


@dataclass(frozen=True)
class Calibration:
    """What a fit found, and what the curve does not determine.

    Attributes
    ----------
    scene : the one given, with the fitted parameters.
    names, values : of the parameters.
    errors : their standard errors, from the residuals and the curve's derivatives, if the model is right;
        nan for undetermined parameters, and for all where the curve has no more numbers than `rank`.
    rank : of the curve's derivatives by the parameters: so many were fitted.
    undetermined : names of parameters that can change, some together, without moving the curve, or whose
        standard error is more than half of the value.
    fixed : those of them that stay at their start; the values of the others hold for these.
    path : of the fitted scene, under the curve's load.
    rms_before, rms_after : root mean square error over the peaks of the columns.
    evaluations : paths followed.
    """

    scene: Scene
    names: tuple[str, ...]
    values: np.ndarray
    errors: np.ndarray
    rank: int
    undetermined: tuple[str, ...]
    fixed: tuple[str, ...]
    path: EquilibriumPath
    rms_before: float
    rms_after: float
    evaluations: int

    def __str__(self) -> str:
        """A line for each parameter, and one for the fit."""
        lines = []
        for name, value, error in zip(self.names, self.values, self.errors, strict=True):
            if name in self.fixed:
                what = "left at its start: the curve does not determine it"
            elif name in self.undetermined:
                what = "with those left that can stand for it: the curve does not determine it alone"
            else:
                what = "standard error unknown" if np.isnan(error) else f"+- {error:.2g}"
            lines.append(f"{name} {value:.6g}, {what}")
        fit = f"rms error {self.rms_before:.2g} -> {self.rms_after:.2g} of the curve's peaks"
        return "\n".join((*lines, f"{self.rank} of {len(self.names)} parameters fitted; {fit}"))


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
        fitted.
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
        raise InputError(f"parameters must be a list of different names, got {shown(parameters)}")
    law, factor = options.get("law", "haringx"), next((name for name in names if name in FACTORS), None)
    if factor and law != "haringx":
        raise InputError(f"{factor} can be fitted with the law haringx alone, got {shown(law)}")
    start = values(scene, names)
    fit = CurveFit(names, start, read_curve(curve, scene), options)
    before = fit.at_start()
    shares, J, fitted, doubtful = fit.solved()
    after = fit.residuals(shares)
    assert fit.path is not None  # the best point is one that was reached
    undetermined = _undetermined(J, fitted, doubtful)
    errors = np.where(undetermined, np.nan, start * _errors(J, fitted, after))
    return Calibration(
        scene=varied(scene, names, start * shares),
        names=names,
        values=start * shares,
        errors=errors,
        rank=fitted.size,
        undetermined=tuple(name for name, lost in zip(names, undetermined, strict=True) if lost),
        fixed=tuple(name for i, name in enumerate(names) if i not in fitted),
        path=fit.path,
        rms_before=float(np.sqrt(np.mean(before**2))),
        rms_after=float(np.sqrt(np.mean(after**2))),
        evaluations=fit.evaluations,
    )


class CurveFit:
    """Residuals, their derivatives by the parameters' shares of their values at the start, and the least.

    `path` is of the shares that were asked for last; where it does not reach the curve's end, `failure` says
    why. `evaluations` counts the paths followed.
    """

    def __init__(
        self, names: tuple[str, ...], start: np.ndarray, curve: LoadCurve, options: Mapping[str, Any]
    ) -> None:
        self.names, self.start, self.curve, self.options = names, start, curve, options
        self.lowest = np.array([1.0 if name == "exponent" else 0.0 for name in names])  # of the values
        self.path: EquilibriumPath | None = None
        self.failure: EquilibriumNotFound | InputError | None = None
        self.evaluations = 0
        self._at: np.ndarray | None = None

    def at_start(self) -> np.ndarray:
        """Residuals of the scene as given; raises why it does not reach the curve's end."""
        residuals = self.residuals(np.ones(len(self.names)))
        if isinstance(self.failure, EquilibriumNotFound):
            message = f"the scene as given does not reach the end of the curve: {self.failure.message}"
            raise EquilibriumNotFound(replace(self.failure.path, message=message))
        if self.failure is not None:
            raise self.failure
        return residuals

    def solved(self) -> tuple[np.ndarray, np.ndarray, np.ndarray, list[int]]:
        """Shares of the best fit, its derivatives, which were fitted, and which were left for their scatter.

        Parameters that the curve does not determine stay at their start, and the others are fitted once more.
        """
        fitted = np.arange(len(self.names))
        doubtful: list[int] = []
        while True:
            shares = self.best(fitted)
            J = self.rates(shares)
            known = fitted[_independent(J[:, fitted])]
            if known.size == fitted.size:
                scatter = (_errors(J, fitted, self.residuals(shares)) / shares)[fitted]
                if not (scatter > SCATTER).any():
                    return shares, J, fitted, doubtful
                worst = int(np.nanargmax(scatter))
                doubtful.append(int(fitted[worst]))
                known = np.delete(fitted, worst)
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

        low = np.where(self.lowest > 0.0, np.minimum(self.lowest / self.start, 1.0 - 1e-9), FAR[0])
        found = least_squares(
            lambda x: self.residuals(shares(x)),
            ones[fitted],
            jac=lambda x: self.rates(shares(x))[:, fitted],
            bounds=(low[fitted], np.full(fitted.size, FAR[1])),
            xtol=1e-10,
            ftol=1e-12,
        )
        return shares(found.x)

    def residuals(self, shares: np.ndarray) -> np.ndarray:
        """Differences of the columns over their peaks, flat."""
        self._follow(shares)
        if self.path is None:
            return np.full(self.curve.shares.size, LOST)
        return (self.curve.along(self.path, self.path.tips) - self.curve.shares).ravel()

    def rates(self, shares: np.ndarray) -> np.ndarray:
        """Derivatives of the residuals, shape (residuals, parameters)."""
        self._follow(shares)
        curve = self.curve
        if self.path is None:
            return np.zeros((curve.shares.size, len(self.names)))
        found = sensitivities(self.path, self.names).tips * self.start[:, None]
        return np.stack([curve.along(self.path, rates).ravel() for rates in found.swapaxes(0, 1)], axis=1)

    def _follow(self, shares: np.ndarray) -> None:
        if self._at is not None and np.array_equal(self._at, shares):
            return
        self._at, self.path, self.failure = shares.copy(), None, None
        self.evaluations += 1
        new = np.maximum(self.start * shares, self.lowest)
        try:
            self.path = solve(varied(self.curve.scene, self.names, new), **self.options)
        except (EquilibriumNotFound, InputError) as failure:
            self.failure = failure


def _independent(J: np.ndarray) -> list[int]:
    """Columns, from the first on, that add to the rank; J are residuals over peaks by shares."""
    kept: list[int] = []
    least = RESOLVED * max(float(np.linalg.norm(J, 2)), 1.0) if J.size else 0.0
    for i in range(J.shape[1]):
        if np.linalg.matrix_rank(J[:, [*kept, i]], tol=least) > len(kept):
            kept.append(i)
    return kept


def _undetermined(J: np.ndarray, fitted: np.ndarray, doubtful: list[int]) -> np.ndarray:
    """Whether each parameter has a part in the null space, or is `doubtful`, shape (parameters,).

    A parameter that was not fitted is undetermined together with those whose change makes up for its own.
    """
    lost = np.ones(J.shape[1], dtype=bool)
    lost[[*fitted, *doubtful]] = False
    instead = np.linalg.lstsq(J[:, fitted], J[:, lost], rcond=None)[0]
    lost[fitted] = (np.abs(instead) > TRADED).any(axis=1)
    lost[doubtful] = True
    return lost


def _errors(J: np.ndarray, fitted: np.ndarray, residuals: np.ndarray) -> np.ndarray:
    """Standard errors of the shares, nan where there is none."""
    errors = np.full(J.shape[1], np.nan)
    spare = residuals.size - fitted.size
    if spare > 0:
        scatter = np.sqrt(residuals @ residuals / spare)
        errors[fitted] = scatter * np.linalg.norm(np.linalg.pinv(J[:, fitted]), axis=1)
    return errors
