"""Drawing in a subprocess: VTK can end the one it runs in, and graphics drivers can hang."""

from __future__ import annotations

import subprocess
import tempfile
import time
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Self

import numpy as np

ARRAYS = "arrays.npz"


class Drawing:
    """A command that draws arrays, and whose output is dropped; as a context it cleans up after itself.

    Parameters
    ----------
    command : given a folder, which holds the arrays and takes what is drawn, and further `words`.
    arrays : by name.
    """

    def __init__(self, command: Sequence[str], arrays: Mapping[str, object], *words: str) -> None:
        self._temporary = tempfile.TemporaryDirectory(prefix="coilcheck-")
        self.folder = Path(self._temporary.name)
        np.savez(self.folder / ARRAYS, **arrays)  # type: ignore[arg-type]
        self._process: subprocess.Popen | None = None
        self._failure = ""
        self._began = time.monotonic()
        try:
            self._process = subprocess.Popen(
                (*command, str(self.folder), *words),
                cwd=Path(__file__).parents[2],  # `-m` finds the package there, installed or not
                stdin=subprocess.DEVNULL,
                stdout=subprocess.DEVNULL,
                stderr=subprocess.DEVNULL,
            )
        except OSError as error:
            self._failure = f"it could not be started ({error.strerror or error})"

    def failure(
        self, timeout: float | None, files: Sequence[Path] = (), missing: str = "it wrote no file"
    ) -> str:
        """In a few words why it failed, empty where it did not and the files are there; waited for.

        Parameters
        ----------
        timeout : s since its start; None waits for ever.
        """
        if self._process is None:
            return self._failure
        left = None if timeout is None else max(0.0, timeout - (time.monotonic() - self._began))
        try:
            status = self._process.wait(left)
        except subprocess.TimeoutExpired:
            return f"it took longer than {timeout:g} s"
        if status:
            return f"it ended with status {status}"
        return "" if all(file.is_file() for file in files) else missing

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *error: object) -> None:
        if self._process is not None:
            self._process.kill()
            self._process.wait()
        self._temporary.cleanup()


def arrays(folder: Path) -> dict[str, np.ndarray]:
    """Arrays that a drawing was given, by name."""
    with np.load(folder / ARRAYS) as stored:
        return dict(stored)
