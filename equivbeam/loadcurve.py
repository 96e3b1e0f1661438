"""A load curve to which the equivalent beam is fitted: of a path, a table or a CSV file."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from coilspring.benchfile import Source, read_table
from coilspring.curves import COMPONENTS
from coilspring.errors import InputError
from coilspring.measured import equal_steps, measured
from coilspring.path import EquilibriumPath
from coilspring.scene import Load, Scene
from coilspring.scene.load import given_loads
from coilspring.scene.sizing import sizes

FINE = 200  # steps between which a path is interpolated where a curve has no equal steps
SAME_LOAD = 3e-3  # of the largest load, by which those of a path, rounded, may differ from the scene's
BEYOND = 10.0  # times the force that closes the last coil: no test bench goes there


class LoadCurve(NamedTuple):
    """Displacements of the top, or what is along a direction of them, at times of a load."""

    scene: Scene  # whose load they are of, with the steps that a path needs
    directions: np.ndarray  # (columns, 3) in UX, UY and ROTZ
    times: np.ndarray  # (points,) in any order
    peaks: np.ndarray  # (columns,) largest displacement of each column, mm or rad
    shares: np.ndarray  # (points, columns) displacements over their peaks
    of_force: bool  # whether the load is that of the curve, not the scene's

    def along(self, path: EquilibriumPath, tips: np.ndarray) -> np.ndarray:
        """UX, UY and ROTZ at a path's steps, (steps, 3), as the curve's shares, (points, columns)."""
        times = np.append(0.0, path.times)
        values = tips @ self.directions.T / self.peaks
        return np.stack([np.interp(self.times, times, np.append(0.0, column)) for column in values.T], axis=1)

    def beyond(self, path: EquilibriumPath) -> str:
        """That the curve goes on where a path ends, in words, and how much of it can be kept."""
        found = sizes(self.scene)
        largest, closing = found.force, found.closing[1]
        said = "the scene as given does not reach the end of the curve"
        if largest > BEYOND * closing > 0.0:
            said += (
                f" of {largest:.4g} N, where the last coil closes at {closing:.4g} N (are the units right?)"
            )
            return f"{said}: {path.message}"
        force = self._reached(path) if self.of_force else 0.0
        kept = f"; leave out what is beyond {force:.4g} N" if force else ""
        return f"{said}: {path.message}{kept}"

    def _reached(self, path: EquilibriumPath) -> float:
        """Force of the curve up to which a path goes, N, rounded down to 4 digits; 0 if nowhere."""
        share = path.times[-1:].sum() if path.end_bracket is None else path.end_bracket[0]
        force = share * np.hypot(*self.scene.load.force)
        unit = 10.0 ** (np.floor(np.log10(force)) - 3.0) if force > 0.0 else 1.0
        return float(np.floor(force / unit) * unit)


def read_curve(curve: EquilibriumPath | Source, scene: Scene, from_rest: bool = True) -> LoadCurve:
    """The curve of a path, a table or a CSV file, of a spring loaded as in a scene; see `measured`."""
    # rates and stresses of a path are not asked for
    table = read_table(curve.curve if isinstance(curve, EquilibriumPath) else curve)
    by_force = of_force(table.columns, scene)
    if by_force:
        found = measured(table, scene, from_rest)
        peak, (x, y) = float(found.force.max()), scene.direction
        loaded = replace(scene, load=Load((x * peak, y * peak)))
        times, columns, directions = found.force / peak, [found.deflection], np.array([[x, y, 0.0]])
    else:
        names = _moving(table.columns)
        loaded, times, columns = scene, table.columns["time"], [table.columns[name] for name in names]
        directions = np.eye(3)[[COMPONENTS.index(name) for name in names]]
    values = np.stack(columns, axis=1)
    peaks = np.abs(values).max(axis=0)
    return LoadCurve(
        loaded.with_steps(equal_steps(times, FINE)), directions, times, peaks, values / peaks, by_force
    )


def of_force(columns: Mapping[str, np.ndarray], scene: Scene) -> bool:
    """Whether a curve is of force and deflection, as a path under another load than the scene's is, too; else
    it is of displacements at times of the scene's load."""
    if "force" in columns or scene.load.displacement:
        return True
    given = [(i, name) for i, name in enumerate(("load_x", "load_y")) if name in columns]
    if not given or "time" not in columns:
        return False
    loads = given_loads(scene.load, columns["time"])
    off = [np.abs(loads[:, i] - columns[name]).max(initial=0.0) for i, name in given]
    return bool(max(off) > SAME_LOAD * np.abs(loads).max(initial=0.0))


def _moving(columns: dict[str, np.ndarray]) -> list[str]:
    """Columns of displacements that are not zero throughout, at times that can be."""
    names = [name for name in COMPONENTS if name in columns]
    if "time" not in columns or not names:
        raise InputError(
            "curve must have columns force and deflection, or time and one or more of "
            f"{', '.join(COMPONENTS)}, got {', '.join(columns) or 'none of them'}"
        )
    time = columns["time"]
    if not time.size or time.min() <= 0.0 or time.max() > 1.0:
        raise InputError("curve must have times above 0 and up to 1")
    moving = [name for name in names if np.abs(columns[name]).max() > 0.0]
    if not moving:
        raise InputError("curve must have a column that is not zero throughout")
    return moving
