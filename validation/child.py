"""Drawing in a process of its own: VTK can end the one it runs in, and graphics drivers can hang."""

from __future__ import annotations

import subprocess
from collections.abc import Sequence
from pathlib import Path


def run(command: Sequence[str], timeout: float | None) -> str:
    """Run a command, and wait; in a few words why it failed, empty where it did not.

    Parameters
    ----------
    command : whose output is dropped.
    timeout : s; None waits for ever.
    """
    try:
        done = subprocess.run(
            command,
            cwd=Path(__file__).parents[1],  # `-m` finds the package there, installed or not
            stdin=subprocess.DEVNULL,
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
            timeout=timeout,
            check=False,
        )
    except subprocess.TimeoutExpired:
        return f"it took longer than {timeout:g} s"
    except OSError as error:
        return f"it could not be started ({error.strerror or error})"
    return f"it ended with status {done.returncode}" if done.returncode else ""
