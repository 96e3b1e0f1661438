"""Figures of the work-precision study: error against CPU time, one panel a scene."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import matplotlib
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch

from validation.study.output import write_files
from validation.study.plots import drawn
from validation.study.style import BLUE, DOUBLE, GREY, RC, RED, STEEL
from validation.workprecision.penaltyfigure import draw_penalties
from validation.workprecision.penaltysweep import Sweep
from validation.workprecision.points import Point, Study
from validation.workprecision.settings import PEER, SERIES, STEPS, TITLES

COLUMNS = 3
BROWN, SKY, INK, LIGHT = "#5b1a08", "#8fc1ee", "#222222", "#c9c9c9"
# the wire model warm and angular, the equivalent beam blue and round; all four differ in grey
LOOKS: dict[str, dict[str, Any]] = {
    "straight": {"color": RED, "marker": "s", "linestyle": (0, (4, 2))},
    "curved": {"color": BROWN, "marker": "^", "linestyle": "-"},
    "haringx": {"color": BLUE, "marker": "o", "linestyle": "none"},
    "helix": {"color": SKY, "marker": "D", "linestyle": "none"},
    PEER: {"color": GREY, "marker": "P", "linestyle": "none"},
}
NAMES = {
    "straight": "wire model, straight elements",
    "curved": "wire model, curved elements",
    "haringx": "equivalent beam, law haringx",
    "helix": "equivalent beam, law helix",
    PEER: "OpenSees, straight elements",
}
FILLED, OPEN, RING = 4.2, 3.0, 9.0  # sizes of symbols, points
FRONT: dict[str, Any] = {"color": LIGHT, "linewidth": 3.2, "solid_joinstyle": "round", "zorder": 1.5}
FLOOR: dict[str, Any] = {
    "facecolor": "#efefef",
    "edgecolor": "#a8a8a8",
    "hatch": "////",
    "linewidth": 0.0,
    "zorder": 0.5,
}


def write(studies: Sequence[Study], sweeps: Sequence[Sweep], out: Path) -> None:
    """Write ``workprecision-curve``, ``-shape`` and, of sweeps, ``-penalty`` as SVG and PNG."""
    looks: Any = RC
    with matplotlib.rc_context(looks):
        for kind in ("curve", "shape"):
            write_files(drawn(draw(studies, kind), f"workprecision-{kind}"), out)
        if sweeps:
            write_files(drawn(draw_penalties(sweeps), "workprecision-penalty"), out)


def draw(studies: Sequence[Study], kind: str) -> Figure:
    """One panel a scene, all on the same axes; `kind` is "curve" or "shape"."""
    columns = min(COLUMNS, len(studies))
    rows = -(-len(studies) // columns)
    figure = Figure(figsize=(DOUBLE, 0.85 + 2.0 * rows), layout="constrained")
    grid = figure.subplots(rows, columns, sharex=True, sharey=True, squeeze=False)
    for letter, axes, study in zip("abcdefgh", grid.flat, studies, strict=False):
        _panel(axes, study, kind)
        axes.set_title(f"({letter}) {TITLES[study.scene.name]}")
    for axes in grid.flat[len(studies) :]:
        axes.set_visible(False)
    _scale(grid, studies, kind)
    peers = kind == "curve" and any(study.peers for study in studies)
    figure.legend(handles=_key(peers), loc="outside lower center", ncols=3, columnspacing=1.4)
    return figure


def _panel(axes: Axes, study: Study, kind: str) -> None:
    able = _shown(study, kind)
    for series in (*SERIES, PEER):
        _series(axes, [point for point in able if point.setting.series == series], kind)
    best = study.curve_front if kind == "curve" else study.shape_front
    axes.plot(*_places(best, kind), drawstyle="steps-post", **FRONT)
    axes.axhspan(1e-30, _floor(study, kind), **FLOOR)
    for point in able:
        if point.setting.is_paper_mesh or point.setting.is_paper_model:
            axes.plot(*_places([point], kind), **_ring(point.setting.is_paper_mesh))


def _shown(study: Study, kind: str) -> list[Point]:
    """What solves the scene to the end; OpenSees has no shape."""
    every = (*study.points, *study.peers) if kind == "curve" else study.points
    return [point for point in every if point.competes]


def _series(axes: Axes, points: Sequence[Point], kind: str) -> None:
    """Filled symbols at the scene's steps, which a line joins where they are meshes; small open ones else."""
    usual = sorted((p for p in points if p.setting.steps == STEPS), key=lambda p: p.setting.mesh)
    others = [point for point in points if point.setting.steps != STEPS]
    for chosen, filled in ((others, False), (usual, True)):
        if chosen:
            axes.plot(*_places(chosen, kind), **_look(chosen[0].setting.series, filled))


