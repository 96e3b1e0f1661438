"""Figures 4 to 8 of the paper, and one more on sliding; those of curves are views of their data."""

from pathlib import Path

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection
from matplotlib.colors import to_rgb
from matplotlib.figure import Figure
from matplotlib.image import imread
from matplotlib.lines import Line2D
from matplotlib.patches import Patch, Rectangle

from coilspring import EquilibriumPath
from validation.reproduce.curves import CONTACT, TANGENTS
from validation.study import style
from validation.study.frames import TIPS
from validation.study.plots import both, discs, lettered
from validation.study.style import TIP_LABELS
from validation.view.shapes import PARTS, PIXELS, Shapes, bands, overlaps, picture_frame, spaces, view

DOTTED = (0, (1, 1.3))
THOUSANDTHS = {"(mm)": "µm", "(rad)": "mrad"}
DIFFERENCES: dict[str, style.Look] = {
    "contact": {"color": "black", "linewidth": 1.0},
    "no_contact": {"color": "black", "linewidth": 1.1, "linestyle": DOTTED},
}
COUNTS: dict[str, style.Look] = {
    "paper": {"color": style.BLUE, "marker": "o", "markersize": 2.4},
    "exact": {"color": style.NAVY, "marker": "s", "markersize": 2.4, "markerfacecolor": "white"},
}
# both are of the wire model
STICKING_LINE: style.Look = {"color": style.RED, "lw": 2.4, "alpha": 0.5, "label": "sticking contact"}
FREE_LINE: style.Look = {"color": style.RED, "lw": 1.0, "ls": (0, (4, 2)), "label": "frictionless"}
TALLEST = 4.4  # in, of the springs
DETAIL = 1.0  # in, a side of an enlarged detail
ZOOM = 4.0  # mm shown across it
MARGIN = 0.6  # mm around the springs
BAR = 5.0  # mm, length of the scale
CIRCLES = (
    ("rest", "at rest", style.REST_CIRCLE),
    ("beam", style.BEAM_LABEL, style.BEAM_CIRCLE),
    ("wire", style.WIRE_LABEL, style.WIRE_CIRCLE),
)
LINES = {
    **{style.BEAM_LABEL: style.BEAM_LINE, style.WIRE_LABEL: style.WIRE_LINE},
    **{"difference with contact": DIFFERENCES["contact"], "difference without": DIFFERENCES["no_contact"]},
}


def tip_figure(data: pd.DataFrame) -> Figure:
    """Figure 5: tip displacements of Spring A above, the models' differences below."""
    figure = Figure(figsize=(style.DOUBLE, 4.1), layout="constrained")
    plots = figure.subplots(2, 3, sharex=True, height_ratios=(2.0, 1.0))
    load = data["load_N"].to_numpy()
    for letter, tip, label, (axes, below) in zip("abc", TIPS, TIP_LABELS, plots.T, strict=True):
        for tag in CONTACT:
            beam, wire = _curves(data, tip, tag)
            both(axes, (load, beam), (load, wire))
            _name(axes, tag, load, beam, upper=(tag == "contact") == (beam[-1] < 0.0))
            below.plot(load, 1e3 * _farther(beam, wire), **DIFFERENCES[tag])
        axes.set(ylabel=label, xlim=(0.0, load[-1]), title=f"({letter}) {label.split()[0]}")
        below.set(xlabel="load |F| (N)", ylabel=f"|beam| − |wire|\n({THOUSANDTHS[label.split()[1]]})")
        below.axhline(0.0, color="black", linewidth=0.5)
    _add_key(figure)
    return figure


