"""What is modelled: springs, scenes and the equilibrium path, shared by both models."""

from coilspring.errors import EquilibriumNotFound, InputError
from coilspring.path import EquilibriumPath, load_path
from coilspring.scene import Contact, Factors, Load, Scene, Supports
from coilspring.scene.catalogue import CATALOGUE, spring_a, spring_b
from coilspring.scene.material import Material
from coilspring.scene.profile import CoilSection
from coilspring.scene.spring import Spring
from coilspring.scene.toml import load_scene, scene_text

__version__ = "0.1.0"

__all__ = [
    "CATALOGUE", "CoilSection", "Contact", "EquilibriumNotFound", "EquilibriumPath", "Factors", "InputError",
    "Load", "Material", "Scene", "Spring", "Supports", "load_path", "load_scene", "scene_text", "spring_a",
    "spring_b",
]  # fmt: skip
