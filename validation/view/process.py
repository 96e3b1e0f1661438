"""Drawing in a subprocess: VTK can end the one it runs in, and graphics drivers can hang."""

from __future__ import annotations

import subprocess
import time
from collections.abc import Sequence
from pathlib import Path


class Subprocess:
    """A command whose output is dropped; as a context it is ended where it still runs."""

    def __init__(self, command: Sequence[str]) -> None:
        self._process: subprocess.Popen | None = None
        self._failure = ""
        self._began = time.monotonic()
        try:
            self._process = subprocess.Popen(
                command,
                cwd=Path(__file__).parents[2],  # `-m` finds the package there, installed or not
                stdin=subprocess.DEVNULL,
                stdout=subprocess.DEVNULL,
                stderr=subprocess.DEVNULL,
            )
        except OSError as error:
            self._failure = f"it could not be started ({error.strerror or error})"

    def failure(self, timeout: float | None) -> str:
        """In a few words why it failed, empty where it did not; `timeout` in seconds since its start."""
        if self._process is None:
            return self._failure
        left = None if timeout is None else max(0.0, timeout - (time.monotonic() - self._began))
        try:
            status = self._process.wait(left)
        except subprocess.TimeoutExpired:
            return f"it took longer than {timeout:g} s"
        return f"it ended with status {status}" if status else ""

    def __enter__(self) -> Subprocess:
        return self

    def __exit__(self, *error: object) -> None:
        if self._process is not None:
            self._process.kill()
            self._process.wait()


def run(command: Sequence[str], timeout: float | None) -> str:
    """Run a command, and wait; in a few words why it failed, empty where it did not.

    Parameters
    ----------
    command : whose output is dropped.
    timeout : s; None waits for ever.
    """
    with Subprocess(command) as process:
        return process.failure(timeout)