def load_figure(data: pd.DataFrame) -> Figure:
    """Figure 7: load against deflection of Spring B, and the models' difference."""
    figure = Figure(figsize=(style.DOUBLE, 2.9), layout="constrained")
    left, right = figure.subplots(1, 2, width_ratios=(1.25, 1.0))
    load = data["load_N"].to_numpy()
    for tag in CONTACT:
        beam, wire = _curves(data, "uy_mm", tag)
        both(left, (-beam, load), (-wire, load))
        _name(left, tag, -beam, load, upper=tag == "contact")
        right.plot(load, _farther(beam, wire), **DIFFERENCES[tag])
    left.set(xlabel="deflection −UY (mm)", ylabel="load |Fy| (N)", title="(a) Load and deflection")
    left.set(xlim=(0.0, -data.filter(like="uy_mm").to_numpy().min()), ylim=(0.0, load[-1]))
    right.set(xlabel="load |Fy| (N)", ylabel="|beam| − |wire| (mm)", title="(b) Difference of the models")
    right.set(xlim=(0.0, load[-1]))
    right.axhline(0.0, color="black", linewidth=0.5)
    _add_key(figure)
    return figure


def iteration_figure(data: pd.DataFrame) -> Figure:
    """Figure 8: factorisations of the equivalent beam in every substep."""
    figure = Figure(figsize=(style.DOUBLE, 2.9), layout="constrained")
    for axes, letter in zip(figure.subplots(1, 2), "ab", strict=True):
        for end, words, dashes in (("", "contact", "-"), ("-no-contact", "no contact", DOTTED)):
            for tangent in TANGENTS:
                counts = data[f"spring-{letter}{end}_{tangent}_tangent"]
                look = COUNTS[tangent] | ({} if dashes == "-" else {"marker": ""})
                name = f"{words}, {tangent.replace('paper', 'paper’s')} tangent"
                look |= {"linestyle": dashes, "linewidth": 1.0, "clip_on": False}
                axes.plot(data["substep"], counts, **look, label=name)
        title = f"({letter}) Spring {letter.upper()}"
        axes.set(xlabel="substep", ylabel="iterations", xlim=(0, len(data)), ylim=(0, None), title=title)
    figure.legend(*axes.get_legend_handles_labels(), loc="outside lower center", ncols=2)
    return figure


CURVES = {"fig5": tip_figure, "fig7": load_figure, "fig8": iteration_figure}


def sliding_figure(sticking: EquilibriumPath, free: EquilibriumPath) -> Figure:
    """Wire model of Spring B without sliding, and frictionless as far as it goes."""
    figure = Figure(figsize=(style.SINGLE, 2.6), layout="constrained")
    axes = figure.subplots()
    for path, look in ((sticking, STICKING_LINE), (free, FREE_LINE)):
        axes.plot(np.append(0.0, -path.tips[:, 1]), np.append(0.0, -path.loads[:, 1]), **look)
    axes.plot(-free.tips[-1, 1], abs(free.loads[-1, 1]), "kx", markersize=6, label="last equilibrium")
    axes.set(xlabel="deflection −UY (mm)", ylabel="load |Fy| (N)", xlim=(0, None), ylim=(0, None))
    axes.legend(loc="upper left")
    return figure


def _curves(data: pd.DataFrame, tip: str, tag: str) -> tuple[np.ndarray, np.ndarray]:
    """A tip displacement of the equivalent beam and of the wire model."""
    return data[f"{tip}_{tag}_equivbeam"].to_numpy(), data[f"{tip}_{tag}_wirefe"].to_numpy()


def _farther(beam: np.ndarray, wire: np.ndarray) -> np.ndarray:
    """Beam minus wire model in magnitude, positive where the beam is softer.

    Over no peak: those with and without contact differ, and before contact the spring is the same.
    """
    return np.abs(beam) - np.abs(wire)


def _name(axes: Axes, tag: str, x: np.ndarray, y: np.ndarray, upper: bool) -> None:
    """A curve's name near its end, on its free side; `upper`: above the other curve."""
    left = upper == (y[-1] > y[0])
    place = (x[-8], y[-8]) if left else (x[-16], y[-16])
    away = (-5 if left else 4, 3 if upper else -3)
    text = axes.annotate(tag.replace("_", " "), place, xytext=away, textcoords="offset points", fontsize=7.0)
    text.set(ha="right" if left else "left", va="bottom" if upper else "top")


