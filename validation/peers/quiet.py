"""Silence for OpenSees, which prints from C++ and past Python."""

from __future__ import annotations

import atexit
import os
import sys
from collections.abc import Iterator
from contextlib import contextmanager


@contextmanager
def quiet() -> Iterator[None]:
    """Send what OpenSees prints, from C++ and past Python, nowhere."""
    sys.stdout.flush()
    sys.stderr.flush()
    kept = os.dup(1), os.dup(2)
    try:
        silence()
        yield
    finally:
        sys.stdout.flush()
        sys.stderr.flush()
        for copy, stream in zip(kept, (1, 2), strict=True):
            os.dup2(copy, stream)
            os.close(copy)


def silence() -> None:
    """Send standard output and error nowhere."""
    nowhere = os.open(os.devnull, os.O_WRONLY)
    os.dup2(nowhere, 1)
    os.dup2(nowhere, 2)
    os.close(nowhere)


atexit.register(silence)  # OpenSees says good-bye when the interpreter ends
