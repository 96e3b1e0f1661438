"""Numbers of a spring and of its model by name, as sensitivities and calibration change them."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from coilspring.errors import require_choice
from coilspring.scene import Scene
from coilspring.scene.material import Material


@dataclass(frozen=True)
class Parameter:
    """How a number is read from a scene, and the scene that has another value.

    `rise` is the change of the height at rest with the value: displacements are counted from there.
    """

    read: Callable[[Scene], float]
    write: Callable[[Scene, float], Scene]
    rise: Callable[[Scene], float] = lambda scene: 0.0


FACTORS = ("axial", "shearing", "bending")  # of the paper's stiffnesses


def _spring(scene: Scene, **changes: Any) -> Scene:
    return replace(scene, spring=replace(scene.spring, **changes))


def _widened(scene: Scene, mean: float) -> Scene:
    """The scene with a spring of another mean coil diameter."""
    bottom, top = scene.spring.mean_diameter
    share = 2.0 * mean / (bottom + top)
    return _spring(scene, mean_diameter=(share * bottom, share * top))


def _contact(scene: Scene, **changes: Any) -> Scene:
    return replace(scene, contact=replace(scene.contact, **changes))


def _factor(name: str) -> Parameter:
    """One of the scene's factors."""
    return Parameter(
        lambda scene: getattr(scene.factors, name),
        lambda scene, value: replace(scene, factors=replace(scene.factors, **{name: value})),
    )


def _material(scene: Scene, E: float, G: float) -> Scene:
    return replace(scene, material=Material.from_moduli(E, G, scene.material.density))


PARAMETERS: Mapping[str, Parameter] = {
    "wire_diameter": Parameter(
        lambda scene: scene.spring.wire_diameter, lambda scene, value: _spring(scene, wire_diameter=value)
    ),
    "mean_diameter": Parameter(  # both ends by the same factor
        lambda scene: 0.5 * sum(scene.spring.mean_diameter), lambda scene, value: _widened(scene, value)
    ),
    "bottom_diameter": Parameter(
        lambda scene: scene.spring.mean_diameter[0],
        lambda scene, value: _spring(scene, mean_diameter=(value, scene.spring.mean_diameter[1])),
    ),
    "top_diameter": Parameter(
        lambda scene: scene.spring.mean_diameter[1],
        lambda scene, value: _spring(scene, mean_diameter=(scene.spring.mean_diameter[0], value)),
    ),
    "pitch": Parameter(
        lambda scene: scene.spring.pitch,
        lambda scene, value: _spring(scene, active_height=value * scene.spring.active_coils),
        rise=lambda scene: scene.spring.active_coils,
    ),
    "E": Parameter(
        lambda scene: scene.material.E, lambda scene, value: _material(scene, value, scene.material.G)
    ),
    "G": Parameter(
        lambda scene: scene.material.G, lambda scene, value: _material(scene, scene.material.E, value)
    ),
    "penalty": Parameter(
        lambda scene: scene.contact.stiffness, lambda scene, value: _contact(scene, stiffness=value)
    ),
    "exponent": Parameter(
        lambda scene: scene.contact.exponent, lambda scene, value: _contact(scene, exponent=value)
    ),
    **{name: _factor(name) for name in FACTORS},
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
    """Change of the height at rest with a parameter."""
    return PARAMETERS[name].rise(scene)
