"""The result of the work-precision study: one DataFrame, a row for each setting on each scene.

Rows differ in ``role``: "run", and what stands beside the runs: "opensees"; "penalty", against the same model
with hard contact; "half mesh" and "half steps" of the reference, and "exact rod", its error against the exact
solution where there is one; "left out", what a scene cannot be given, with the ``reason``. Errors are those
of the part of the path that was reached.
"""

from collections.abc import Sequence
from dataclasses import asdict, fields
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from coilspring import Scene
from coilspring.curves import Comparison
from validation.study import frames
from validation.workprecision.settings import PAPER_MODEL, STEPS, Setting
from wirefe.contact.points import PER_TURN

TIE = 1.1  # times nearer to each other than about this factor are one
GAIN = 0.9  # a slower setting is on the front where its error is below this part of the faster ones'
FILE = "workprecision.csv"
LEFT_OUT, UNSUPPORTED = "left out", "unsupported"
WORDS, COUNTS = ["tangent", "sliding", "geometry"], ["elements_per_turn", "pairs_per_turn"]
ERRORS = {"curve_max": "", "curve_rms": "", "shape_max": "_mm", "shape_rms": "_mm"}  # and their units


def row(
    role: str, scene: Scene, setting: Setting, error: Comparison | None, **more: object
) -> dict[str, object]:
    """A row; `more` holds its times (`validation.study.timing.quartiles`), iterations and outcome."""
    return {
        "role": role,
        "scene": scene.name,
        "model": setting.model,
        **asdict(setting),
        "penalty": scene.contact.stiffness if scene.contact.enabled else np.nan,
        "outcome": "completed",
        "last_time": getattr(error, "last_time", np.nan),
        **{name + unit: getattr(error, name, np.nan) for name, unit in ERRORS.items()},
        **more,
    }


def left_out(scene: Scene, setting: Setting, reason: str, outcome: str = UNSUPPORTED) -> dict[str, object]:
    """A row for what a scene cannot be given, or for a scene whose reference ends early."""
    return row(LEFT_OUT, scene, setting, None, outcome=outcome, reason=reason)


def ranked(rows: pd.DataFrame) -> pd.DataFrame:
    """The rows of a scene with the reference's own error, and which of them are on a front."""
    curve, shape = rows.loc[
        rows["role"].isin(("half mesh", "half steps")), ["curve_max", "shape_max_mm"]
    ].sum()
    able = rows[(rows["role"] == "run") & competes(rows)]
    whole = able[able["steps"] >= STEPS]  # which give all of the load curve
    return rows.assign(
        reference_curve_error=curve,
        reference_shape_error_mm=shape,
        on_curve_front=rows.index.isin(front(whole, whole["curve_max"].clip(lower=curve))).astype(int),
        on_shape_front=rows.index.isin(front(able, able["shape_max_mm"].clip(lower=shape))).astype(int),
    )


def competes(rows: pd.DataFrame) -> pd.Series:
    """Whether rows solve the scene to the end with the scene's contact model."""
    return (rows["outcome"] == "completed") & usual_pairs(rows)


def usual_pairs(rows: pd.DataFrame) -> pd.Series:
    """Whether rows have the usual number of pairs of their scene's contact, or none."""
    return rows["pairs_per_turn"] == rows["geometry"].map(PER_TURN).fillna(0)


def front(rows: pd.DataFrame, error: pd.Series) -> list[int]:
    """Index of the Pareto front: no row that is faster, or as fast, has an error as small within `GAIN`."""
    times = (np.log(rows["ratio_to_paper_mesh"]) / np.log(TIE)).round()
    ordered = pd.DataFrame({"time": times, "error": error}).sort_values(["time", "error"], kind="stable")
    found: list[int] = []
    for place in ordered.index:
        if not found or error[place] < GAIN * error[found[-1]]:
            found.append(place)
    return found


def has_half_mesh(rows: pd.DataFrame) -> bool:
    """Whether a run has the mesh by which the reference's own error is measured."""
    mesh = ["scene", "series", "elements_per_turn"]
    halved, runs = (rows.loc[rows["role"] == role, mesh] for role in ("half mesh", "run"))
    return not halved.merge(runs).empty


def setting_of(row: Any) -> Setting:
    """The setting of a row."""
    return Setting(**{each.name: getattr(row, each.name) for each in fields(Setting)})


def of_paper(rows: pd.DataFrame) -> tuple[Any, Any]:
    """The rows of a scene that are the paper's FE mesh and the paper's equivalent beam, or None."""
    runs = {setting_of(each): each for each in rows[rows["role"] == "run"].itertuples()}
    return next((runs[each] for each in runs if each.is_paper_mesh), None), runs.get(PAPER_MODEL)


def fastest(rows: pd.DataFrame, error: float) -> Any:
    """The fastest run of the whole load curve with at most this error or the reference's own; or None."""
    most = max(error, rows["reference_curve_error"].iloc[0])
    runs = rows[(rows["role"] == "run") & competes(rows)]
    able = runs[(runs["steps"] >= STEPS) & (runs["curve_max"] <= most)]
    return next(able.sort_values("ratio_to_paper_mesh", kind="stable").itertuples(), None)


def to_csv(rows: pd.DataFrame) -> bytes:
    """The CSV file, where what a model does not have is an empty cell."""
    counts = {name: rows[name].replace(0, pd.NA).astype("Int64") for name in COUNTS}
    return frames.to_csv(rows.assign(**counts))


def read(folder: Path) -> pd.DataFrame:
    """What `to_csv` wrote; where no geometry is recorded, all contact is of spheres."""
    rows = frames.read_csv(folder / FILE)
    if "geometry" not in rows:
        rows["geometry"] = np.where(rows["elements_per_turn"].notna(), "spheres", "")
    whole = {name: rows[name].fillna(0).astype(int) for name in COUNTS}
    return rows.assign(**whole, **{name: rows[name].fillna("") for name in WORDS})


def by_scene(rows: pd.DataFrame) -> Sequence[tuple[str, pd.DataFrame]]:
    """The rows of each scene that was solved, in their order."""
    solved = rows[rows["role"] != LEFT_OUT]
    return [(str(name), part) for name, part in solved.groupby("scene", sort=False)]


def reasons(rows: pd.DataFrame) -> list[str]:
    """A sentence on each thing that was left out."""
    return [f"{row.scene}, {row.reason}" for row in rows[rows["role"] == LEFT_OUT].itertuples()]


def ended_early(rows: pd.DataFrame) -> str:
    """What was left out since its reference ends early, in one sentence; empty where nothing was."""
    return "; ".join(reasons(rows[rows["outcome"] != UNSUPPORTED]))
