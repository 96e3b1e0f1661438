"""The command ``coilcheck``: parsing and printing; nothing below imports it."""

import signal
import sys
from collections.abc import Iterator, Sequence
from contextlib import contextmanager

INTERRUPTED = 130


def main(argv: Sequence[str] | None = None) -> int:
    """Run the command line and return the exit code; it may be interrupted while it is imported, too."""
    try:
        with _interruption_held():
            from validation.cli.command import main as run
        return run(argv)
    except KeyboardInterrupt:
        print("coilcheck: interrupted", file=sys.stderr)
        return INTERRUPTED


@contextmanager
def _interruption_held() -> Iterator[None]:
    """Let Ctrl-C wait for the end of the block: numpy, interrupted in its import, says that it is broken."""
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)
