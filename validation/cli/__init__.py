"""The command ``coilcheck``: parsing and printing; nothing below imports it."""

from validation.cli.cli import main

__all__ = ["main"]
