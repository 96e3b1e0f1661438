"""Compiled kernels that are older than their sources, which the on-disk cache would still serve.

The cache compares a kernel with its own file alone and knows nothing of the kernels it calls, so that an
edited law would be judged by what it was before.
"""

from __future__ import annotations

import sys
from functools import cache
from pathlib import Path

import coilspring
import equivbeam
import wirefe
from validation.warmup import warm_up

PACKAGES = (coilspring, equivbeam, wirefe)


@cache
def make_ready() -> None:
    """Make both models' kernels ready, once in a process, compiled from the sources as they are now."""
    forget_stale_kernels()
    warm_up()


def forget_stale_kernels() -> int:
    """Remove cached kernels that are older than any source of the packages; returns how many files."""
    newest = max(source.stat().st_mtime for source in _sources())
    stale = [file for folder in _folders() for file in folder.glob("*.nb[ic]") if _age(file) < newest]
    for file in stale:
        file.unlink(missing_ok=True)
    return len(stale)


def _sources() -> list[Path]:
    return [source for package in PACKAGES for source in Path(str(package.__file__)).parent.glob("*.py")]


def _folders() -> set[Path]:
    """Where the kernels of the modules loaded so far are cached."""
    names = tuple(package.__name__ for package in PACKAGES)
    modules = [module for name, module in sys.modules.items() if name.partition(".")[0] in names]
    found = [getattr(value, "stats", None) for module in modules for value in list(vars(module).values())]
    places = [getattr(stats, "cache_path", None) for stats in found]
    return {Path(place) for place in places if place}


def _age(file: Path) -> float:
    """Time of the last change; a file that has gone meanwhile is not stale."""
    try:
        return file.stat().st_mtime
    except FileNotFoundError:
        return float("inf")
