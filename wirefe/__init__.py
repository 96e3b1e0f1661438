"""3D beam-FE model of the coiled wire with sphere-to-sphere contact: the reference."""

from wirefe.solve import solve

__all__ = ["solve"]
