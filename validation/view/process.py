"""Drawing in a subprocess: VTK can end the one it runs in, and graphics drivers can hang."""

from __future__ import annotations

import pickle
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Sequence
from contextlib import suppress
from pathlib import Path
from typing import Any, Self

GIVEN = "given.pickle"
POLL = 0.05  # s, between looks at what a drawing has written


class Drawing:
    """A command that draws, and whose output is dropped; as a context it cleans up after itself.

    Its arguments are a folder, which takes what is drawn, and `words`; it starts at once, and waits for what
    is to be drawn (`give`).
    """

    def __init__(self, command: Sequence[str], *words: str) -> None:
        self._temporary = tempfile.TemporaryDirectory(prefix="coilcheck-")
        self.folder = Path(self._temporary.name)
        self._process: subprocess.Popen | None = None
        self._failure = ""
        try:
            self._process = subprocess.Popen(
                (*command, str(self.folder), *words),
                cwd=Path(__file__).parents[2],  # `-m` finds the package there, installed or not
                stdin=subprocess.PIPE,  # which ends when all is there that is to be drawn
                stdout=subprocess.DEVNULL,
                stderr=subprocess.DEVNULL,
            )
        except OSError as error:
            self._failure = f"it could not be started ({error.strerror or error})"

    def give(self, drawn: object) -> None:
        """Hand over what is to be drawn."""
        (self.folder / GIVEN).write_bytes(pickle.dumps(drawn))
        self._end_input()
        self._began = time.monotonic()

    def _end_input(self) -> None:
        if self._process is not None and self._process.stdin is not None:
            with suppress(BrokenPipeError):
                self._process.stdin.close()

    def failure(
        self,
        timeout: float | None,
        files: Sequence[Path] = (),
        missing: str = "it wrote no file",
        written: Callable[[int], None] = lambda count: None,
    ) -> str:
        """In a few words why it failed, empty where it did not and the files are there; waited for.

        At most `timeout` s since it was given all (None: for ever), with `written` called with the number of
        files that are there, whenever it has changed.
        """
        if self._process is None:
            return self._failure
        count = 0
        while self._process.poll() is None:
            if timeout is not None and time.monotonic() - self._began > timeout:
                return f"it took longer than {timeout:g} s"
            with suppress(subprocess.TimeoutExpired):
                self._process.wait(POLL)
            before, count = count, sum(file.is_file() for file in files)
            if count != before:
                written(count)
        if self._process.returncode:
            return f"it ended with status {self._process.returncode}"
        return "" if all(file.is_file() for file in files) else missing

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *error: object) -> None:
        if self._process is not None:
            self._process.kill()
            self._process.wait()
        self._end_input()
        self._temporary.cleanup()


def given(folder: Path) -> Any:
    """What a drawing was given; waited for."""
    sys.stdin.read()
    return pickle.loads((folder / GIVEN).read_bytes())
