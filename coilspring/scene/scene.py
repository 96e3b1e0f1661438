"""A scene: the physics of one experiment on one spring, and nothing of how it is solved."""

from __future__ import annotations

import math
from dataclasses import dataclass, field, replace

import numpy as np

from coilspring.errors import InputError, shown
from coilspring.scene.contact import Contact
from coilspring.scene.factors import Factors
from coilspring.scene.load import Load, stage_ends
from coilspring.scene.material import Material
from coilspring.scene.profile import SAME
from coilspring.scene.solidwire import FITTED
from coilspring.scene.spring import Spring
from coilspring.scene.supports import Supports


@dataclass(frozen=True)
class Scene:
    """What one experiment is made of; the factors are the equivalent beam's alone."""

    name: str
    spring: Spring
    load: Load
    material: Material = field(default_factory=Material)
    supports: Supports = field(default_factory=Supports)
    contact: Contact = field(default_factory=Contact)
    factors: Factors = field(default_factory=Factors)

    def __post_init__(self) -> None:
        if not isinstance(self.name, str) or not self.name.strip():
            raise InputError(f"name must be a text that is not empty, got {shown(self.name)}")
        low, high = FITTED
        if self.spring.wire_rigidity == "solid" and not low <= self.material.nu <= high:
            raise InputError(
                f"material.nu must be in [{low:g}, {high:g}] with spring.wire_rigidity = 'solid', "
                f"got {self.material.nu!r}"
            )
        if self.supports.seat == "plate":
            self._check_plates()
        if self.load.displacement:
            self._check_displacement()
            return
        ends = stage_ends(self.load)
        changes = np.any(np.diff(ends, axis=0) * self.supports.free, axis=1)
        if not changes.all():
            key = "load.stages" if self.load.stages else "load.force"
            force = tuple(ends[1:][~changes][0].tolist())
            raise InputError(
                f"{key} must change in a direction that is free, got {force!r} with "
                f"supports.top_held = {list(self.supports.top_held)!r}"
            )

    def _check_displacement(self) -> None:
        if "uy" in self.supports.top_held:
            raise InputError("supports.top_held must be without uy where load.displacement prescribes it")
        least = -self.spring.active_height
        for uy in self.load.displacement:
            if uy <= least:
                raise InputError(
                    f"load.displacement must be above {least:g}, where the top meets the bottom, got {uy!r}"
                )

    def _check_plates(self) -> None:
        """Refuse what would lift the spring off its plates, and a spring without end turns to lie there."""
        if self.spring.end_turns == 0.0:
            raise InputError("spring.end_turns must be in [0.5, 100] with supports.seat = 'plate', got 0")
        load = self.load
        axial = load.displacement or tuple(y for _, y in load.stages or (load.force,))
        if max(axial) >= 0.0:
            key = "displacement" if load.displacement else "stages" if load.stages else "force"
            raise InputError(
                f"load.{key} must press throughout with supports.seat = 'plate', whose plates do not pull: "
                f"along Y below 0, got {max(axial)!r}"
            )

    @property
    def direction(self) -> tuple[float, float]:
        """Direction (x, y) of the load where the top can move, of length 1.

        Raises
        ------
        InputError : stages load the top in several directions.
        """
        if self.load.displacement:
            return 0.0, math.copysign(1.0, max(self.load.displacement, key=abs))
        forces = (stage_ends(self.load)[1:] * self.supports.free).tolist()
        x, y = max(forces, key=lambda force: math.hypot(*force))
        size = math.hypot(x, y)
        if any(abs(a * y - b * x) > SAME * size * math.hypot(a, b) for a, b in forces):
            raise InputError("load.stages must be in one direction where force is taken over deflection")
        return x / size, y / size

    def without_contact(self) -> Scene:
        """The same scene with contact switched off."""
        return replace(self, contact=replace(self.contact, enabled=False))

    def with_steps(self, steps: int) -> Scene:
        """The same scene with another output grid."""
        return replace(self, load=replace(self.load, steps=steps))

    def with_penalty(self, stiffness: float) -> Scene:
        """The same scene with another contact stiffness K, N/mm^exponent."""
        return replace(self, contact=replace(self.contact, stiffness=stiffness))

    def overridden(
        self, steps: int | None = None, penalty: float | None = None, geometry: str | None = None
    ) -> Scene:
        """The scene with the number of steps, the penalty and the contact geometry a caller asked for."""
        scene = self if steps is None else self.with_steps(steps)
        scene = scene if penalty is None else scene.with_penalty(penalty)
        contact = scene.contact if geometry is None else replace(scene.contact, geometry=geometry)
        return replace(scene, contact=contact)


def load_directions(scene: Scene, times: np.ndarray) -> np.ndarray:
    """Directions in which the load grows on the free top at some times, shape (times, 2), of length 1."""
    grows = np.diff(stage_ends(scene.load), axis=0) * scene.supports.free
    grows /= np.linalg.norm(grows, axis=1)[:, None]
    stage = np.ceil(np.clip(times, 0.0, 1.0) * len(grows) - 1e-9).astype(int) - 1
    return grows[np.maximum(stage, 0)]


def require_scene(value: object) -> Scene:
    """Return `value`, or raise `InputError` unless it is a `Scene`."""
    if isinstance(value, Scene):
        return value
    raise InputError(
        f"scene must be a coilspring.Scene, got {shown(value)}; coilspring.load_scene makes one of a "
        "catalogue name or a file"
    )
