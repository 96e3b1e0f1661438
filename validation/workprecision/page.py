"""The page and figures of the work-precision study, views of its recorded result; words in ``page.md``."""

from __future__ import annotations

import json
from collections.abc import Mapping
from pathlib import Path

import pandas as pd

from coilspring import InputError
from validation.study import provenance
from validation.study.output import write_files, write_text
from validation.study.template import page, template
from validation.workprecision import results, tables
from validation.workprecision.settings import PEER, STEPS, title
from wirefe.contactpoints import PER_TURN

PAGE = template(Path(__file__).with_name("page.md"))


def write(out: Path, drawn: bool = False) -> pd.DataFrame:
    """Write page and, where wanted, figures of the result recorded in a folder; the result.

    Raises
    ------
    InputError : where none is recorded.
    """
    if not (out / results.FILE).is_file() or not (out / provenance.FILE).is_file():
        raise InputError(f"no {results.FILE} with {provenance.FILE} in {out}: measure first")
    rows = results.read(out)
    made = json.loads((out / provenance.FILE).read_text(encoding="utf-8"))
    if drawn:
        from validation.workprecision import figures

        write_files(figures.files(rows), out)
    write_text(out / "workprecision.md", markdown(rows, made, drawn))
    return rows


def markdown(rows: pd.DataFrame, made: Mapping[str, str], drawn: bool) -> str:
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
        PAGE,
        **{"STEPS": STEPS, "PER_TURN": PER_TURN, "made": made, "drawn": drawn, "reference": reference},
        tables=tables.tables(rows),
        peer_refused=((rows["role"] == results.LEFT_OUT) & (rows["series"] == PEER)).any(),
        reasons=results.reasons(rows),
        exact=(rows["role"] == "exact rod").any(),
        sticking=", ".join(map(title, sticking)),
        in_paper=bool(set(rows["scene"]) & tables.PAPER_REDUCTION.keys()),
        geometries=[name for name in PER_TURN if (rows["geometry"] == name).any()],
        peer_rounds=None if peers.empty else f"{peers['rounds'].iloc[0]:.0f}",
    )


def digest(rows: pd.DataFrame) -> list[str]:
    """A line on each scene for a reader at the terminal."""
    lines = []
    for scene, part in results.by_scene(rows):
        best = results.fastest(part, results.of_paper(part)[0].curve_max)
        if best is None:
            lines.append(f"{scene}: no run of the whole curve is as accurate as the paper's mesh")
            continue
        front = part[part["on_curve_front"] == 1].sort_values("seconds").itertuples()
        labels = [tables.label(row) for row in front]
        lines.append(
            f"{scene}: as accurate as the paper's mesh in 1/{1.0 / best.ratio_to_paper_mesh:.3g} of its time "
            f"by {results.setting_of(best).label}; front of the load curve: {', '.join(labels)}"
        )
    return [*results.reasons(rows), *lines]
