"""A load curve to which the equivalent beam is fitted: of a path, a table or a CSV file."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from coilspring.errors import InputError, shown
from coilspring.path import EquilibriumPath

if TYPE_CHECKING:
    import pandas as pd

COLUMNS = ("ux", "uy", "rotz")


class LoadCurve(NamedTuple):
    """Displacements of the top at some of the equal steps of time."""

    columns: list[int]  # which of `COLUMNS` there are
    steps: int  # equal steps of time
    rows: np.ndarray  # (points,) of the steps, from 0, that the curve has
    peaks: np.ndarray  # (columns,) largest displacement of each column, mm or rad
    shares: np.ndarray  # (points, columns) displacements over their peaks

    def deviations(self, tips: np.ndarray) -> np.ndarray:
        """Differences of a path's tips, (steps, 3), from the curve, over the peaks, flat."""
        return (tips[self.rows][:, self.columns] / self.peaks - self.shares).ravel()


def read_curve(curve: EquilibriumPath | pd.DataFrame | str | Path) -> LoadCurve:
    """The curve of a path, a table or a CSV file.

    Raises
    ------
    InputError : what is no load curve, in one sentence.
    """
    table = _table(curve)
    names = [name for name in COLUMNS if name in table]
    steps, rows = _grid(table["time"])
    values = np.stack([table[name] for name in names], axis=1)
    peaks = np.abs(values).max(axis=0)
    return LoadCurve([COLUMNS.index(name) for name in names], steps, rows, peaks, values / peaks)


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
