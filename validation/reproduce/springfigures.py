"""Figures 4 and 6: deformed springs, in space and in the working plane."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection
from matplotlib.colors import to_rgb
from matplotlib.figure import Figure
from matplotlib.image import imread
from matplotlib.lines import Line2D
from matplotlib.patches import Patch, Rectangle

from validation.study import style
from validation.study.plots import discs
from validation.view.render3d import PIXELS
from validation.view.shapes import PARTS, Shapes, bands, overlaps, picture_frame, spaces, view

TALLEST = 4.4  # in, of the springs
DETAIL = 1.0  # in, a side of an enlarged detail
ZOOM = 4.0  # mm shown across it
MARGIN = 0.6  # mm around the springs
BAR = 5.0  # mm, length of the scale


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
        axes.set_title(f"({'ab'[index]}) {panel.title}", loc="left")
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
    every = np.concatenate([c for p in panels for c in (p.rest_circles, p.beam_circles, p.wire_circles)])
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
        axes.set_title(f"({'ab'[index]}) {panel.title}", loc="left")
        detail = _inches(figure, left + width * scale + 0.1, 0.75, DETAIL, DETAIL)
        _detail(axes, detail, panel, panels[0])
    key = [
        Patch(**style.BEAM_CIRCLE, label=style.BEAM_LABEL),
        Patch(**style.WIRE_CIRCLE, label=style.WIRE_LABEL),
        Patch(**style.REST_CIRCLE, label="at rest"),
    ]
    figure.legend(handles=key, loc="lower center", ncols=3)
    return figure


def _circles(axes: Axes, panel: Shapes) -> None:
    """Circles of the wire's diameter around the three sets of centres."""
    discs(axes, panel.rest_circles, panel.diameter, **style.REST_CIRCLE)
    discs(axes, panel.beam_circles, panel.diameter, **style.BEAM_CIRCLE)
    discs(axes, panel.wire_circles, panel.diameter, **style.WIRE_CIRCLE)


def _detail(axes: Axes, detail: Axes, panel: Shapes, place: Shapes) -> None:
    """Enlarge where the coils of the panel `place` overlap most, and say by how much they do here."""
    worst = int(np.argmax(overlaps(place.wire_circles, place.diameter)))
    x, y = panel.wire_circles[worst : worst + 3 : 2].mean(axis=0) - 0.5 * ZOOM
    x, y = max(x, axes.get_xlim()[0]), max(y, axes.get_ylim()[0])
    _circles(detail, panel)
    detail.set(xlim=(x, x + ZOOM), ylim=(y, y + ZOOM), xticks=(), yticks=())
    detail.spines[:].set_visible(True)
    axes.add_patch(Rectangle((x, y), ZOOM, ZOOM, fill=False, edgecolor="black", linewidth=0.6))
    beam, wire = (
        _length(overlaps(c, panel.diameter).max()) for c in (panel.beam_circles, panel.wire_circles)
    )
    note = f"largest overlap where\ncoils cross the plane\nbeam: {beam}\nwire model: {wire}"
    detail.text(0.0, 1.04, note, transform=detail.transAxes, ha="left", va="bottom", fontsize=7.0)


def _length(value: float) -> str:
    return f"{value:.2f} mm" if value >= 0.1 else f"{1e3 * value:.1f} µm"
