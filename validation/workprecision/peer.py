"""OpenSees in the work-precision study, where it is installed: the wire model's straight mesh and penalty."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from coilspring import Scene
from validation.peers.installed import opensees
from validation.peers.layout import Curve
from validation.study.cases import PAPER_MESH, solve_wire
from validation.study.metrics import COMPONENTS, compare_curves
from validation.study.partialsolve import as_far
from validation.study.timing import Spread
from validation.workprecision.points import Point, Reference
from validation.workprecision.settings import PAIRS, PEER, Extent, Setting


def peer_points(
    scene: Scene, extent: Extent, reference: Reference, paper: float, progress: Callable[[str], None]
) -> tuple[Point, ...]:
    """All settings of OpenSees on one scene; none where it is not installed.

    Parameters
    ----------
    reference : what its load curves are compared with.
    paper : CPU seconds of the paper's FE mesh, by which its times are told.
    progress : called with one line on what is being done.
    """
    peer = opensees()
    if peer is None:
        return ()
    found = []
    for mesh, steps in extent.peers:
        setting = Setting(PEER, steps, mesh, PAIRS)
        progress(f"{scene.name}: {setting.label}")
        runs, ratios = [], []
        for _ in range(extent.peer_rounds):
            beside = as_far(solve_wire, scene, **PAPER_MESH).solve_seconds
            runs.append(peer.run(scene, steps, peer.tolerance(scene), elements_per_turn=mesh))
            ratios.append(runs[-1].seconds / beside)
        found.append(_point(setting, runs[-1], np.array(ratios), paper, reference))
    return tuple(found)


def _point(setting: Setting, run: Curve, ratios: np.ndarray, paper: float, reference: Reference) -> Point:
    return Point(
        setting=setting,
        outcome="completed" if len(run.tips) == setting.steps else "not_converged",
        error=compare_curves(run.times, dict(zip(COMPONENTS, run.tips.T, strict=True)), reference.path),
        ratio=Spread.of(ratios),
        seconds=Spread.of(ratios * paper),
        iterations=run.iterations,
    )
