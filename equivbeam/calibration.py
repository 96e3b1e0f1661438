"""Fit the equivalent beam to a load curve, of the wire model or measured."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from coilspring.errors import EquilibriumNotFound, InputError, shown
from coilspring.path import EquilibriumPath
from coilspring.scene import Scene, require_scene
from equivbeam.parameters import values, varied
from equivbeam.sensitivity import sensitivities
from equivbeam.solve import solve

if TYPE_CHECKING:
    import pandas as pd

COLUMNS = ("ux", "uy", "rotz")
FAR = (0.2, 5.0)  # share of its value at the start between which a parameter is looked for
LOST = 1.0  # error, over the peak, of rows that a trial does not reach
# Singular values of the derivatives, of residuals over peaks by relative changes, over the largest one or 1:
# differences leave up to 6e-10 of what is zero; the weakest direction that was met in the paper's springs
# and in guided ones is 2e-7 (an exponent beside a penalty).
RESOLVED = 1e-8
TRADED = 1e-3  # relative change of a parameter, for another's by its whole value, that counts


@dataclass(frozen=True)
class Calibration:
    """What a fit found, and what the curve does not determine.

    Attributes
    ----------
    scene : with the fitted parameters.
    names, values : of the parameters.
    errors : their standard errors, from the residuals and the curve's derivatives, if the model is right;
        nan for undetermined parameters, and for all where the curve has no more numbers than `rank`.
    rank : of the curve's derivatives by the parameters: so many were fitted.
    undetermined : names of parameters that can change, some together, without moving the curve.
    fixed : those of them that stay at their start; the values of the others hold for these.
    path : of the fitted scene.
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
        Column ``time`` (share of the scene's load, in equal steps of which some may be missing) and
        one or more of ``ux``, ``uy`` (mm), ``rotz`` (rad), as in ``path.csv``.
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
    names = tuple(parameters)
    if isinstance(parameters, str) or not names or len(set(names)) < len(names):
        raise InputError(f"parameters must be a list of different names, got {shown(parameters)}")
    start = values(require_scene(scene), options, names)
    fit = _Fit(scene, names, start, _table(curve), options)
    shares = np.ones(len(names))
    before = fit.residuals(shares)
    if fit.path is None:
        solve(fit.scene, **options)  # raises what was found
    fitted = np.arange(len(names))
    while True:
        shares = fit.best(fitted)
        J = fit.rates(shares)
        known = fitted[_independent(J[:, fitted])]
        if known.size == fitted.size:
            break
        fitted = known  # once more, with what the curve does not determine at its start
    after = fit.residuals(shares)
    assert fit.path is not None  # the best point is one that was reached
    undetermined = _undetermined(J, fitted)
    return Calibration(
        scene=fit.path.scene,
        names=names,
        values=start * shares,
        errors=start * _errors(J, fitted, undetermined, after),
        rank=fitted.size,
        undetermined=tuple(name for name, lost in zip(names, undetermined, strict=True) if lost),
        fixed=tuple(name for i, name in enumerate(names) if i not in fitted),
        path=fit.path,
        rms_before=float(np.sqrt(np.mean(before**2))),
        rms_after=float(np.sqrt(np.mean(after**2))),
        evaluations=fit.evaluations,
    )


def _independent(J: np.ndarray) -> list[int]:
    """Columns, from the first on, that add to the rank; J are residuals over peaks by shares."""
    kept: list[int] = []
    least = RESOLVED * max(float(np.linalg.norm(J, 2)), 1.0) if J.size else 0.0
    for i in range(J.shape[1]):
        if np.linalg.matrix_rank(J[:, [*kept, i]], tol=least) > len(kept):
            kept.append(i)
    return kept


def _undetermined(J: np.ndarray, fitted: np.ndarray) -> np.ndarray:
    """Whether each parameter has a part in the null space, shape (parameters,).

    A parameter that was not fitted is undetermined together with those whose change makes up for its own.
    """
    lost = np.ones(J.shape[1], dtype=bool)
    lost[fitted] = False
    instead = np.linalg.lstsq(J[:, fitted], J[:, lost], rcond=None)[0]
    lost[fitted] = (np.abs(instead) > TRADED).any(axis=1)
    return lost


def _errors(J: np.ndarray, fitted: np.ndarray, undetermined: np.ndarray, residuals: np.ndarray) -> np.ndarray:
    """Standard errors of the shares, nan where there is none."""
    errors = np.full(J.shape[1], np.nan)
    spare = residuals.size - fitted.size
    if spare > 0:
        scatter = np.sqrt(residuals @ residuals / spare)
        errors[fitted] = scatter * np.linalg.norm(np.linalg.pinv(J[:, fitted]), axis=1)
    errors[undetermined] = np.nan
    return errors


class _Fit:
    """Residuals, their derivatives by the parameters' shares of their values at the start, and the least."""

    def __init__(
        self,
        scene: Scene,
        names: tuple[str, ...],
        start: np.ndarray,
        table: Mapping[str, np.ndarray],
        options: Mapping[str, Any],
    ) -> None:
        self.columns = [name for name in COLUMNS if name in table]
        self.steps, self.rows = _grid(table["time"])
        self.scene, self.names, self.start, self.options = scene.with_steps(self.steps), names, start, options
        measured = np.stack([table[name] for name in self.columns], axis=1)
        self.peaks = np.abs(measured).max(axis=0)
        self.measured = measured / self.peaks
        self.path: EquilibriumPath | None = None
        self.at: np.ndarray | None = None
        self.evaluations = 0

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

        low, high = self.bounds()
        found = least_squares(
            lambda x: self.residuals(shares(x)),
            ones[fitted],
            jac=lambda x: self.rates(shares(x))[:, fitted],
            bounds=(low[fitted], high[fitted]),
            xtol=1e-10,
            ftol=1e-12,
        )
        return shares(found.x)

    def bounds(self) -> tuple[np.ndarray, np.ndarray]:
        """Bounds of the shares; an exponent is not below 1."""
        low = np.full(len(self.names), FAR[0])
        for i, name in enumerate(self.names):
            if name == "exponent":
                low[i] = min(1.0 / self.start[i], 1.0 - 1e-9)
        return low, np.full(len(self.names), FAR[1])

    def _follow(self, shares: np.ndarray) -> None:
        if self.at is not None and np.array_equal(self.at, shares):
            return
        self.at, self.path = shares.copy(), None
        self.evaluations += 1
        scene, options = varied(self.scene, self.options, self.names, self._values(shares))
        try:
            self.path = solve(scene, **options)
        except (EquilibriumNotFound, InputError):
            return

    def _values(self, shares: np.ndarray) -> np.ndarray:
        new = self.start * shares
        for i, name in enumerate(self.names):
            if name == "exponent":
                new[i] = max(new[i], 1.0)
        return new

    def residuals(self, shares: np.ndarray) -> np.ndarray:
        """Differences of the columns over their peaks, flat."""
        self._follow(shares)
        if self.path is None:
            return np.full(self.measured.size, LOST)
        tips = self.path.tips[self.rows][:, [COLUMNS.index(name) for name in self.columns]]
        return (tips / self.peaks - self.measured).ravel()

    def rates(self, shares: np.ndarray) -> np.ndarray:
        """Derivatives of the residuals, shape (residuals, parameters)."""
        self._follow(shares)
        if self.path is None:
            return np.zeros((self.measured.size, len(self.names)))
        found = sensitivities(self.path, self.names).tips[self.rows] * self.start[:, None]
        columns = [COLUMNS.index(name) for name in self.columns]
        return (found[:, :, columns] / self.peaks).transpose(0, 2, 1).reshape(-1, len(self.names))


def _grid(time: np.ndarray) -> tuple[int, np.ndarray]:
    """Number of equal steps whose times include those given, and their rows."""
    for steps in (round(1.0 / np.diff(np.concatenate(([0.0], time))).min()), 1000, 10_000):
        rows = np.rint(time * steps).astype(int) - 1
        if np.allclose((rows + 1) / steps, time, atol=1e-9) and (rows >= 0).all():
            return steps, rows
    raise InputError("curve must have times that are equal steps of 0..1, some of which may be missing")


def _table(curve: EquilibriumPath | pd.DataFrame | str | Path) -> dict[str, np.ndarray]:
    """Columns of the curve, checked."""
    import pandas as pd

    if isinstance(curve, EquilibriumPath):
        curve = curve.table
    elif not isinstance(curve, pd.DataFrame):
        try:
            curve = pd.read_csv(curve)
        except (OSError, ValueError) as error:
            raise InputError(
                f"curve must be a readable CSV file, got {shown(str(curve))} ({error})"
            ) from None
    names = [name for name in ("time", *COLUMNS) if name in curve]
    if names[:1] != ["time"] or len(names) < 2 or not len(curve):
        raise InputError(
            f"curve must have a column time and one or more of {', '.join(COLUMNS)}, "
            f"got {', '.join(map(str, curve))}"
        )
    table = {name: curve[name].to_numpy(dtype=float) for name in names}
    columns = np.array(list(table.values()))
    time = table["time"]
    if not np.isfinite(columns).all() or (np.diff(time) <= 0.0).any() or time[0] <= 0.0 or time[-1] > 1.0:
        raise InputError("curve must hold finite numbers, with times that rise from above 0 to 1 at most")
    moving = {name: values for name, values in table.items() if name == "time" or np.abs(values).max() > 0.0}
    if len(moving) < 2:
        raise InputError("curve must have a column that is not zero throughout")
    return moving
