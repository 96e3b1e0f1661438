"""Tables of the work-precision study for a reader, views of its result."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import pandas as pd

from equivbeam.laws import LAWS
from validation.study.cases import CASES
from validation.study.document import Table
from validation.study.frames import frame_table, view
from validation.study.timing import spread
from validation.workprecision.results import by_scene, fastest, of_paper, setting_of, usual_pairs
from validation.workprecision.settings import PAPER_LAW, STEPS, title

PAPER_COLUMN = "paper's reduction (%)"
PAPER_REDUCTION = {case.name: f"{case.paper_reduction:g}" for case in CASES}
Columns = dict[str, Callable[[Any], object]]


def tables(rows: pd.DataFrame) -> dict[str, Table]:
    """All tables by name."""
    return {
        "equal_error": equal_error_table(rows),
        "paper": paper_table(rows),
        "reference": reference_table(rows),
        "curve_front": front_table(rows, "curve"),
        "shape_front": front_table(rows, "shape"),
        "peers": peer_table(rows),
        "penalty": penalty_table(rows),
        "pairs": pairs_table(rows),
    }


def label(row: Any) -> str:
    """Name of a run's setting, without the usual number of steps."""
    return setting_of(row).label.removesuffix(f", {STEPS} steps")


def _error(row: Any) -> str:
    return f"{100.0 * row.curve_max:.2g}"


def _time(row: Any) -> str:
    return spread(row, "seconds", 1e3)


SCENE: Columns = {"scene": lambda row: title(row.scene)}
TIME: Columns = {"time (ms)": _time}
ERRORS: Columns = {"curve (%)": _error, "shape (mm)": lambda row: f"{row.shape_max_mm:.2g}"}


def equal_error_table(rows: pd.DataFrame) -> Table:
    """Each law of the half coil against the fastest run of the wire model that is as good."""
    lines = []
    for scene, part in by_scene(rows):
        for law in LAWS:
            beam = _beam(part, law)
            if beam is not None:
                wire = fastest(part[part["model"] == "wirefe"], beam.curve_max)
                lines.append({"scene": title(scene), "law": law} | _equal_error(scene, beam, wire))
    data = pd.DataFrame(lines)
    if PAPER_COLUMN in data and not set(rows["scene"]) & PAPER_REDUCTION.keys():
        del data[PAPER_COLUMN]
    return frame_table(data)


def _beam(rows: pd.DataFrame, law: str) -> Any:
    """A law's run: the paper's law as the paper has it, the helix law by the scene's sliding."""
    runs = rows[(rows["role"] == "run") & (rows["series"] == law) & (rows["steps"] == STEPS)]
    found = {each.sliding: each for each in runs[runs["tangent"] == "exact"].itertuples()}
    return found.get("ignore") if law == PAPER_LAW else found.get("scene", found.get("ignore"))


def _equal_error(scene: str, beam: Any, wire: Any) -> dict[str, str]:
    share = beam.ratio_to_paper_mesh / wire.ratio_to_paper_mesh if wire else np.nan
    return {
        "its error (%)": _error(beam),
        "its time (ms)": _time(beam),
        "wire model, as good at least": label(wire) if wire else "none",
        "error (%)": _error(wire) if wire else "",
        "time (ms)": _time(wire) if wire else "",
        "wire model / beam at equal error": f"{1.0 / share:.3g}" if wire else "",
        "reduction (%)": f"{100.0 * (1.0 - share):.1f}" if wire else "",
        "reduction against the paper's mesh (%)": f"{100.0 * (1.0 - beam.ratio_to_paper_mesh):.1f}",
        PAPER_COLUMN: PAPER_REDUCTION.get(scene, "not in the paper"),
    }


def paper_table(rows: pd.DataFrame) -> Table:
    """What is as accurate as the paper's FE mesh, and its time."""
    lines = []
    for scene, part in by_scene(rows):
        mesh, model = of_paper(part)
        best = fastest(part, mesh.curve_max)
        lines.append({
            "scene": title(scene),
            "paper's mesh (ms)": _time(mesh),
            "error (%)": _error(mesh),
            "paper's model (ms)": _time(model) if model else "left out",
            "its error (%)": _error(model) if model else "",
            "fastest as accurate as the paper's mesh": setting_of(best).label if best else "none",
            "its time (ms)": _time(best) if best else "",
            "part of the mesh's time": f"1/{1.0 / best.ratio_to_paper_mesh:.3g}" if best else "",
        })  # fmt: skip
    return frame_table(pd.DataFrame(lines))


