"""The deforming wire in a window or as a GIF, drawn by a subprocess: VTK can end the one it runs in."""

import io
import os
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

from coilspring import InputError
from validation.study.files import TEMPORARY, write_bytes, writing
from validation.view.frames import Frames
from validation.view.process import Drawing

MOST_PICTURES = 60  # of a movie
PACE, LAST = 80, 1500  # ms, each picture and the last


def require(movie: Path | None) -> None:
    """Raise `InputError` for a movie that is no GIF, and without one where a window could not be opened."""
    if movie is not None:
        if movie.suffix.lower() != ".gif":
            raise InputError(f"--movie must be the name of a .gif file, got {str(movie)!r}")
    elif sys.platform.startswith("linux") and not any(map(os.environ.get, ("DISPLAY", "WAYLAND_DISPLAY"))):
        raise InputError("view needs a display, and there is none: --movie FILE.gif draws without one")


def show(load: Callable[[], Frames]) -> None:
    """Show what `load` gives in a window with a slider over the steps, until it is closed; `InputError` where
    it could not be opened."""
    with Drawing("window") as drawing:
        drawing.give(load())
        status = drawing.failure(None)
    if status:
        raise InputError(f"no window could be opened ({status}): --movie FILE.gif draws without one")


def film(load: Callable[[], Frames], movie: Path, progress: Callable[[str], None]) -> str:
    """Write a GIF of what `load` gives; a sentence where matplotlib had to draw it, else nothing."""
    from PIL import Image

    with Drawing("pictures") as drawing:
        frames = load()
        chosen = np.unique(np.linspace(0, len(frames.times) - 1, MOST_PICTURES).round().astype(int))
        frames = Frames(frames.diameter, frames.times[chosen], frames.points[chosen], frames.forces[chosen])
        drawing.give(frames)
        files = [drawing.folder / f"{i:04d}.png" for i in range(len(frames.times))]

        def announce(drawn: int) -> None:
            progress(f"drawing: {drawn} of {len(files)} pictures")

        announce(0)
        status = drawing.failure(60.0 + 5.0 * len(files), files, "it wrote no pictures", announce)
        if status:
            _draw_flat(frames, files)
        progress("writing the movie")
        *others, last = (Image.open(file).convert("RGB") for file in files)
    # in the colours of the last one, which has all of the scale: as many as a GIF holds
    colours = last.quantize(256, Image.Quantize.MAXCOVERAGE, dither=Image.Dither.NONE)
    pictures = [*(each.quantize(palette=colours, dither=Image.Dither.NONE) for each in others), colours]
    more: dict[str, Any] = {"append_images": pictures[1:], "duration": [PACE] * len(others) + [LAST]}
    stream = io.BytesIO()
    pictures[0].save(stream, "GIF", save_all=True, loop=0, optimize=False, **more)
    write_bytes(movie, stream.getvalue())
    return f"drawn by matplotlib: pyvista could not draw off screen ({status})" if status else ""


def _draw_flat(frames: Frames, files: list[Path]) -> None:
    """Pictures in the working plane, where OpenGL does not work."""
    from matplotlib.figure import Figure

    from validation.study.plots import to_scale

    every, touched = frames.points.reshape(-1, 3), frames.touched
    for time, points, forces, file in zip(frames.times, frames.points, frames.forces, files, strict=True):
        figure = Figure(figsize=(5.0, 6.0), dpi=100)
        axes = figure.add_subplot(title=f"time {time:.2f}")
        axes.plot(points[:, 0], points[:, 1], color="0.6", linewidth=3.0)
        if touched.size:
            x, y = points[touched, :2].T
            dots = axes.scatter(x, y, c=forces[touched], vmin=0.0, vmax=frames.forces.max(), zorder=3)
            figure.colorbar(dots, label="contact force (N)")
        to_scale(axes, every, frames.diameter)
        with writing(TEMPORARY):
            figure.savefig(file)
