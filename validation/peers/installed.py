"""OpenSees where it is installed."""

from __future__ import annotations

from types import ModuleType

MISSING = (
    "openseespy is missing or cannot be loaded: pip install -e '.[peers]' and, on Debian, "
    "apt-get install libblas3 liblapack3"
)


def opensees() -> ModuleType | None:
    """`validation.peers.opensees`; None where openseespy is missing or cannot be loaded."""
    try:
        import validation.peers.opensees as module
    except (ImportError, RuntimeError):  # the latter where its libraries are missing
        return None
    return module
