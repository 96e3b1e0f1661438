"""Numbers of a spring and of its model by name, as sensitivities and calibration change them."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np

from coilspring.errors import require_choice
from coilspring.scene import Scene
from coilspring.scene.material import Material


class Parameter(NamedTuple):
    """How a number is read from a scene, and the scene that has another value."""

    read: Callable[[Scene], float]
    write: Callable[[Scene, float], Scene]


FACTORS = ("axial", "shearing", "bending")  # of the paper's stiffnesses


def _changed(scene: Scene, part: str, **changes: Any) -> Scene:
    return replace(scene, **{part: replace(getattr(scene, part), **changes)})


def _field(part: str, name: str) -> Parameter:
    """A field of a part of the scene."""
    return Parameter(
        lambda scene: getattr(getattr(scene, part), name),
        lambda scene, value: _changed(scene, part, **{name: value}),
    )


def _diameter(read: Callable, write: Callable) -> Parameter:
    """A number read from the mean diameters at bottom and top, and these where it has another value."""
    return Parameter(
        lambda scene: read(*scene.spring.mean_diameter),
        lambda scene, value: _changed(
            scene, "spring", mean_diameter=write(value, *scene.spring.mean_diameter)
        ),
    )


def _material(scene: Scene, E: float, G: float) -> Scene:
    return replace(scene, material=Material.from_moduli(E, G, scene.material.density))


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
        lambda scene: scene.spring.pitch,
        lambda scene, value: _changed(scene, "spring", active_height=value * scene.spring.active_coils),
    ),
    "E": Parameter(lambda scene: scene.material.E, lambda scene, E: _material(scene, E, scene.material.G)),
    "G": Parameter(lambda scene: scene.material.G, lambda scene, G: _material(scene, scene.material.E, G)),
    "penalty": _field("contact", "stiffness"),
    "exponent": _field("contact", "exponent"),
    **{name: _field("factors", name) for name in FACTORS},
}

NAMES = tuple(PARAMETERS)


def values(scene: Scene, names: tuple[str, ...]) -> np.ndarray:
    """Values of the parameters named.

    Raises
    ------
    InputError : a name that is none of `NAMES`.
    """
    for name in names:
        require_choice("parameters", name, NAMES)
    return np.array([PARAMETERS[name].read(scene) for name in names])


def varied(scene: Scene, names: tuple[str, ...], new: np.ndarray) -> Scene:
    """The scene with other values of the parameters named."""
    for name, value in zip(names, new.tolist(), strict=True):
        scene = PARAMETERS[name].write(scene, value)
    return scene


def rise(scene: Scene, name: str) -> float:
    """Change of the height at rest, from where displacements are counted, with a parameter."""
    return scene.spring.active_coils if name == "pitch" else 0.0
