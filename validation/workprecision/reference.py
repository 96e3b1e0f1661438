"""What the work-precision study measures errors from: the finest wire, and how far it is off itself."""

from __future__ import annotations

import numpy as np

from coilspring import EquilibriumPath, Scene
from validation.study.cases import solve_wire
from validation.study.exactrod import EXACT_ROD
from validation.study.metrics import COMPONENTS, compare_paths
from validation.workprecision.points import Reference
from validation.workprecision.settings import PAIRS, Extent, Setting


def reference(scene: Scene, extent: Extent) -> Reference:
    """The finest path with its own error."""
    finest = Setting("curved", extent.finest, extent.reference, PAIRS)
    path = solve_wire(scene, **finest.options)
    coarser = solve_wire(scene, **(finest.options | {"elements_per_turn": extent.reference // 2}))
    fewer = solve_wire(scene, **(finest.options | {"steps": extent.finest // 2}))
    return Reference(path, compare_paths(coarser, path), compare_paths(fewer, path), _from_exact(path))


def _from_exact(path: EquilibriumPath) -> float | None:
    """Largest distance from the exact rod over the peak of the component; None where there is none."""
    exact = EXACT_ROD.get(path.scene.name)
    if exact is None:
        return None
    rows = [int(np.flatnonzero(np.isclose(path.times, time))[0]) for time in exact]
    tips = np.array(list(exact.values()))
    peaks = np.abs(tips).max(axis=0)
    apart = np.abs(path.tips[rows] - tips).max(axis=0)
    return max(float(apart[i] / peaks[i]) for i in range(len(COMPONENTS)) if peaks[i] > 0.0)
