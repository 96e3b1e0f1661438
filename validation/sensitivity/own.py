"""The inputs of a user's scene: those that the paper leaves open, in ranges about the scene's own values."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import replace

from coilspring import Scene
from validation.sensitivity.inputs import INPUTS, OpenInput, Variant
from wirefe.contactpoints import PER_TURN

VARIED = "varied"  # their kind, as `KINDS` has those of the paper's scenes
SHARE, POISSON = 0.05, 0.03  # changes of Young's modulus and of Poisson's ratio
HERE: dict[str, Callable[[Scene], str]] = {
    "E": lambda scene: f"{1e-3 * scene.material.E:g} GPa",
    "nu": lambda scene: f"{scene.material.nu:g}",
    "reference_height": lambda scene: f"{scene.spring.active_height:g} mm",
    "end_contact": lambda scene: "yes",
    "rigid_turns": lambda scene: f"{scene.spring.end_turns:g}",
    "start_phase": lambda scene: f"{scene.spring.start_phase:g} rad",
    "sphere_place": lambda scene: f"{scene.spring.start_phase:g} rad",
    "pairs": lambda scene: f"{PER_TURN[scene.contact.geometry]} {scene.contact.geometry}",
    "penalty": lambda scene: f"K = {scene.contact.stiffness:g}",
    "exponent": lambda scene: f"{scene.contact.exponent:g}",
    "friction": lambda scene: {"free": "none", "none": "sticking"}.get(
        scene.contact.sliding, f"µ = {scene.contact.coefficient:g}"
    ),
    "element": lambda scene: "straight",
    "wire_rigidity": lambda scene: scene.spring.wire_rigidity,
}


def _moduli(scene: Scene, model: str) -> Iterator[Variant]:
    for factor in (1.0 - SHARE, 1.0 + SHARE):
        stiffer = replace(scene.material, E=factor * scene.material.E)
        yield Variant(f"{1e-3 * stiffer.E:g} GPa", replace(scene, material=stiffer))


def _ratios(scene: Scene, model: str) -> Iterator[Variant]:
    for nu in (scene.material.nu - POISSON, scene.material.nu + POISSON):
        yield Variant(f"{nu:g}", replace(scene, material=replace(scene.material, nu=nu)))


def inputs_of(scene: Scene) -> tuple[OpenInput, ...]:
    """What is varied of a scene, with its values there."""
    make = {"E": _moduli, "nu": _ratios}
    return tuple(
        replace(item, kind=VARIED, default=HERE[item.name](scene), make=make.get(item.name, item.make))
        for item in INPUTS
    )
