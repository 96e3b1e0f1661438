"""Picture of a sweep of one number: what the top does at full load against it."""

from collections.abc import Mapping, Sequence

from matplotlib.figure import Figure

from validation.study.plots import png, styled
from validation.study.style import BLUE, GREY, RED, SINGLE, Look

COLOURS = {"equivbeam": BLUE, "wirefe": RED}
LENGTHS = ("wire_diameter", "mean_diameter", "outer_diameter", "inner_diameter", "active_height")
UNITS = {
    **dict.fromkeys((*LENGTHS, "displacement", "pitch"), "mm"),
    **{"force": "N", "stages": "N", "E": "MPa", "G": "MPa", "density": "kg/m³", "start_phase": "rad"},
}


def draw(rows: Sequence[Mapping[str, str]], key: str, scene: str, model: str, prescribed: bool) -> bytes:
    """The curve as PNG: UY, or the force where UY is `prescribed`; with what ended before full load."""
    column, label = ("load_y", "axial force (N)") if prescribed else ("uy", "UY of the top (mm)")
    found = sorted((row for row in rows if row[column]), key=lambda row: float(row[key]))
    units = [UNITS[name] for name in key.split(".") if name in UNITS]
    looks: dict[bool, Look] = {
        True: {"color": COLOURS[model], "marker": "o", "markersize": 3.0, "label": "full load"},
        False: {"color": GREY, "marker": "x", "ms": 4.0, "ls": "", "label": "last state, before full load"},
    }
    with styled():
        figure = Figure(figsize=(SINGLE, 0.75 * SINGLE), layout="constrained")
        axes = figure.add_subplot(ylabel=label, title=f"{scene}, {model}")
        axes.set_xlabel(f"{key} ({units[-1]})" if units else key)
        for whole, look in looks.items():
            some = [row for row in found if (row["outcome"] == "completed") == whole]
            axes.plot(*([float(row[name]) for row in some] for name in (key, column)), **look)
        if any(row["outcome"] != "completed" for row in found):
            axes.legend()
        return png(figure)
