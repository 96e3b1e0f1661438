"""Tornado figure: how far each open input moves the load curves of both models, one panel a case."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import matplotlib
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch

from validation.sensitivity.inputs import AGAINST, BEAM, MODELS, WIRE, OpenInput
from validation.sensitivity.results import Change, Study
from validation.study.output import write_files
from validation.study.plots import drawn
from validation.study.style import BEAM_LABEL, BLUE, DOUBLE, RC, RED, WIRE_LABEL

NAME = "sensitivity"
SHOWN = 0.005  # %: inputs that move no model by this much are left out
ROW, FRAME = 0.215, 0.66  # in: height of an input; of a panel's title and axis
BAR = 0.34  # of a row
SMALL = 6.5  # pt, of the values
LABEL = 0.3  # of the bars' range, on either side for the values at their ends
# the wire model's bars are light and hatched, the beam's dark and plain: they differ without colour
LOOKS: dict[str, dict[str, Any]] = {
    BEAM: {"facecolor": BLUE, "edgecolor": BLUE, "linewidth": 0.5},
    WIRE: {"facecolor": "#fbd3c4", "edgecolor": RED, "linewidth": 0.5, "hatch": "//////"},
}
PLACES = {BEAM: -0.5 * BAR, WIRE: 0.5 * BAR}
LABELS = {BEAM: BEAM_LABEL, WIRE: WIRE_LABEL}
END: dict[str, Any] = {"marker": "x", "color": "black", "markersize": 4.5, "markeredgewidth": 1.1}
BAND: dict[str, Any] = {"facecolor": "#d9d9d9", "edgecolor": "none", "zorder": 0.5}
HATCH: dict[str, Any] = {"hatch.linewidth": 0.6}


def write(studies: Sequence[Study], out: Path) -> None:
    """Write the figure as SVG and PNG."""
    looks: Any = RC | HATCH
    with matplotlib.rc_context(looks):
        write_files(drawn(draw(studies), NAME), out)


def draw(studies: Sequence[Study]) -> Figure:
    """Panels in two columns, cases with contact above, bars of one thickness in all."""
    ordered = sorted(studies, key=lambda study: not study.case.scene.contact.enabled)
    columns = min(2, len(ordered))
    lines = [ordered[i : i + columns] for i in range(0, len(ordered), columns)]
    counts = [max(len(_shown(study)) for study in line) for line in lines]
    heights = [FRAME + ROW * count for count in counts]
    figure = Figure(figsize=(DOUBLE, sum(heights) + 0.35), layout="constrained")
    panels = figure.subplots(len(lines), columns, squeeze=False, height_ratios=counts)
    for axes in panels.flat[len(ordered) :]:
        axes.set_visible(False)
    for index, (axes, study) in enumerate(zip(panels.flat, ordered, strict=False)):
        _panel(axes, study, counts[index // columns])
        axes.set_title(f"({'abcd'[index]}) {study.case.title}")
    figure.legend(handles=_key(), loc="outside lower center", ncols=2, columnspacing=1.6)
    return figure


def _shown(study: Study) -> list[OpenInput]:
    """Inputs with a bar or a mark."""
    ended = {change.input.name for change in study.changes if not change.completed}
    return [
        item
        for item in study.ranked()
        if item.name in ended or max(study.size(item, model) for model in MODELS) >= SHOWN
    ]


def _panel(axes: Axes, study: Study, count: int) -> None:
    shown = _shown(study)
    for row, item in enumerate(shown):
        for model in MODELS:
            _bar(axes, row + PLACES[model], model, study.of(item, model))
        _values(axes, row, [change for model in MODELS for change in study.of(item, model)])
    axes.axvspan(-study.apart, study.apart, **BAND)
    axes.axvline(0.0, color="black", linewidth=0.6)
    axes.set_yticks(range(len(shown)), [item.title + "*" * (item.kind == AGAINST) for item in shown])
    axes.tick_params(axis="y", length=0)
    axes.grid(visible=False, axis="y")
    axes.spines["left"].set_visible(False)
    reach = [change.largest for change in study.changes if change.completed]
    low, high = min([0.0, *reach]), max([0.0, *reach])
    margin = LABEL * (high - low)
    axes.set(xlim=(low - margin, high + margin), ylim=(count - 0.4, -0.6))
    axes.set_xlabel("top moves farther (% of peak)")


def _bar(axes: Axes, place: float, model: str, changes: Sequence[Change]) -> None:
    """One model's bar over all values of an input, and marks where values end short of full load."""
    largest = [change.largest for change in changes if change.completed]
    low, high = min([0.0, *largest]), max([0.0, *largest])
    if low < high:
        axes.barh(place, high - low, BAR, left=low, **LOOKS[model], zorder=2.0)
    if not all(change.completed for change in changes):
        axes.plot(0.0, place, linestyle="none", **END, zorder=4.0)


def _values(axes: Axes, row: int, changes: Sequence[Change]) -> None:
    """The values that reach farthest to either side, beside the bars of the models that have them."""
    done = [change for change in changes if change.completed]
    for side, pick in ((-1.0, min), (1.0, max)):
        change = pick(done, key=lambda each: each.largest, default=None)
        if change is None or side * change.largest < SHOWN:
            continue
        places = [PLACES[each.model] for each in done if each.value == change.value]
        axes.annotate(
            change.value, (change.largest, row + sum(places) / len(places)), xytext=(3.0 * side, 0.0),
            textcoords="offset points", ha="left" if side > 0.0 else "right", va="center_baseline",
            fontsize=SMALL, zorder=5.0,
        )  # fmt: skip


def _key() -> list[Line2D | Patch]:
    bars = [Patch(**LOOKS[model], label=LABELS[model]) for model in MODELS]
    band = Patch(**BAND, label="the models apart, our defaults")
    end = Line2D([], [], linestyle="none", **END, label="a value ends short of full load (table)")
    return [*bars, band, end]
