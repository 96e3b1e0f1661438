"""What is modelled: a spring, its material, load, supports and contact, as data and as TOML."""

from coilspring.scene.contact import Contact
from coilspring.scene.factors import Factors
from coilspring.scene.load import Load
from coilspring.scene.scene import Scene, require_scene
from coilspring.scene.supports import HELD_CHOICES, SEATS, Supports

__all__ = ["HELD_CHOICES", "SEATS", "Contact", "Factors", "Load", "Scene", "Supports", "require_scene"]
