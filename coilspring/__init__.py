"""What is modelled: springs, scenes and the equilibrium path, shared by both models."""

from coilspring.catalogue import CATALOGUE, spring_a, spring_b
from coilspring.errors import EquilibriumNotFound, InputError
from coilspring.material import Material
from coilspring.path import EquilibriumPath
from coilspring.profile import CoilSection
from coilspring.scene import Contact, Load, Scene, Supports
from coilspring.scenefile import load_scene
from coilspring.scenetext import scene_text
from coilspring.spring import Spring

__all__ = [
    "CATALOGUE",
    "CoilSection",
    "Contact",
    "EquilibriumNotFound",
    "EquilibriumPath",
    "InputError",
    "Load",
    "Material",
    "Scene",
    "Spring",
    "Supports",
    "load_scene",
    "scene_text",
    "spring_a",
    "spring_b",
]
