"""Page and tables of the work-precision study, views of its recorded result; words in ``page.md``."""

import json
from collections.abc import Callable, Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from coilspring import InputError
from validation.study import provenance
from validation.study.cases import CASES
from validation.study.files import write_files, write_text
from validation.study.frames import view
from validation.study.models import LAWS, PAPER_LAW
from validation.study.tables import Table
from validation.study.template import page, template
from validation.study.timing import spread
from validation.workprecision import results
from validation.workprecision.results import by_scene, fastest, of_paper, setting_of, usual_pairs
from validation.workprecision.settings import PEER, STEPS, title
from wirefe.contact.points import PER_TURN

WORDS = template(Path(__file__).with_name("page.md"))
PAPER_REDUCTION = {case.name: f"{case.paper_reduction:g}" for case in CASES}
EQUAL_ERROR = (
    *("scene", "law", "its error (%)", "its time (ms)", "wire model, as good at least", "error (%)"),
    *("time (ms)", "wire model / beam at equal error", "reduction (%)"),
    *("reduction against the paper's mesh (%)", "paper's reduction (%)"),
)
PAPER = (
    *("scene", "paper's mesh (ms)", "error (%)", "paper's model (ms)", "its error (%)"),
    *("fastest as accurate as the paper's mesh", "its time (ms)", "part of the mesh's time"),
)
REFERENCE = (
    *("scene", "curve, half the mesh (of the peak)", "curve, half the steps (of the peak)"),
    *("shape, half the mesh (mm)", "shape, half the steps (mm)", "from the exact rod (of the peak)"),
)
Columns = dict[str, Callable[[Any], object]]


def write(out: Path, drawn: bool = False) -> pd.DataFrame:
    """Write page and, where wanted, figures of the result recorded in a folder; `InputError` without one."""
    if not (out / results.FILE).is_file() or not (out / provenance.FILE).is_file():
        raise InputError(f"no {results.FILE} with {provenance.FILE} in {out}: measure first")
    rows = results.read(out)
    if drawn:
        from validation.workprecision import figures

        write_files(figures.files(rows), out)
    made = json.loads((out / provenance.FILE).read_text(encoding="utf-8"))
    write_text(out / "workprecision.md", _markdown(rows, made, drawn))
    return rows


def _markdown(rows: pd.DataFrame, made: Mapping[str, str], drawn: bool) -> str:
    """The study for a reader; `made`: where and when it was measured."""
    halved = rows[rows["role"] == "half mesh"]
    peers = rows[rows["role"] == "opensees"]
    sticking = rows.loc[rows["sliding"] == "scene", "scene"].unique()
    reference = {
        "series": " or ".join(halved["series"].unique()),
        "elements_per_turn": " or ".join(f"{2 * mesh}" for mesh in halved["elements_per_turn"].unique()),
        "steps": halved["steps"].iloc[0],
        "rounds": f"{rows.loc[rows['role'] == 'run', 'rounds'].iloc[0]:.0f}",
    }
    return page(
        WORDS,
        **{"STEPS": STEPS, "PER_TURN": PER_TURN, "made": made, "drawn": drawn, "reference": reference},
        tables={
            "equal_error": equal_error_table(rows),
            "paper": paper_table(rows),
            "reference": reference_table(rows),
            "curve_front": front_table(rows, "curve"),
            "shape_front": front_table(rows, "shape"),
            "peers": peer_table(rows),
            "penalty": penalty_table(rows),
            "pairs": pairs_table(rows),
        },
        peer_refused=((rows["role"] == results.LEFT_OUT) & (rows["series"] == PEER)).any(),
        reasons=results.reasons(rows),
        exact=(rows["role"] == "exact rod").any(),
        half_is_run=results.has_half_mesh(rows),
        sticking=", ".join(map(title, sticking)),
        in_paper=bool(set(rows["scene"]) & PAPER_REDUCTION.keys()),
        geometries=[name for name in PER_TURN if (rows["geometry"] == name).any()],
        peer_rounds=None if peers.empty else f"{peers['rounds'].iloc[0]:.0f}",
    )


