"""Factors of the equivalent beam's stiffnesses, as a calibration finds them for one spring."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import astuple, dataclass

from coilspring.errors import InputError, shown
from coilspring.scene.schema import keep_checked


@dataclass(frozen=True)
class Factors:
    """Factors of the paper's three stiffnesses of a half coil; the wire model has no use for them."""

    axial: float = 1.0
    shearing: float = 1.0
    bending: float = 1.0

    def __post_init__(self) -> None:
        keep_checked(self, "factors")

    @classmethod
    def of(cls, three: Sequence[float]) -> Factors:
        """Factors of three numbers: axial, shearing, bending."""
        if not isinstance(three, list | tuple) or len(three) != 3:
            raise InputError(f"factors must be three numbers, got {shown(three)}")
        return cls(*three)

    @property
    def given(self) -> bool:
        """Whether one of them is not 1."""
        return astuple(self) != (1.0, 1.0, 1.0)
