"""2D equivalent beam on the spring axis, after Haringx, with contact between the coils' circles."""

from equivbeam.solve import solve

__all__ = ["solve"]
