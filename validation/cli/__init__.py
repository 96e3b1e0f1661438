"""The command ``coilcheck``: parsing and printing; nothing below imports it."""

from validation.cli.command import main

__all__ = ["main"]
