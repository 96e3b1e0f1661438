"""TOML scene files, and scenes by name."""

from __future__ import annotations

import tomllib
from collections.abc import Mapping
from pathlib import Path

from coilspring.catalogue import CATALOGUE
from coilspring.errors import InputError, shown
from coilspring.material import Material
from coilspring.scene import Contact, Load, Scene, Supports
from coilspring.spring import Spring

# section -> (required keys, optional keys), as the dataclasses name them
SECTIONS: Mapping[str, tuple[tuple[str, ...], tuple[str, ...]]] = {
    "material": ((), ("E", "nu", "G")),
    "spring": (
        ("wire_diameter", "mean_diameter", "active_coils", "active_height"),
        ("end_turns", "start_phase", "hand"),
    ),
    "load": (("force",), ("steps",)),
    "supports": ((), ("top_held",)),
    "contact": ((), ("enabled", "stiffness", "exponent", "sliding", "friction")),
}
REQUIRED_SECTIONS = ("spring", "load")


def load_scene(source: str | Path) -> Scene:
    """Scene of the catalogue by name, or of a TOML file by path.

    Raises
    ------
    InputError : unknown name, unreadable or truncated file, or a refused value, in one sentence.
    """
    if str(source) in CATALOGUE:
        return CATALOGUE[str(source)]()
    path = Path(source)
    try:
        text = path.read_text(encoding="utf-8-sig")  # some editors write a mark first
    except (OSError, ValueError) as error:
        reason = getattr(error, "strerror", None) or "not a UTF-8 text file"
        raise InputError(
            f"SCENE must be one of {', '.join(CATALOGUE)} or a readable TOML file, "
            f"got {shown(str(source))} ({reason})"
        ) from None
    try:
        return scene_from_text(text, path.stem)
    except InputError as error:
        raise InputError(f"{path}: {error}") from None


def scene_from_text(text: str, default_name: str = "scene") -> Scene:
    """Scene of a TOML text; see `load_scene`."""
    try:
        table = tomllib.loads(text)
    except (ValueError, RecursionError) as error:  # a number of thousands of digits is a ValueError
        raise InputError(f"the file must be complete TOML, but it is not: {error}") from None
    _refuse_unknown("top level", table, ("name", *SECTIONS))
    parts = {section: _section(table, section) for section in SECTIONS}
    return Scene(
        name=table.get("name", default_name),
        spring=Spring(**parts["spring"]),
        load=Load(**parts["load"]),
        material=_material(parts["material"]),
        supports=Supports(**parts["supports"]),
        contact=Contact(**parts["contact"]),
    )


def _section(table: Mapping[str, object], section: str) -> dict:
    """Keys of a section, with unknown and missing ones refused."""
    if section not in table and section in REQUIRED_SECTIONS:
        sections = " and ".join(f"[{name}]" for name in REQUIRED_SECTIONS)
        raise InputError(f"section [{section}] is missing; {sections} are required")
    keys = table.get(section, {})
    if not isinstance(keys, dict):
        raise InputError(f"{section} must be a section [{section}] with keys, got {shown(keys)}")
    required, optional = SECTIONS[section]
    _refuse_unknown(f"[{section}]", keys, required + optional)
    for key in required:
        if key not in keys:
            raise InputError(f"{section}.{key} is missing; [{section}] requires {', '.join(required)}")
    return keys


def _refuse_unknown(where: str, keys: Mapping[str, object], allowed: tuple[str, ...]) -> None:
    for key in keys:
        if key not in allowed:
            raise InputError(f"unknown key {shown(key)} in {where}; allowed: {', '.join(allowed)}")


def _material(keys: dict) -> Material:
    """Material from E and nu, or from E and G."""
    if "G" not in keys:
        return Material(**keys)
    if "nu" in keys:
        raise InputError(
            f"material takes nu or G, not both: got nu = {shown(keys['nu'])} and G = {shown(keys['G'])}"
        )
    return Material.from_moduli(keys.get("E", Material.E), keys["G"])
