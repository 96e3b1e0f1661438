"""The command ``coilcheck``: parsing and printing; nothing below imports it."""

import sys
from collections.abc import Sequence

INTERRUPTED = 130


def main(argv: Sequence[str] | None = None) -> int:
    """Run the command line and return the exit code; it may be interrupted while it is imported, too."""
    try:
        from validation.cli.command import main as run
    except KeyboardInterrupt:
        print("coilcheck: interrupted", file=sys.stderr)
        return INTERRUPTED
    return run(argv)
