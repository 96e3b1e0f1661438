"""The springs of Figures 4 and 6 in one HTML file, to be turned in a browser: pyvista's vtk.js export."""

import importlib.util
from collections.abc import Sequence
from pathlib import Path

from coilspring import InputError
from validation.view.process import Drawing
from validation.view.shapes import Shapes

FILE = "springs.html"
NEEDED = ("trame_pyvista", "nest_asyncio2")
MISSING = "--interactive needs {}, which is missing: pip install -e '.[interactive]'"
TITLE = "Springs of Figures 4 and 6 at full load, by both models"
SIGNATURE = "<!-- coilcheck {} -->\n"  # last line of the file, with what it was made from
TIMEOUT = 120.0  # s; it takes a few


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
    with Drawing("scene") as drawing:
        drawing.give(panels)
        file = drawing.folder / FILE
        trouble = drawing.failure(TIMEOUT, [file])
        if trouble:
            return trouble
        text = file.read_text(encoding="utf-8")
    head, _, rest = text.partition("<title>")  # of the viewer
    return f"{head}<title>{TITLE}{rest[rest.index('</title>') :]}\n{SIGNATURE.format(mark)}".encode()
