"""Drawing in a subprocess: VTK can end the one it runs in, and graphics drivers can hang."""

import pickle
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Sequence
from contextlib import ExitStack, suppress
from pathlib import Path
from typing import Any, Self

from validation.study.files import ROOT, TEMPORARY, writing

COMMAND = (sys.executable, "-m", "validation.view.pictures")
GIVEN = "given.pickle"
POLL = 0.05  # s, between looks at what a drawing has written


class Drawing(ExitStack):
    """`COMMAND`, which draws, and whose output is dropped; as a context it cleans up after itself.

    Its arguments are a folder, which takes what is drawn, and `what` that is: panels, a scene, a window or
    pictures. It starts at once, and waits for what is to be drawn (`give`).
    """

    def __init__(self, what: str) -> None:
        super().__init__()
        with writing(TEMPORARY):
            self.folder = Path(self.enter_context(tempfile.TemporaryDirectory(prefix="coilcheck-")))
        self._process: subprocess.Popen | None = None
        self._failure = ""
        try:
            process = subprocess.Popen(
                (*COMMAND, str(self.folder), what),
                cwd=ROOT,  # `-m` finds the package there, installed or not
                stdin=subprocess.PIPE,  # which ends when all is there that is to be drawn
                stdout=subprocess.DEVNULL,
                stderr=subprocess.DEVNULL,
            )
        except OSError as error:
            self._failure = f"it could not be started ({error.strerror or error})"
        else:
            self._process = self.enter_context(process)
            self.callback(process.kill)  # before it is waited for

    def give(self, drawn: object) -> Self:
        """Hand over what is to be drawn; `OutputError` where there is no room for it."""
        with writing(TEMPORARY):
            (self.folder / GIVEN).write_bytes(pickle.dumps(drawn))
        if self._process is not None and self._process.stdin is not None:
            self._process.stdin.close()
        self._began = time.monotonic()
        return self

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


def given(folder: Path) -> Any:
    """What a drawing was given, in a folder that is this user's alone; waited for."""
    sys.stdin.read()
    return pickle.loads((folder / GIVEN).read_bytes())
