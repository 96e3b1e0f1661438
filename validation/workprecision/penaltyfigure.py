"""Figure of the penalty sweep: error and time of both models over the penalty."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from matplotlib.axes import Axes
from matplotlib.figure import Figure

from validation.study.style import BLUE, DOUBLE, GREY, RED
from validation.workprecision.penaltysweep import NAMES, PenaltyPoint, Sweep
from validation.workprecision.settings import TITLES

COLOURS = {"equivbeam": BLUE, "wirefe": RED}
MARKERS = {"equivbeam": "o", "wirefe": "s"}
DASHES = ("-", (0, (4, 2)))  # of the first scene and the second
CROSS: dict[str, Any] = {"marker": "x", "color": "black", "linestyle": "none", "markersize": 6.0}


def draw_penalties(sweeps: Sequence[Sweep]) -> Figure:
    """Error on the left, CPU time on the right."""
    figure = Figure(figsize=(DOUBLE, 2.9), layout="constrained")
    error, time = figure.subplots(1, 2)
    for sweep, dashes in zip(sweeps, DASHES, strict=False):
        for model, points in sweep.points.items():
            filled = dashes == "-"
            look = {
                "color": COLOURS[model],
                "marker": MARKERS[model],
                "linestyle": dashes,
                "markersize": 4.0,
                "markerfacecolor": COLOURS[model] if filled else "white",
                "label": f"{TITLES[sweep.scene.name]}, {NAMES[model]}",
            }
            _line(error, points, [100.0 * point.error.curve_max for point in points], look)
            _line(time, points, [1e3 * point.seconds.median for point in points], look)
    error.set(ylabel="error of the load curve (%)", title="(a)")
    time.set(ylabel="CPU time (ms)", title="(b)")
    for axes in (error, time):
        axes.set(xscale="log", yscale="log", xlabel="penalty K (N/mm)")
        axes.axvline(sweeps[0].scene.contact.stiffness, color=GREY, linewidth=0.8, zorder=0.5)
        axes.yaxis.set_major_formatter("{x:g}")
    figure.legend(*error.get_legend_handles_labels(), loc="outside lower center", ncols=2)
    return figure


def _line(axes: Axes, points: Sequence[PenaltyPoint], values: Sequence[float], look: dict[str, Any]) -> None:
    axes.plot([point.penalty for point in points], values, **look)
    for point, value in zip(points, values, strict=True):
        if point.outcome != "completed":
            axes.plot(point.penalty, value, **CROSS)
