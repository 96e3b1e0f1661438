"""The equivalent beam's residuals from a load curve, and the parameters of their least squares."""

from __future__ import annotations

from collections.abc import Mapping
from contextlib import suppress
from dataclasses import replace
from typing import Any

import numpy as np

from coilspring.errors import EquilibriumNotFound, InputError
from coilspring.path import EquilibriumPath
from coilspring.scene import Scene
from coilspring.words import plain
from equivbeam import fiterrors
from equivbeam.fiterrors import independent
from equivbeam.loadcurve import LoadCurve
from equivbeam.sensitivity import AT_NU, sensitivities, values, varied
from equivbeam.solve import solve
from equivbeam.validity import ADVICE

SCATTER = 0.5  # standard error over the value, above which it is not told from 0 with 95 % confidence
ALIKE = 0.1  # of a parameter's relative change: one that changes by more with it can stand for it
FAR = (0.2, 5.0)  # share of its value at the start between which a parameter is searched
OFFSET = "offset"  # of the curve's deflection, mm: a parameter beside those of the scene
CLOSE = 1e-3  # to a bound of the search: the fit has stopped at it
CURVED = 1.0  # relative error of the derivatives over a step of one standard error, at most
ROUNDING = 1e-6  # of the residuals, over the peaks
LOST = 1.0  # error, over the peak, of rows that a trial does not reach


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
            self._solve(start)
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

    def warning(self, shares: np.ndarray, J: np.ndarray, spread: np.ndarray, fitted: np.ndarray) -> str:
        """Why standard errors would mislead, in one sentence; empty where they hold.

        One error off in a parameter, the residuals must have changed as their derivatives say.
        """
        if bound := self._at_bound(shares, fitted):
            return bound
        before = self.residuals(shares)
        for i in fitted if np.isfinite(spread).any() else ():
            for step in (spread[:, i], -spread[:, i]):
                if (self.scale * (shares + step) < self.lowest)[~self.lag].any():
                    continue  # out of its range, as an exponent below 1
                change = self.residuals(shares + step) - before - J @ step
                if self.path is None or np.linalg.norm(change) > CURVED * np.linalg.norm(J @ step) + ROUNDING:
                    return self._vague(i, spread[:, i] / shares)
        return ""

    def _at_bound(self, shares: np.ndarray, fitted: np.ndarray) -> str:
        """Which bound the search ended at, in one sentence; empty where at none."""
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
        with suppress(EquilibriumNotFound, InputError):
            self._solve(shares)

    def _solve(self, shares: np.ndarray) -> None:
        self._at, self.path = shares.copy(), None
        self.evaluations += 1
        self.path = solve(self.scene_of(shares, self.curve.scene), **self.options)
