"""Whether the springs that can be turned in a browser are there, or can be made; light to import."""

from __future__ import annotations

import importlib.util
from pathlib import Path

from coilspring import InputError

FILE = "springs.html"
NEEDED = ("trame_pyvista", "nest_asyncio2")
MISSING = "--interactive needs {}, which is missing: pip install -e '.[interactive]'"


def require_extra() -> None:
    """Raise `InputError` where the extra is not installed."""
    for name in NEEDED:
        if importlib.util.find_spec(name) is None:
            raise InputError(MISSING.format(name.replace("_", "-")))


def signature(mark: str) -> bytes:
    """Last line of the file; `mark` stands for what it was made from."""
    return f"<!-- coilcheck {mark} -->\n".encode()


def is_made(folder: Path, mark: str) -> bool:
    """Whether the file in a folder is there, and was made from what `mark` stands for."""
    file = folder / FILE
    return file.is_file() and file.read_bytes().endswith(signature(mark))
