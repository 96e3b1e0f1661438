"""Errors of the law on the paper's cases, and its place among errors and times of both models."""

from __future__ import annotations

from functools import partial
from typing import Any

import numpy as np

from coilspring import Scene
from equivbeam.laws.userlaw import UserLaw
from validation.lawstudy.springs import LAW
from validation.study.cases import CASES, PathStore, solve_beam, solve_wire
from validation.study.metrics import compare_paths
from validation.study.partialsolve import partial_path
from validation.study.scenes import study_scenes
from validation.study.timing import interleaved, median_of
from validation.verification.ablation import CONVERGED

ROUNDS, REPEATS = 5, 3
BUILT_IN = ("haringx", "helix")
MESHES = {
    f"{element} {count}": {"element": element, "elements_per_turn": count}
    for element, count in (("straight", 40), ("curved", 4), ("curved", 8))
}
Row = dict[str, Any]


def laws(law: UserLaw) -> dict[str, Any]:
    """The law and those beside it."""
    return {name: name for name in BUILT_IN} | {LAW: law}


def budget(law: UserLaw, paths: PathStore) -> list[Row]:
    """Errors of the three laws on the paper's cases, with the scene's sliding, per cent of the peak."""
    rows = []
    for case in CASES:
        wire = paths.partial_wire(case.scene, **CONVERGED)
        row: Row = {"case": case.title}
        for name, each in laws(law).items():
            path = paths.partial_beam(case.scene, law=each, sliding="scene")
            found = compare_paths(path, wire)
            row |= {f"{name}_error": 100.0 * found.curve_max, f"{name}_outcome": path.outcome}
            row |= {f"{name}_{key}": 100.0 * value for key, value in found.component_max.items()}
        rows.append(row)
    return rows


def errors(law: UserLaw, paths: PathStore) -> list[Row]:
    """Errors of the laws and of some meshes of the wire model in 50 steps, on the springs of that study."""
    rows = []
    for scene in study_scenes().values():
        wire = paths.partial_wire(scene, element="curved", elements_per_turn=64, steps=200)
        found = {name: paths.partial_beam(scene, law=each) for name, each in laws(law).items()}
        found |= {name: paths.partial_wire(scene, **mesh) for name, mesh in MESHES.items()}
        for name, path in found.items():
            error = 100.0 * compare_paths(path, wire).curve_max
            rows.append({"scene": scene.name, "series": name, "error": error, "outcome": path.outcome})
    return rows


def times(law: UserLaw) -> list[Row]:
    """CPU milliseconds of the same, by turns; kernels warm, the solve alone."""
    rows = []
    for scene in study_scenes().values():
        runs = {
            name: partial(median_of, REPEATS, partial(_seconds, solve_beam, scene, law=each))
            for name, each in laws(law).items()
        }
        runs |= {name: partial(_seconds, solve_wire, scene, **mesh) for name, mesh in MESHES.items()}
        seconds = interleaved(runs, range(ROUNDS))
        for name, found in seconds.items():
            ms, ratio = 1e3 * float(np.median(found)), float(np.median(found / seconds["haringx"]))
            rows.append({"scene": scene.name, "series": name, "ms": ms, "ratio": ratio})
    return rows


def _seconds(solve: Any, scene: Scene, **options: Any) -> float:
    return partial_path(solve, scene, **options).solve_seconds
