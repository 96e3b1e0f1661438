"""What all figures are drawn and written with."""

import io
from contextlib import AbstractContextManager
from string import ascii_lowercase
from typing import Any

import matplotlib
import numpy as np
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.backends.backend_svg import FigureCanvasSVG
from matplotlib.collections import EllipseCollection
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator
from PIL import Image

from validation.study.style import BEAM_LINE, RC, WIRE_LINE, Look

COLOURS = 256  # of a stored picture; keeps the files small, and is off by a few levels of 255
FEW = 12  # steps of a curve whose points are marked
NARROW = 0.35  # width over height of a picture to scale that has room for few labels


def styled(**more: Any) -> AbstractContextManager[None]:
    """For a block that draws and writes figures: the common style and `more` of matplotlib's settings."""
    return matplotlib.rc_context(RC | more)


def png(figure: Figure, exact: bool = False) -> bytes:
    """A figure as PNG; `exact`: in all its colours, where a colour is a value."""
    canvas = FigureCanvasAgg(figure)
    canvas.draw()
    picture = Image.fromarray(np.asarray(canvas.buffer_rgba())).convert("RGB")
    if not exact:
        picture = picture.quantize(COLOURS, Image.Quantize.MAXCOVERAGE, dither=Image.Dither.NONE)
    stream = io.BytesIO()
    picture.save(stream, format="png", dpi=(figure.dpi, figure.dpi), optimize=exact)
    return stream.getvalue()


def svg(figure: Figure, salt: str) -> bytes:
    """A figure as SVG, the same for the same drawing; `salt` keeps its marks apart from other figures'."""
    stream = io.BytesIO()
    names: Any = {"svg.hashsalt": salt}
    with matplotlib.rc_context(names):
        FigureCanvasSVG(figure).print_svg(stream, metadata={"Date": None})
    return stream.getvalue()


def drawn(figure: Figure, name: str, exact: bool = False) -> dict[str, bytes]:
    """Files of a figure by name: PNG for Markdown, SVG for HTML; `exact` as of `png`."""
    return {f"{name}.png": png(figure, exact), f"{name}.svg": svg(figure, name)}


def discs(axes: Axes, centres: np.ndarray, diameter: float, **look: Any) -> None:
    """Circles to scale around centres (n, 2)."""
    size = np.full(1, diameter)
    placed = {"offsets": centres, "offset_transform": axes.transData} | look
    axes.add_collection(EllipseCollection(size, size, 0.0, units="xy", **placed))


def to_scale(axes: Axes, centres: np.ndarray, margin: float, **more: Any) -> None:
    """The working plane to scale, around centres (n, 2 or more) with a margin; `more` of `Axes.set`."""
    (left, low), (right, high) = centres.min(axis=0)[:2] - margin, centres.max(axis=0)[:2] + margin
    axes.set(aspect="equal", xlim=(left, right), ylim=(low, high), xlabel="X (mm)", ylabel="Y (mm)", **more)
    axes.grid(False)
    if right - left < NARROW * (high - low):  # so that labels do not run into each other
        axes.xaxis.set_major_locator(MaxNLocator(2))


def both(axes: Axes, beam: tuple[np.ndarray, np.ndarray], wire: tuple[np.ndarray, np.ndarray]) -> None:
    """Curves of both models, from the unloaded spring on."""
    for (x, y), style in ((beam, BEAM_LINE), (wire, WIRE_LINE)):
        if len(x):
            axes.plot(np.append(0.0, x), np.append(0.0, y), **marked(style, len(x)))


def lettered(index: int, count: int, title: str) -> str:
    """Title of one of several panels, with its letter; a sole one needs none."""
    return f"({ascii_lowercase[index % 26]}) {title}" if count > 1 else title


def marked(look: Look, steps: int) -> Look:
    """Look of a curve, with marks where it has so few steps that most of it is lines between them."""
    return look | ({"marker": "o", "markersize": look["linewidth"] + 2.0} if steps <= FEW else {})