def _look(series: str, filled: bool) -> dict[str, Any]:
    look = LOOKS.get(series, {"color": INK, "marker": "v", "linestyle": "none"})
    face = look["color"] if filled else "white"
    style: dict[str, Any] = {"linewidth": 0.9, "zorder": 3.0 if filled else 2.5}
    edge = INK if filled else (look["color"] if series != "helix" else STEEL)
    plain: dict[str, Any] = {} if filled else {"linestyle": "none"}
    size = FILLED if filled else OPEN
    symbol = {"markerfacecolor": face, "markeredgecolor": edge, "markersize": size}
    return look | style | symbol | {"markeredgewidth": 0.5 if filled else 0.8} | plain


def _ring(mesh: bool) -> dict[str, Any]:
    return {
        "marker": "s" if mesh else "o",
        "markersize": RING,
        "markerfacecolor": "none",
        "markeredgecolor": INK,
        "markeredgewidth": 0.9,
        "linestyle": "none",
        "zorder": 4.0,
    }


def _places(points: Sequence[Point], kind: str) -> tuple[np.ndarray, np.ndarray]:
    """Milliseconds and errors (%, or mm)."""
    times = np.array([1e3 * point.seconds.median for point in points])
    return times, np.array([_error(point, kind) for point in points])


def _error(point: Point, kind: str) -> float:
    return 100.0 * point.error.curve_max if kind == "curve" else point.error.shape_max


def _floor(study: Study, kind: str) -> float:
    return 100.0 * study.reference.curve if kind == "curve" else study.reference.shape


def _scale(grid: np.ndarray, studies: Sequence[Study], kind: str) -> None:
    """Logarithmic axes that hold all points and a strip of every floor, and their labels."""
    errors = np.array([_error(point, kind) for study in studies for point in _shown(study, kind)])
    low = min(_floor(study, kind) for study in studies)
    label = "error of the load curve (%)" if kind == "curve" else "error of the shape (mm)"
    for axes in grid.flat:
        axes.set(xscale="log", yscale="log", ylim=(0.4 * min(low, errors.min()), 2.5 * errors.max()))
        axes.tick_params(labelbottom=True)
        axes.xaxis.set_major_formatter("{x:g}")
    for axes in grid[-1]:
        axes.set_xlabel("CPU time (ms)")
    for axes in grid[:, 0]:
        axes.set_ylabel(label)


def _key(peers: bool) -> list[Line2D | Patch]:
    series = (*SERIES, PEER) if peers else SERIES
    usual = [Line2D([], [], **_look(name, True), label=NAMES.get(name, name)) for name in series]
    other = Line2D([], [], **_look("curved", False), label=f"open: other than {STEPS} steps")
    front = Line2D([], [], **FRONT, label="Pareto front")
    rings = [Line2D([], [], **_ring(True), label="paper’s mesh"), Line2D([], [], **_ring(False))]
    rings[1].set_label("paper’s model")
    floor = Patch(**FLOOR, label="reference’s own error")
    return [*usual, other, front, *rings, floor]
