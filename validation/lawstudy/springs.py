"""Errors of the law: on the paper's cases, among errors and times of both models, and on random springs.

The wire model's curves on random springs are stored once for all laws.
"""

from functools import partial
from typing import Any, NamedTuple

import numpy as np
import pandas as pd

from coilspring import Scene
from coilspring.curves import COMPONENTS, Curve, compare_paths
from equivbeam.laws.userlaw import UserLaw
from validation.study.cases import CASES, study_scenes
from validation.study.models import LAWS
from validation.study.partialsolve import partial_path
from validation.study.paths import PathStore, solve_beam, solve_wire
from validation.study.timing import interleaved, median_of
from validation.verification.ablation import CONVERGED
from validation.verification.randompage import CLASSES, classified
from validation.verification.randomscenes import KINDS, population
from validation.verification.randomsprings import HELIX_FIRST, closed, law_row, reference

LAW = "law"  # the user's, among the names of laws
BAD = 5.0  # per cent of the tip vector, from which on a law counts as broken
ROUNDS, REPEATS = 5, 3
MESHES = {
    f"{element} {count}": {"element": element, "elements_per_turn": count}
    for element, count in (("straight", 40), ("curved", 4), ("curved", 8))
}
Row = dict[str, Any]


class Extent(NamedTuple):
    """How many springs of each kind, from which seeds."""

    seeds: tuple[int, ...] = (0, 1)
    each: int = 40


def laws(law: UserLaw) -> dict[str, Any]:
    """The law and those beside it, by name."""
    return {name: name for name in LAWS} | {LAW: law}


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
    """Errors of the laws and of some meshes of the wire model in 50 steps, on the springs of that study; with
    the scenes' sliding."""
    rows = []
    for scene in study_scenes().values():
        wire = paths.partial_wire(scene, element="curved", elements_per_turn=64, steps=200)
        beams = laws(law).items()
        found = {name: paths.partial_beam(scene, law=each, sliding="scene") for name, each in beams}
        found |= {name: paths.partial_wire(scene, **mesh) for name, mesh in MESHES.items()}
        for name, path in found.items():
            error = 100.0 * compare_paths(path, wire).curve_max
            rows.append({"scene": scene.name, "series": name, "error": error, "outcome": path.outcome})
    return rows


def times(law: UserLaw) -> list[Row]:
    """CPU milliseconds of the same, by turns; kernels warm, the solve alone. Ratios are of runs side by side,
    times are theirs of the median of haringx."""
    rows = []
    for scene in study_scenes().values():
        runs = {
            name: partial(median_of, REPEATS, partial(_seconds, solve_beam, scene, law=each, sliding="scene"))
            for name, each in laws(law).items()
        }
        runs |= {name: partial(_seconds, solve_wire, scene, **mesh) for name, mesh in MESHES.items()}
        seconds = interleaved(runs, range(ROUNDS))
        for name, found in seconds.items():
            ratio = float(np.median(found / seconds["haringx"]))
            ms = 1e3 * ratio * float(np.median(seconds["haringx"]))
            rows.append({"scene": scene.name, "series": name, "ms": ms, "ratio": ratio})
    return rows


def _seconds(solve: Any, scene: Scene, **options: Any) -> float:
    return partial_path(solve, scene, **options).solve_seconds


def wire_curves(seed: int, kind: str, each: int) -> list[Row]:
    """What the springs of a kind are, the wire model's curves, and both built-in laws' errors."""
    found = []
    for drawn in population(seed, each, (kind,)):
        scene, wire = drawn.scene, reference(drawn.scene)
        row: Row = {"seed": seed, "kind": kind, "number": drawn.number, "shape": drawn.shape}
        row |= {"contact": scene.contact.enabled, "closed": closed(wire)}
        curve = Curve.of(wire)
        row |= {"wire": wire.outcome, "times": curve.times.tolist(), "answers": curve.answers.tolist()}
        for law in HELIX_FIRST:
            row |= law_row(law, law, scene, curve)
        found.append(row)
    return found


def law_errors(law: UserLaw, rows: list[Row], each: int) -> list[Row]:
    """The rows of `wire_curves`, without the curves, with the errors of a law."""
    found = []
    springs = population(rows[0]["seed"], each, (rows[0]["kind"],)) if rows else ()
    for row, drawn in zip(rows, springs, strict=True):
        wire = Curve(np.array(row["times"]), np.reshape(row["answers"], (-1, len(COMPONENTS))))
        plain = {name: value for name, value in row.items() if name not in ("times", "answers")}
        found.append(plain | law_row(LAW, law, drawn.scene, wire))
    return found


def frame(rows: list[Row]) -> pd.DataFrame:
    """The rows with their class of contact."""
    data = pd.DataFrame(rows)
    names = [f"{law}_{name}" for law in (*LAWS, LAW) for name in ("vector", *COMPONENTS)]
    return classified(data.astype(dict.fromkeys(names, float)))


def breakdown(data: pd.DataFrame, law: str = LAW) -> pd.DataFrame:
    """For each kind and class: springs, and those on which a law is broken, by what.

    Broken: the error of the tip vector is above `BAD`, or the law's path ends before the wire model's does.
    """
    ends = (data[law] != "completed") & (data["wire"] == "completed")
    off = data[f"{law}_vector"] > BAD
    known = data.assign(ends=ends, off=off, broken=ends | off)
    table = known.groupby(["kind", "closing"])[["ends", "off", "broken"]].sum()
    table["springs"] = known.groupby(["kind", "closing"]).size()
    order = pd.MultiIndex.from_product(([kind.name for kind in KINDS], CLASSES))
    return table.reindex(order).dropna().rename_axis(["kind", "contact"]).reset_index()
