"""What is modelled: a spring, its material, load, supports and contact, as data and as TOML."""

from coilspring.scene.load import Load
from coilspring.scene.scene import HELD_CHOICES, SEATS, Contact, Factors, Scene, Supports, require_scene

__all__ = ["HELD_CHOICES", "SEATS", "Contact", "Factors", "Load", "Scene", "Supports", "require_scene"]
