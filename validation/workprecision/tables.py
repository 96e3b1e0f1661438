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
from validation.study.frames import view
from validation.study.timing import spread
from validation.workprecision.results import by_scene, fastest, of_paper, setting_of
from validation.workprecision.settings import PAIRS, PAPER_LAW, STEPS, TITLES

PAPER_REDUCTION = {case.name: f"{case.paper_reduction:g}" for case in CASES}
Rows = list[dict[str, str]]


def equal_error_table(rows: pd.DataFrame) -> Table:
    """Each law of the half coil against the fastest run of the wire model that is as good."""
    lines: Rows = []
    for scene, part in by_scene(rows):
        wires = part[part["model"] == "wirefe"]
        for law in LAWS:
            beam = _beam(part, law)
            if beam is not None:
                lines.append(_equal_error(scene, law, beam, fastest(wires, beam.curve_max)))
    return _table(lines)


def _beam(rows: pd.DataFrame, law: str) -> Any:
    """A law's run: the paper's law as the paper has it, the helix law by the scene's sliding."""
    runs = rows[(rows["role"] == "run") & (rows["series"] == law) & (rows["steps"] == STEPS)]
    found = {each.sliding: each for each in runs[runs["tangent"] == "exact"].itertuples()}
    return found.get("ignore") if law == PAPER_LAW else found.get("scene", found.get("ignore"))


def _equal_error(scene: str, law: str, beam: Any, wire: Any) -> dict[str, str]:
    share = np.nan if wire is None else beam.ratio_to_paper_mesh / wire.ratio_to_paper_mesh
    return {
        "scene": TITLES[scene],
        "law": law,
        "its error (%)": _percent(beam),
        "its time (ms)": _time(beam),
        "wire model, as good at least": "none" if wire is None else _label(wire),
        "error (%)": "" if wire is None else _percent(wire),
        "time (ms)": "" if wire is None else _time(wire),
        "wire model / beam at equal error": "" if wire is None else f"{1.0 / share:.3g}",
        "reduction (%)": "" if wire is None else f"{100.0 * (1.0 - share):.1f}",
        "reduction against the paper's mesh (%)": f"{100.0 * (1.0 - beam.ratio_to_paper_mesh):.1f}",
        "paper's reduction (%)": PAPER_REDUCTION.get(scene, "not in the paper"),
    }


def paper_table(rows: pd.DataFrame) -> Table:
    """What is as accurate as the paper's FE mesh, and its time."""
    lines: Rows = []
    for scene, part in by_scene(rows):
        mesh, model = of_paper(part)
        best = fastest(part, mesh.curve_max)
        lines.append(
            {
                "scene": TITLES[scene],
                "paper's mesh (ms)": _time(mesh),
                "error (%)": _percent(mesh),
                "paper's model (ms)": _time(model),
                "its error (%)": _percent(model),
                "fastest as accurate as the paper's mesh": setting_of(best).label,
                "its time (ms)": _time(best),
                "part of the mesh's time": f"1/{1.0 / best.ratio_to_paper_mesh:.3g}",
            }
        )
    return _table(lines)


def reference_table(rows: pd.DataFrame) -> Table:
    """How far the references are off themselves."""
    lines: Rows = []
    for scene, part in by_scene(rows):
        own = {each.role: each for each in part.itertuples()}
        mesh, steps, exact = own["half mesh"], own["half steps"], own.get("exact rod")
        lines.append(
            {
                "scene": TITLES[scene],
                "curve, half the mesh (of the peak)": f"{mesh.curve_max:.1e}",
                "curve, half the steps (of the peak)": f"{steps.curve_max:.1e}",
                "shape, half the mesh (mm)": f"{mesh.shape_max_mm:.1e}",
                "shape, half the steps (mm)": f"{steps.shape_max_mm:.1e}",
                "from the exact rod (of the peak)": f"{exact.curve_max:.1e}"
                if exact
                else "no exact solution",
            }
        )
    return _table(lines)


def front_table(rows: pd.DataFrame, kind: str) -> Table:
    """The runs on a front, by scene and time; `kind` is "curve" or "shape"."""
    chosen = [part.sort_values("seconds") for _, part in by_scene(rows[rows[f"on_{kind}_front"] == 1])]
    part = {"part of the paper's mesh": lambda row: f"{row.ratio_to_paper_mesh:.3g}"}
    setting = {"setting": lambda row: setting_of(row).label}
    return view(pd.concat(chosen), SCENE | setting | TIME | part | ERRORS)


def peer_table(rows: pd.DataFrame) -> Table:
    """OpenSees beside the wire model with the same mesh and steps."""
    wires = {
        (each.scene, setting_of(each)): each
        for each in rows[rows["role"] == "run"].itertuples()
        if each.model == "wirefe"
    }

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
    return view(
        rows[rows["role"] == "penalty"],
        {
            **SCENE,
            "setting": _label,
            "penalty (N/mm)": lambda row: f"{row.penalty:.0e}".replace("+0", ""),
            "outcome": _ending,
            **TIME,
            "iterations": lambda row: f"{row.iterations:.0f}",
            "curve (%)": _percent,
            "reference's own error (%)": lambda row: f"{100.0 * row.reference_curve_error:.1g}",
        },
    )


def differing_pairs(rows: pd.DataFrame) -> pd.DataFrame:
    """Runs that differ in the number of pairs alone, on the scenes whose answer changes with it."""
    wires = rows[(rows["role"] == "run") & (rows["model"] == "wirefe")]
    found = []
    for _, part in by_scene(wires):
        other = part[part["pairs_per_turn"] != PAIRS]
        same = pd.MultiIndex.from_frame(part[["series", "elements_per_turn", "steps"]])
        alike = part[same.isin(pd.MultiIndex.from_frame(other[["series", "elements_per_turn", "steps"]]))]
        if len(alike) and np.ptp(alike["curve_max"]) > part["reference_curve_error"].iloc[0]:
            found.append(alike.sort_values("pairs_per_turn", kind="stable"))
    return pd.concat(found) if found else wires.iloc[:0]


def pairs_table(rows: pd.DataFrame) -> Table:
    """What the number of sphere pairs changes."""
    pairs = {"pairs per turn": lambda row: row.pairs_per_turn, "outcome": lambda row: row.outcome}
    return view(differing_pairs(rows), SCENE | pairs | TIME | ERRORS)


def _table(rows: Rows) -> Table:
    return Table(tuple(rows[0]), tuple(tuple(row.values()) for row in rows))


def _label(row: Any) -> str:
    return setting_of(row).label.removesuffix(f", {STEPS} steps")


def _ending(row: Any) -> str:
    ended = row.outcome != "completed"
    return f"{row.outcome.replace('_', ' ')} after t = {row.last_time:.2f}" if ended else row.outcome


def _percent(row: Any) -> str:
    return f"{100.0 * row.curve_max:.2g}"


def _time(row: Any) -> str:
    return spread(row, "seconds", 1e3)


Columns = dict[str, Callable[[Any], object]]
SCENE: Columns = {"scene": lambda row: TITLES[row.scene]}
TIME: Columns = {"time (ms)": _time}
ERRORS: Columns = {"curve (%)": _percent, "shape (mm)": lambda row: f"{row.shape_max_mm:.2g}"}
