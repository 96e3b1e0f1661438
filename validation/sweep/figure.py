"""Picture of a sweep of one number: what the top does at full load against it."""

from __future__ import annotations

from collections.abc import Sequence

from matplotlib import rc_context
from matplotlib.figure import Figure

from validation.study.plots import png
from validation.study.style import BLUE, GREY, RC, RED, SINGLE, Look
from validation.sweep.table import COMPLETED, Row

COLOURS = {"equivbeam": BLUE, "wirefe": RED}
UNITS = {
    **dict.fromkeys(("wire_diameter", "mean_diameter", "active_height", "displacement", "pitch"), "mm"),
    **{"force": "N", "stages": "N", "E": "MPa", "G": "MPa", "start_phase": "rad"},
}


def draw(rows: Sequence[Row], key: str, scene: str, model: str, prescribed: bool) -> bytes:
    """The curve as PNG: UY, or the force where UY is `prescribed`; with what ended before full load."""
    column, label = ("load_y", "axial force (N)") if prescribed else ("uy", "UY of the top (mm)")
    found = sorted((row for row in rows if row[column]), key=lambda row: float(row[key]))
    whole = [row for row in found if row["outcome"] == COMPLETED]
    ended = [row for row in found if row["outcome"] != COMPLETED]
    with rc_context(RC):
        figure = Figure(figsize=(SINGLE, 0.75 * SINGLE), layout="constrained")
        axes = figure.add_subplot(xlabel=_with_unit(key), ylabel=label, title=f"{scene}, {model}")
        looks: tuple[Look, Look] = (
            {"color": COLOURS[model], "marker": "o", "markersize": 3.0, "label": "full load"},
            {"color": GREY, "marker": "x", "markersize": 4.0, "label": "last state, before full load"},
        )
        for some, look, line in zip((whole, ended), looks, ("-", ""), strict=True):
            x, y = ([float(row[name]) for row in some] for name in (key, column))
            axes.plot(x, y, linestyle=line, **look)
        if ended:
            axes.legend()
        return png(figure)


def _with_unit(key: str) -> str:
    """A key, with its unit where it has one."""
    units = [UNITS[name] for name in key.split(".") if name in UNITS]
    return f"{key} ({units[-1]})" if units else key
