"""The machine that numbers come from, and the versions they were made by."""

import os
import platform
import re
import time
from functools import cache
from importlib import metadata
from pathlib import Path

PACKAGES = ("numpy", "numba", "scipy", "coilcheck")


def versions(*packages: str) -> dict[str, str | None]:
    """Versions of Python, of the packages behind all numbers and of others; None where not installed."""
    return {"python": platform.python_version(), **{name: _version(name) for name in (*PACKAGES, *packages)}}


@cache
def _version(package: str) -> str | None:
    try:
        return metadata.version(package)
    except metadata.PackageNotFoundError:  # run from a checkout
        return None


def machine() -> dict[str, str]:
    """Processor, cores, system, date and versions, as the report states them."""
    used = ", ".join(f"{name} {metadata.version(name)}" for name in ("numpy", "scipy", "numba"))
    return {
        "processor": _processor(),
        "cores": str(len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count()),
        "system": platform.system(),
        "versions": f"Python {platform.python_version()}, {used}",
        "date": time.strftime("%Y-%m-%d"),
    }


def timed_on() -> list[str]:
    """What stored times are good for: processor, cores and system."""
    here = machine()
    return [here[name] for name in ("processor", "cores", "system")]


@cache
def _processor() -> str:
    """Name of the processor, and the kind that code is compiled for: virtual machines give several one name.

    Only Linux has the name in a file.
    """
    from llvmlite.binding import get_host_cpu_name  # is slow to import

    listing = Path("/proc/cpuinfo")
    text = listing.read_text(encoding="utf-8", errors="replace") if listing.is_file() else ""
    named = re.search(r"^model name.*?:(.*)", text, re.MULTILINE)
    name = named[1].strip() if named else platform.processor() or platform.machine()
    return f"{name} ({get_host_cpu_name()})"
