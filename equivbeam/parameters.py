"""Numbers of a spring and of its model by name, as sensitivities and calibration change them."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from operator import attrgetter
from typing import Any, NamedTuple

import numpy as np

from coilspring.errors import require_choice
from coilspring.scene import Scene
from coilspring.scene.material import Material


class Parameter(NamedTuple):
    """A number of a part of the scene."""

    part: str
    read: Callable[[Any], float]
    changed: Callable[[Any, float], Any]  # the part that has another value


FACTORS = ("axial", "shearing", "bending")  # of the paper's stiffnesses


def _field(part: str, name: str) -> Parameter:
    return Parameter(part, attrgetter(name), lambda of, value: replace(of, **{name: value}))


def _diameter(read: Callable, ends: Callable) -> Parameter:
    """A number read from the mean diameters at bottom and top, and these where it has another value."""
    return Parameter(
        "spring",
        lambda spring: read(*spring.mean_diameter),
        lambda spring, value: replace(spring, mean_diameter=ends(value, *spring.mean_diameter)),
    )


def _widened(value: float, bottom: float, top: float) -> tuple[float, float]:
    """Both diameters by the same factor, so that their mean is the value."""
    share = 2.0 * value / (bottom + top)
    return share * bottom, share * top


PARAMETERS: Mapping[str, Parameter] = {
    "wire_diameter": _field("spring", "wire_diameter"),
    "mean_diameter": _diameter(lambda bottom, top: 0.5 * (bottom + top), _widened),
    "bottom_diameter": _diameter(lambda bottom, top: bottom, lambda value, bottom, top: (value, top)),
    "top_diameter": _diameter(lambda bottom, top: top, lambda value, bottom, top: (bottom, value)),
    "pitch": Parameter(
        "spring",
        attrgetter("pitch"),
        lambda spring, pitch: replace(spring, active_height=pitch * spring.active_coils),
    ),
    "E": Parameter("material", attrgetter("E"), lambda of, E: Material.from_moduli(E, of.G, of.density)),
    "G": Parameter("material", attrgetter("G"), lambda of, G: Material.from_moduli(of.E, G, of.density)),
    "penalty": _field("contact", "stiffness"),
    "exponent": _field("contact", "exponent"),
    **{name: _field("factors", name) for name in FACTORS},
}
NAMES = tuple(PARAMETERS)


def values(scene: Scene, names: tuple[str, ...]) -> np.ndarray:
    """Values of the parameters named; `InputError` for a name that is none of `NAMES`."""
    for name in names:
        require_choice("parameters", name, NAMES)
    wanted = (PARAMETERS[name] for name in names)
    return np.array([each.read(getattr(scene, each.part)) for each in wanted])


def varied(scene: Scene, names: tuple[str, ...], new: np.ndarray) -> Scene:
    """The scene with other values of the parameters named."""
    for name, value in zip(names, new.tolist(), strict=True):
        part, _, changed = PARAMETERS[name]
        scene = replace(scene, **{part: changed(getattr(scene, part), value)})
    return scene


def rise(scene: Scene, name: str) -> float:
    """Change of the height at rest, from where displacements are counted, with a parameter."""
    return scene.spring.active_coils if name == "pitch" else 0.0
