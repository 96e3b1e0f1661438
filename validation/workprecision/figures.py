"""Figures of the work-precision study: error against CPU time, and the cost of the penalty."""

from collections.abc import Sequence
from itertools import compress

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch
from matplotlib.ticker import NullFormatter

from coilspring import Contact
from validation.study.models import BEAM, WIRE
from validation.study.plots import drawn, lettered, styled
from validation.study.style import BLUE, DOUBLE, GREY, LIGHT_RED, NAVY, RED, Look
from validation.workprecision.results import by_scene, competes, of_paper
from validation.workprecision.settings import PEER, SERIES, STEPS, title

COLUMNS = 3
DASHED = (0, (4, 2))
INK, LIGHT = "#222222", "#c9c9c9"
# the wire model red and angular, the equivalent beam blue and round; all four differ in grey
LOOKS: dict[str, Look] = {
    series: {"color": colour, "marker": marker, "ls": line, "label": label}
    for series, colour, marker, line, label in (
        ("straight", LIGHT_RED, "s", DASHED, "wire model, straight elements"),
        ("curved", RED, "^", "-", "wire model, curved elements"),
        ("haringx", BLUE, "o", "none", "equivalent beam, law haringx"),
        ("helix", NAVY, "D", "none", "equivalent beam, law helix"),
        (PEER, GREY, "P", "none", "OpenSees, straight elements"),
    )
}
COLUMNS_OF = {  # errors, the reference's own, and what they are multiplied by
    "curve": ("curve_max", "reference_curve_error", 100.0),
    "shape": ("shape_max_mm", "reference_shape_error_mm", 1.0),
}
LABELS = {"curve": "error of the load curve (%)", "shape": "error of the shape (mm)"}
# open symbols are larger and have no filling, so that a filled one under them is seen
FILLED: Look = {"lw": 0.9, "zorder": 3.0, "ms": 3.0, "mec": "white", "mew": 0.3}
OPEN: Look = {"ls": "none", "zorder": 3.2, "ms": 4.0, "mfc": "none", "mew": 0.6}
RING: Look = {"linestyle": "none", "zorder": 2.0, "ms": 8.0, "mfc": "none", "mec": INK, "mew": 0.7}
FRONT: Look = {"color": LIGHT, "linewidth": 3.2, "solid_joinstyle": "round", "zorder": 1.5}
FLOOR: Look = {"facecolor": "#efefef", "edgecolor": "#a8a8a8", "hatch": "////", "lw": 0.0, "zorder": 0.5}
USUAL: Look = {"color": GREY, "linewidth": 0.8, "zorder": 0.5}  # the penalty of the scenes
DASHES = ("-", DASHED)  # of the first scene and the second
PAPER_TANGENT: Look = {"color": BLUE, "marker": "x", "ls": "none", "ms": 4.0, "mew": 1.0, "zorder": 3.0}
MODEL_LOOKS = ((BEAM, "equivalent beam", BLUE, "o"), (WIRE, "wire model", RED, "s"))
CROSS: Look = {"marker": "x", "color": "black", "linestyle": "none", "markersize": 6.0}


def files(rows: pd.DataFrame) -> dict[str, bytes]:
    """``workprecision-curve``, ``-shape`` and, where penalties were varied, ``-penalty`` as SVG and PNG."""
    with styled():
        found: dict[str, bytes] = {}
        for kind in LABELS:
            found |= drawn(draw(rows, kind), f"workprecision-{kind}")
        penalties = rows[rows["role"] == "penalty"]
        if len(penalties):
            found |= drawn(draw_penalties(penalties), "workprecision-penalty")
        return found