def digest(rows: pd.DataFrame) -> list[str]:
    """A line on each scene for a reader at the terminal."""
    lines = []
    for scene, part in by_scene(rows):
        best = fastest(part, of_paper(part)[0].curve_max)
        if best is None:
            lines.append(f"{scene}: no run of the whole curve is as accurate as the paper's mesh")
            continue
        front = part[part["on_curve_front"] == 1].sort_values("seconds")
        labels = ", ".join(map(label, front.itertuples()))
        lines.append(
            f"{scene}: as accurate as the paper's mesh in 1/{1.0 / best.ratio_to_paper_mesh:.3g} of its time "
            f"by {setting_of(best).label}; front of the load curve: {labels}"
        )
    return [*results.reasons(rows), *lines]


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
            if beam is None:
                continue
            wire, saved = fastest(part[part["model"] == "wirefe"], beam.curve_max), ("none", *[""] * 4)
            if wire is not None:
                share = beam.ratio_to_paper_mesh / wire.ratio_to_paper_mesh
                saved = (label(wire), _error(wire), _time(wire), f"{1.0 / share:.3g}", _reduction(share))
            paper = (_reduction(beam.ratio_to_paper_mesh), PAPER_REDUCTION.get(scene, "not in the paper"))
            lines.append((title(scene), law, _error(beam), _time(beam), *saved, *paper))
    shown = None if set(rows["scene"]) & PAPER_REDUCTION.keys() else -1  # without the paper's
    return Table(EQUAL_ERROR[:shown], tuple(line[:shown] for line in lines))


def _beam(rows: pd.DataFrame, law: str) -> Any:
    """A law's run: the paper's law as the paper has it, the helix law by the scene's sliding."""
    runs = rows[(rows["role"] == "run") & (rows["series"] == law) & (rows["steps"] == STEPS)]
    found = {each.sliding: each for each in runs[runs["tangent"] == "exact"].itertuples()}
    return found.get("ignore") if law == PAPER_LAW else found.get("scene", found.get("ignore"))


def _reduction(share: float) -> str:
    return f"{100.0 * (1.0 - share):.1f}"


def paper_table(rows: pd.DataFrame) -> Table:
    """What is as accurate as the paper's FE mesh, and its time."""
    lines = []
    for scene, part in by_scene(rows):
        mesh, model = of_paper(part)
        own = (_time(model), _error(model)) if model else ("left out", "")
        best, found = fastest(part, mesh.curve_max), ("none", "", "")
        if best is not None:
            found = (setting_of(best).label, _time(best), f"1/{1.0 / best.ratio_to_paper_mesh:.3g}")
        lines.append((title(scene), _time(mesh), _error(mesh), *own, *found))
    return Table(PAPER, tuple(lines))


def reference_table(rows: pd.DataFrame) -> Table:
    """How far the references are off themselves."""
    lines = []
    for scene, part in by_scene(rows):
        own = part.drop_duplicates("role").set_index("role")
        halves = own.loc[["half mesh", "half steps"], ["curve_max", "shape_max_mm"]].T.to_numpy().ravel()
        exact = f"{own.at['exact rod', 'curve_max']:.1e}" if "exact rod" in own.index else "no exact solution"
        lines.append((title(scene), *(f"{error:.1e}" for error in halves), exact))
    return Table(REFERENCE, tuple(lines))


def front_table(rows: pd.DataFrame, kind: str) -> Table:
    """The runs on a front, by scene and time; `kind` is "curve" or "shape"."""
    chosen = [part.sort_values("seconds") for _, part in by_scene(rows[rows[f"on_{kind}_front"] == 1])]
    part: Columns = {"part of the paper's mesh": lambda row: f"{row.ratio_to_paper_mesh:.3g}"}
    setting: Columns = {"setting": lambda row: setting_of(row).label}
    return view(pd.concat([rows.iloc[:0], *chosen]), SCENE | setting | TIME | part | ERRORS)


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