def reference_table(rows: pd.DataFrame) -> Table:
    """How far the references are off themselves."""
    lines = []
    for scene, part in by_scene(rows):
        own = {each.role: each for each in part.itertuples()}
        mesh, steps, exact = own["half mesh"], own["half steps"], own.get("exact rod")
        lines.append({
            "scene": title(scene),
            "curve, half the mesh (of the peak)": f"{mesh.curve_max:.1e}",
            "curve, half the steps (of the peak)": f"{steps.curve_max:.1e}",
            "shape, half the mesh (mm)": f"{mesh.shape_max_mm:.1e}",
            "shape, half the steps (mm)": f"{steps.shape_max_mm:.1e}",
            "from the exact rod (of the peak)": f"{exact.curve_max:.1e}" if exact else "no exact solution",
        })  # fmt: skip
    return frame_table(pd.DataFrame(lines))


def front_table(rows: pd.DataFrame, kind: str) -> Table:
    """The runs on a front, by scene and time; `kind` is "curve" or "shape"."""
    chosen = [part.sort_values("seconds") for _, part in by_scene(rows[rows[f"on_{kind}_front"] == 1])]
    part: Columns = {"part of the paper's mesh": lambda row: f"{row.ratio_to_paper_mesh:.3g}"}
    setting: Columns = {"setting": lambda row: setting_of(row).label}
    return view(pd.concat(chosen), SCENE | setting | TIME | part | ERRORS)


def peer_table(rows: pd.DataFrame) -> Table:
    """OpenSees beside the wire model with the same mesh and steps."""
    runs = rows[(rows["role"] == "run") & (rows["model"] == "wirefe")]
    wires = {(each.scene, setting_of(each)): each for each in runs.itertuples()}

    def wire(row: Any) -> Any:
        return wires[row.scene, replace(setting_of(row), series="straight")]

    return view(
        rows[rows["role"] == "opensees"],
        {
            **SCENE,
            "elements per turn": lambda row: row.elements_per_turn,
            "steps": lambda row: row.steps,
            "outcome": lambda row: row.outcome.replace("_", " "),
            "OpenSees (ms)": _time,
            "wire model (ms)": lambda row: _time(wire(row)),
            "OpenSees / wire model": lambda row: (
                f"{row.ratio_to_paper_mesh / wire(row).ratio_to_paper_mesh:.3g}"
            ),
            "OpenSees, curve (%)": lambda row: f"{100.0 * row.curve_max:.4f}",
            "wire model, curve (%)": lambda row: f"{100.0 * wire(row).curve_max:.4f}",
        },
    )


def penalty_table(rows: pd.DataFrame) -> Table:
    """A row for each scene, model and penalty."""

    def outcome(row: Any) -> str:
        end = "" if row.outcome == "completed" else f" after t = {row.last_time:.2f}"
        return row.outcome.replace("_", " ") + end

    return view(
        rows[rows["role"] == "penalty"],
        {
            **SCENE,
            "setting": label,
            "penalty (N/mm)": lambda row: f"{row.penalty:.0e}".replace("+0", ""),
            "outcome": outcome,
            **TIME,
            "iterations": lambda row: f"{row.iterations:.0f}",
            "curve (%)": _error,
            "reference's own error (%)": lambda row: f"{100.0 * row.reference_curve_error:.1g}",
        },
    )


def pairs_table(rows: pd.DataFrame) -> Table:
    """What the number of sphere pairs changes, on the scenes whose answer changes with it."""
    wires = rows[(rows["role"] == "run") & (rows["model"] == "wirefe")]
    mesh, found = ["series", "elements_per_turn", "steps"], [wires.iloc[:0]]
    for _, part in by_scene(wires):
        other = pd.MultiIndex.from_frame(part.loc[~usual_pairs(part), mesh])
        alike = part[pd.MultiIndex.from_frame(part[mesh]).isin(other)]
        if len(alike) and np.ptp(alike["curve_max"]) > part["reference_curve_error"].iloc[0]:
            found.append(alike.sort_values("pairs_per_turn", kind="stable"))
    pairs: Columns = {"pairs per turn": lambda row: row.pairs_per_turn, "outcome": lambda row: row.outcome}
    return view(pd.concat(found), SCENE | pairs | TIME | ERRORS)