def _add_key(figure: Figure) -> None:
    key = [Line2D([], [], **look, label=label) for label, look in LINES.items()]
    figure.legend(handles=key, loc="outside lower center", ncols=4, columnspacing=1.2)


def space_figure(panels: tuple[Shapes, ...], rendered: list[Path] | str) -> Figure:
    """Picture in space, composed of the rendered panels, or painted here where there are none."""
    painted = isinstance(rendered, str)
    points = np.concatenate([getattr(panel, part) for panel in panels for part in PARTS])
    if painted:
        seen = points @ view().T
        low, high = seen.min(axis=0) - panels[0].diameter, seen.max(axis=0) + panels[0].diameter
        (width, height), unit = (high - low)[:2], 1.0  # mm
    else:
        pictures = _cropped([imread(file) for file in rendered])
        height, width = pictures[0].shape[:2]
        unit = PIXELS / (2.0 * picture_frame(points, panels[0].diameter)[1])  # pixels for a mm
    scale = min((0.5 * style.DOUBLE - 0.1) / width, TALLEST / height)  # in for a mm or a pixel
    figure = Figure(figsize=(style.DOUBLE, height * scale + 0.6))
    for index, panel in enumerate(panels):
        left = (0.5 * index + 0.25) * style.DOUBLE - 0.5 * width * scale
        axes = _inches(figure, left, 0.35, width * scale, height * scale)
        if painted:
            _paint(axes, panel, 72.0 * scale * panel.diameter)
            axes.set(xlim=(low[0], high[0]), ylim=(low[1], high[1]))
        else:
            axes.imshow(pictures[index], interpolation="antialiased", aspect="auto")
        axes.set_axis_off()
        axes.set_title(lettered(index, len(panels), panel.title), loc="left")
        _scale(figure, index, scale * unit)
    key = [
        Patch(color=style.BLUE, label=style.BEAM_LABEL),
        Patch(color=style.RED, label=f"{style.WIRE_LABEL}, alternating"),
        Line2D([], [], color=style.GREY, linewidth=0.7, label="at rest"),
    ]
    figure.legend(handles=key, loc="lower center", ncols=3)
    return figure


def _scale(figure: Figure, index: int, scale: float) -> None:
    """Directions of the axes and a length in the plane of the picture, below a panel; `scale` in in/mm."""
    axes = _inches(figure, 0.5 * style.DOUBLE * index + 0.05, 0.35, *2 * (2.0 * BAR * scale,))
    axes.set(xlim=(-0.6 * BAR, 1.4 * BAR), ylim=(-0.6 * BAR, 1.4 * BAR))
    axes.set_axis_off()
    for name, (x, y) in zip("XYZ", 0.35 * BAR * view()[:2].T, strict=True):
        axes.annotate("", (x, y), (0.0, 0.0), arrowprops={"arrowstyle": "->", "shrinkA": 0, "shrinkB": 0})
        axes.text(1.4 * x, 1.4 * y, name, ha="center", va="center", fontsize=7.0)
    axes.plot((-0.5 * BAR, 0.5 * BAR), (-0.5 * BAR,) * 2, color="black", linewidth=1.5)
    axes.text(0.0, -0.47 * BAR, f"{BAR:g} mm", ha="center", va="bottom", fontsize=7.0)


def _cropped(pictures: list[np.ndarray]) -> list[np.ndarray]:
    """The pictures without the white border that all of them share."""
    ink = np.any([picture[..., :3].min(axis=-1) < 0.99 for picture in pictures], axis=0)
    rows, columns = np.flatnonzero(ink.any(axis=1)), np.flatnonzero(ink.any(axis=0))
    window = slice(rows[0], rows[-1] + 1), slice(columns[0], columns[-1] + 1)
    return [picture[window] for picture in pictures]