def draw(rows: pd.DataFrame, kind: str) -> Figure:
    """One panel a scene, all on the same axes; `kind` is "curve" or "shape"."""
    # of load curves those alone that give the whole curve: with fewer steps the error is that of fewer points
    roles = ("run", "opensees") if kind == "curve" else ("run",)  # OpenSees has no shape
    rows = rows[rows["role"].isin(roles) & ((kind == "shape") | (rows["steps"] >= STEPS))]
    error, floor, scale = COLUMNS_OF[kind]
    in_units = {"ms": 1e3 * rows["seconds"], "error": scale * rows[error], "floor": scale * rows[floor]}
    scenes = by_scene(rows.assign(**in_units, shown=competes(rows)))
    columns = min(COLUMNS, len(scenes))
    lines = -(-len(scenes) // columns)
    figure = Figure(figsize=(DOUBLE, 0.85 + 2.2 * lines), layout="constrained")
    grid = figure.subplots(lines, columns, sharex=True, sharey=True, squeeze=False)
    shown = [part[part["shown"]] for _, part in scenes]
    for index, (axes, (scene, part), able) in enumerate(zip(grid.flat, scenes, shown, strict=False)):
        _panel(axes, part, able, kind)
        axes.set_title(lettered(index, len(scenes), title(scene)))
    for axes in grid.flat[len(scenes) :]:
        axes.set_visible(False)
    every = pd.concat(shown)
    low = min(every["floor"].min(), every["error"].min())  # so that a strip of every floor is seen
    for axes in grid.flat:
        axes.set(xscale="log", yscale="log", ylim=(0.4 * low, 2.5 * every["error"].max()))
        axes.tick_params(labelbottom=True)
    for axes in grid[-1]:
        axes.set_xlabel("CPU time (ms)")
    for axes in grid[:, 0]:
        axes.set_ylabel(LABELS[kind])
    figure.legend(handles=_key(shown), loc="outside lower center", ncols=3, columnspacing=1.4)
    return figure


def _panel(axes: Axes, part: pd.DataFrame, able: pd.DataFrame, kind: str) -> None:
    """Filled symbols at the scene's steps, which a line joins where they are meshes; open ones else."""
    for series in (*SERIES, PEER):
        mine = able[able["series"] == series]
        usual = mine[mine["steps"] == STEPS].sort_values("elements_per_turn")
        paper = usual["tangent"] == "paper"
        axes.plot(usual["ms"][paper], usual["error"][paper], **PAPER_TANGENT)
        for chosen, filled in ((mine[mine["steps"] != STEPS], False), (usual[~paper], True)):
            if len(chosen):
                axes.plot(chosen["ms"], chosen["error"], **_look(series, filled))
    best = part[part[f"on_{kind}_front"] == 1].sort_values("ms")
    axes.plot(best["ms"], best["error"], drawstyle="steps-post", **FRONT)
    axes.axhspan(1e-30, part["floor"].iloc[0], **FLOOR)
    for paper, mesh in zip(of_paper(able), (True, False), strict=True):
        if paper is not None:
            axes.plot(paper.ms, paper.error, **_ring(mesh))


def _look(series: str, filled: bool) -> Look:
    return LOOKS[series] | (FILLED if filled else OPEN | {"mec": LOOKS[series]["color"]})


def _ring(mesh: bool) -> Look:
    return RING | {"marker": "s" if mesh else "o"}


def _key(shown: Sequence[pd.DataFrame]) -> Sequence[Line2D | Patch]:
    """Legend of what is drawn of the scenes."""
    every = pd.concat(shown)
    usual = [Line2D([], [], **_look(name, True)) for name in (*SERIES, PEER) if name in set(every["series"])]
    more = (every["steps"] >= STEPS).all()
    words = f"open: {'more' if more else 'other'} than {STEPS} steps"
    other = Line2D([], [], **_look("curved", False) | {"label": words})
    tangent = Line2D([], [], **PAPER_TANGENT, label="law haringx, paper’s tangent")
    front = Line2D([], [], **FRONT, label="Pareto front")
    names = {True: "paper’s mesh", False: "paper’s model"}
    ringed = [any(rows) for rows in zip(*map(of_paper, shown), strict=True)]
    rings = [Line2D([], [], **_ring(mesh), label=name) for mesh, name in names.items()]
    given = (every["tangent"] == "paper").any(), (every["steps"] != STEPS).any(), True, *ringed
    others = compress((tangent, other, front, *rings), given)
    return [*usual, *others, Patch(**FLOOR, label="reference’s own error")]


def draw_penalties(rows: pd.DataFrame) -> Figure:
    """Error over the penalty on the left, CPU time on the right."""
    figure = Figure(figsize=(DOUBLE, 2.9), layout="constrained")
    error, time = figure.subplots(1, 2)
    for (scene, part), dashes in zip(by_scene(rows), DASHES, strict=False):
        for model, name, colour, marker in MODEL_LOOKS:
            mine = part[part["model"] == model]
            look: Look = {"color": colour, "marker": marker, "linestyle": dashes, "markersize": 4.0}
            look |= {"mfc": colour if dashes == "-" else "white", "label": f"{title(scene)}, {name}"}
            ended = mine[mine["outcome"] != "completed"]
            for axes, column, scale in ((error, "curve_max", 100.0), (time, "seconds", 1e3)):
                axes.plot(mine["penalty"], scale * mine[column], **look)
                axes.plot(ended["penalty"], scale * ended[column], **CROSS)
    error.set(ylabel=LABELS["curve"], title="(a) Error")
    time.set(ylabel="CPU time (ms)", title="(b) Time")
    for axes in (error, time):
        axes.set(xscale="log", yscale="log", xlabel="penalty K (N/mm)")
        axes.axvline(Contact().stiffness, **USUAL)
        axes.yaxis.set_major_formatter("{x:g}")
        axes.yaxis.set_minor_formatter(NullFormatter())
        low, high = np.log10(axes.get_ylim())
        axes.set_ylim(10.0 ** np.floor(low), 10.0 ** np.ceil(high))  # whole ones: two at least have a label
    handles, _ = error.get_legend_handles_labels()
    handles.append(Line2D([], [], **USUAL, label="K of the scenes"))
    if (rows["outcome"] != "completed").any():
        handles.append(Line2D([], [], **CROSS, label="path ends before full load"))
    figure.legend(handles=handles, loc="outside lower center", ncols=3)
    return figure
