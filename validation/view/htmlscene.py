"""The springs of Figures 4 and 6 in one HTML file, to be turned in a browser: pyvista's vtk.js export."""

from __future__ import annotations

import importlib.util
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from coilspring import InputError
from validation.study.style import BLUE, GREY, RED
from validation.view.process import Drawing, given
from validation.view.render3d import add_spring
from validation.view.shapes import Shapes

if TYPE_CHECKING:
    import pyvista

FILE = "springs.html"
NEEDED = ("trame_pyvista", "nest_asyncio2")
MISSING = "--interactive needs {}, which is missing: pip install -e '.[interactive]'"
TITLE = "Springs of Figures 4 and 6 at full load, by both models"
COMMAND = (sys.executable, "-m", "validation.view.htmlscene")
SIGNATURE = "<!-- coilcheck {} -->\n"  # last line of the file, with what it was made from
TIMEOUT = 120.0  # s; it takes a few
GAP, LETTER = 6.0, 1.6  # mm between springs; height of the words
EYE = (0.12, 0.3, 1.4)  # from where it is seen at first, over the width of what is seen
SIDES = 16  # of a tube; the file grows with it
KEY = (("equivalent beam", BLUE), ("wire model, alternating", RED), ("at rest", GREY))


def require_extra() -> None:
    """Raise `InputError` where the extra is not installed."""
    for name in NEEDED:
        if importlib.util.find_spec(name) is None:
            raise InputError(MISSING.format(name.replace("_", "-")))


def is_made(folder: Path, mark: str) -> bool:
    """Whether the file in a folder is there, and was made from what `mark` stands for."""
    file = folder / FILE
    return file.is_file() and file.read_bytes().endswith(SIGNATURE.format(mark).encode())


def page(panels: Sequence[Shapes], mark: str) -> bytes | str:
    """The page of springs side by side, which `is_made` knows by its `mark`; or in a few words why not."""
    with Drawing(COMMAND) as drawing:
        drawing.give(panels)
        file = drawing.folder / FILE
        trouble = drawing.failure(TIMEOUT, [file])
        if trouble:
            return trouble
        text = file.read_text(encoding="utf-8")
    head, _, rest = text.partition("<title>")  # of the viewer
    return f"{head}<title>{TITLE}{rest[rest.index('</title>') :]}\n{SIGNATURE.format(mark)}".encode()


def main(folder: Path) -> None:
    """Export the panels given in `folder`; what the subprocess runs."""
    import pyvista

    # a viewer that is not used, but would be downloaded
    sys.modules["trame.widgets.vtklocal"] = None  # type: ignore[assignment]
    plotter = pyvista.Plotter(off_screen=True, window_size=[1200, 800])
    plotter.set_background("white")
    low, high = _springs(plotter, given(folder))
    for i, (words, colour) in enumerate(KEY):
        place = low[0] + (i + 0.5) / len(KEY) * (high[0] - low[0])
        _write(plotter, words, place, low[1] - 5.0 * LETTER, colour)
    camera = plotter.camera
    camera.focal_point = 0.5 * (low + high) - (0.0, 3.0 * LETTER, 0.0)
    camera.position = camera.focal_point + (high[0] - low[0]) * np.array(EYE)
    camera.up = (0.0, 1.0, 0.0)
    plotter.trame.export_html(folder / FILE)


def _springs(plotter: pyvista.Plotter, panels: Sequence[Shapes]) -> tuple[np.ndarray, np.ndarray]:
    """Springs side by side with their names below; corners of the box that holds them."""
    springs = [np.concatenate(panel.parts) for panel in panels]
    lows, highs = (np.array([bound(points, axis=0) for points in springs]) for bound in (np.min, np.max))
    widths = (highs - lows)[:, 0]
    lefts = np.cumsum(widths + GAP) - widths - GAP
    low = lows.min(axis=0)
    for panel, move in zip(panels, lefts - lows[:, 0], strict=True):
        moved = [part + np.array((move, 0.0, 0.0)) for part in panel.parts]
        add_spring(plotter, moved, panel.diameter, SIDES)
        _write(plotter, panel.spring, moved[0][:, 0].mean(), low[1] - 2.0 * LETTER, "black")
    low[0], high = 0.0, highs.max(axis=0)
    high[0] = lefts[-1] + widths[-1]
    return low, high


def _write(plotter: pyvista.Plotter, words: str, centre: float, top: float, colour: str) -> None:
    """Words in the working plane."""
    import pyvista

    text = pyvista.Text3D(words, height=LETTER, depth=0.05, center=(centre, top - 0.5 * LETTER, 0.0))
    plotter.add_mesh(text, color=colour, lighting=False)


if __name__ == "__main__":
    main(Path(sys.argv[1]))