def _paint(axes: Axes, panel: Shapes, width: float) -> None:
    """The wires from back to front as short strokes, the farther ones paler; `width` in points."""
    axes.plot(*(panel.rest @ view().T)[:, :2].T, color=style.GREY, linewidth=0.5, zorder=0)
    lines = [(piece @ view().T, style.BLUE) for piece in spaces(panel.beam)]
    lines += [(piece @ view().T, style.RED) for piece in bands(panel.wire)]
    strokes = np.concatenate([np.stack((line[:-1], line[1:]), axis=1) for line, _ in lines])
    tint = np.concatenate([np.tile(to_rgb(colour), (len(line) - 1, 1)) for line, colour in lines])
    depth = strokes[..., 2].mean(axis=1)
    order = np.argsort(depth)
    far = 0.45 * (depth.max() - depth) / np.ptp(depth)
    tint = tint + far[:, None] * (1.0 - tint)
    flat = list(strokes[order][..., :2])
    axes.add_collection(LineCollection(flat, colors=tint[order], linewidths=width, capstyle="round"))


def _inches(figure: Figure, left: float, bottom: float, width: float, height: float) -> Axes:
    """Axes placed in inches."""
    across, up = figure.get_size_inches()
    return figure.add_axes((left / across, bottom / up, width / across, height / up))


def plane_figure(panels: tuple[Shapes, ...]) -> Figure:
    """The contact circles of both models, to scale, with the place of most overlap enlarged."""
    every = np.concatenate([getattr(panel, f"{part}_circles") for panel in panels for part, *_ in CIRCLES])
    margin = 0.5 * panels[0].diameter + MARGIN
    low, high = every.min(axis=0) - margin, every.max(axis=0) + margin
    width, height = high - low
    scale = min((0.5 * style.DOUBLE - DETAIL - 0.65) / width, TALLEST / height)  # in/mm
    figure = Figure(figsize=(style.DOUBLE, height * scale + 1.05))
    for index, panel in enumerate(panels):
        left = 0.5 * style.DOUBLE * index + 0.45
        axes = _inches(figure, left, 0.75, width * scale, height * scale)
        _circles(axes, panel)
        axes.set(xlim=(low[0], high[0]), ylim=(low[1], high[1]), xlabel="X (mm)", ylabel="Y (mm)")
        axes.set_title(lettered(index, len(panels), panel.title), loc="left")
        detail = _inches(figure, left + width * scale + 0.1, 0.75, DETAIL, DETAIL)
        _detail(axes, detail, panel, panels[0])
    key = [Patch(**look, label=label) for _, label, look in (*CIRCLES[1:], CIRCLES[0])]
    figure.legend(handles=key, loc="lower center", ncols=3)
    return figure


def _circles(axes: Axes, panel: Shapes) -> None:
    """Circles of the wire's diameter around the three sets of centres."""
    for part, _, look in CIRCLES:
        discs(axes, getattr(panel, f"{part}_circles"), panel.diameter, **look)


def _detail(axes: Axes, detail: Axes, panel: Shapes, place: Shapes) -> None:
    """Enlarge where the coils of the panel `place` overlap most, and say by how much they do here."""
    worst = int(np.argmax(overlaps(place.wire_circles, place.diameter)))
    x, y = panel.wire_circles[worst : worst + 3 : 2].mean(axis=0) - 0.5 * ZOOM
    x, y = max(x, axes.get_xlim()[0]), max(y, axes.get_ylim()[0])
    _circles(detail, panel)
    detail.set(xlim=(x, x + ZOOM), ylim=(y, y + ZOOM), xticks=(), yticks=())
    detail.spines[:].set_visible(True)
    axes.add_patch(Rectangle((x, y), ZOOM, ZOOM, fill=False, edgecolor="black", linewidth=0.6))
    most = [overlaps(circles, panel.diameter).max() for circles in (panel.beam_circles, panel.wire_circles)]
    beam, wire = (f"{x:.2f} mm" if x >= 0.1 else f"{1e3 * x:.1f} µm" for x in most)
    note = f"largest overlap where\ncoils cross the plane\nbeam: {beam}\nwire model: {wire}"
    detail.text(0.0, 1.04, note, transform=detail.transAxes, ha="left", va="bottom", fontsize=7.0)
