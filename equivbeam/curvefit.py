"""Least squares of the equivalent beam's parameters against a load curve."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from coilspring.errors import EquilibriumNotFound, InputError
from coilspring.path import EquilibriumPath
from equivbeam.loadcurve import LoadCurve
from equivbeam.parameters import varied
from equivbeam.sensitivity import sensitivities
from equivbeam.solve import solve

FAR = (0.2, 5.0)  # share of its value at the start between which a parameter is searched
LOST = 1.0  # error, over the peak, of rows that a trial does not reach


class CurveFit:
    """Residuals, their derivatives by the parameters' shares of their values at the start, and the least.

    Attributes
    ----------
    path : of the shares that were asked for last, or None where it does not reach the curve's end.
    evaluations : paths followed.
    """

    def __init__(
        self,
        names: tuple[str, ...],
        start: np.ndarray,
        curve: LoadCurve,
        options: Mapping[str, Any],
    ) -> None:
        self.scene, self.names, self.start = curve.scene, names, start
        self.curve, self.options = curve, options
        self.lowest = np.array([1.0 if name == "exponent" else 0.0 for name in names])  # of the values
        self.path: EquilibriumPath | None = None
        self.evaluations = 0
        self._at: np.ndarray | None = None

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
        return self.curve.deviations(self.path)

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
        self._at, self.path = shares.copy(), None
        self.evaluations += 1
        new = np.maximum(self.start * shares, self.lowest)
        try:
            self.path = solve(varied(self.scene, self.names, new), **self.options)
        except (EquilibriumNotFound, InputError):
            return
