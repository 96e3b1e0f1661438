"""Tornado figure: how far each open input moves the load curves of both models, one panel a case."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch

from validation.sensitivity.changes import COMPLETED, CURVE, Study, sizes, values
from validation.sensitivity.inputs import AGAINST, OpenInput
from validation.study.files import write_files
from validation.study.models import BEAM, MODELS, WIRE
from validation.study.plots import drawn, lettered, styled
from validation.study.style import BEAM_LABEL, BLUE, DOUBLE, RED, WIRE_LABEL, Look

NAME = "sensitivity"
LEAST = 0.005  # %: inputs that move no model by this much are left out
ROW, FRAME = 0.215, 0.66  # in: height of an input; of a panel's title and axis
BAR = 0.34  # of a row
LABEL = 0.3  # of the bars' range, on either side for the values at their ends
# the wire model's bars are light and hatched, the beam's dark and plain: they differ without colour
LOOKS: dict[str, Look] = {
    BEAM: {"facecolor": BLUE, "edgecolor": BLUE, "linewidth": 0.5},
    WIRE: {"facecolor": "#fbd3c4", "edgecolor": RED, "linewidth": 0.5, "hatch": "//////"},
}
PLACES = {BEAM: -0.5 * BAR, WIRE: 0.5 * BAR}
LABELS = {BEAM: BEAM_LABEL, WIRE: WIRE_LABEL}
END: Look = {"marker": "x", "color": "black", "markersize": 4.0, "markeredgewidth": 1.0}
STAR: Look = {"marker": "$*$", "color": "black", "markersize": 4.5, "linestyle": "none"}
BAND: Look = {"facecolor": "#d9d9d9", "edgecolor": "none", "zorder": 0.5}
VALUE = {"va": "center_baseline", "fontsize": 6.5, "zorder": 5.0}
HATCH: dict[str, Any] = {"hatch.linewidth": 0.6}


def write(studies: Sequence[Study], out: Path) -> None:
    """Write the figure as SVG and PNG."""
    with styled(**HATCH):
        write_files(drawn(draw(studies), NAME), out)


def draw(studies: Sequence[Study]) -> Figure:
    """Panels in two columns, cases with contact above, bars of one thickness in all."""
    studies = sorted(studies, key=lambda study: "penalty" not in set(values(study.data)["input"]))
    columns = min(2, len(studies))
    rows = [max(len(_drawn(study)), 1) for study in studies]
    counts = [max(rows[k : k + columns]) for k in range(0, len(rows), columns)]
    height = sum(FRAME + ROW * count for count in counts) + 0.35
    figure = Figure(figsize=(DOUBLE, height), layout="constrained")
    panels = figure.subplots(len(counts), columns, squeeze=False, height_ratios=counts)
    for axes in panels.flat[len(studies) :]:
        axes.set_visible(False)
    for index, (axes, study) in enumerate(zip(panels.flat, studies, strict=False)):
        _panel(axes, study, counts[index // columns])
        axes.set_title(lettered(index, len(studies), study.title))
    shown = {model for study in studies for model in values(study.data)["model"]}
    bars = [Patch(**LOOKS[model], label=LABELS[model]) for model in MODELS if model in shown]
    others: list[Any] = []
    if any(study.deviation is not None for study in studies):
        others.append(Patch(**BAND, label="deviation of the models, nothing changed"))
    if any((values(study.data)["outcome"] != COMPLETED).any() for study in studies):
        others.append(
            Line2D([], [], linestyle="none", **END, label="a value ends short of full load (table)")
        )
    if any(item.kind == AGAINST for study in studies for item in _drawn(study)):
        others.append(Line2D([], [], **STAR, label="the paper's own result speaks against it"))
    figure.legend(handles=[*bars, *others], loc="outside lower center", ncols=2, columnspacing=1.6)
    return figure


def _drawn(study: Study) -> list[OpenInput]:
    """Inputs with a bar or a mark, the largest first."""
    data = study.data
    size = sizes(data).max(axis=1)
    ended = set(values(data).loc[data["outcome"] != COMPLETED, "input"])
    inputs = {item.name: item for item in study.inputs}
    return [inputs[name] for name in size.index if name in ended or size[name] >= LEAST]


def _panel(axes: Axes, study: Study, count: int) -> None:
    """Bars of both models over all values of each input, and marks where values end short of full load."""
    data, items = study.data, _drawn(study)
    for row, item in enumerate(items):
        mine = values(data[data["input"] == item.name])
        for model, place in PLACES.items():
            bar = mine[mine["model"] == model]
            low, high = _reach(bar)
            if low < high:
                axes.barh(row + place, high - low, BAR, left=low, **LOOKS[model], zorder=2.0)
            if (bar["outcome"] != COMPLETED).any():
                edge = axes.get_yaxis_transform()  # beside all bars: they start where it would stand
                axes.plot(1.0, row + place, linestyle="none", **END, transform=edge, clip_on=False)
        _values(axes, row, mine.dropna(subset=CURVE))
    if study.deviation is not None:
        axes.axvspan(-study.deviation, study.deviation, **BAND)
    axes.axvline(0.0, color="black", linewidth=0.6)
    axes.set_yticks(range(len(items)), [item.title + "*" * (item.kind == AGAINST) for item in items])
    axes.tick_params(axis="y", length=0)
    axes.grid(visible=False, axis="y")
    axes.spines["left"].set_visible(False)
    low, high = _reach(data)
    margin = LABEL * (high - low)
    axes.set(xlim=(low - margin, high + margin), ylim=(count - 0.4, -0.6))
    farther = "force or movement grows" if study.prescribed else "top moves farther"
    axes.set_xlabel(f"{farther} (% of peak)")


def _reach(changes: pd.DataFrame) -> tuple[float, float]:
    """Least and largest change, 0 among them."""
    known = [0.0, *changes[CURVE].dropna()]
    return min(known), max(known)


def _values(axes: Axes, row: int, changes: pd.DataFrame) -> None:
    """The values that reach farthest to either side, beside the bars of the models that have them."""
    for side in (-1.0, 1.0):
        reach = side * changes[CURVE]
        if not reach.max() >= LEAST:
            continue
        change = changes.loc[reach.idxmax()]
        models = changes.loc[changes["value"] == change["value"], "model"]
        place = (change[CURVE], row + models.map(PLACES).mean())
        look: Look = {"ha": "left" if side > 0.0 else "right"} | VALUE
        axes.annotate(change["value"], place, xytext=(3.0 * side, 0.0), textcoords="offset points", **look)
