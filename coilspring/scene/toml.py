"""TOML scene files, and scenes by name."""

from __future__ import annotations

import difflib
import tomllib
from collections.abc import Mapping
from pathlib import Path

from coilspring.errors import InputError, shown
from coilspring.scene.catalogue import CATALOGUE
from coilspring.scene.material import Material
from coilspring.scene.profile import CoilSection
from coilspring.scene.scene import Contact, Load, Scene, Supports
from coilspring.scene.spring import Spring

Keys = tuple[tuple[str, ...], tuple[str, ...]]  # required, optional
ENDS = ("end_turns", "ends", "start_phase", "hand")
# as the dataclasses name them
SECTIONS: Mapping[str, Keys] = {
    "material": ((), ("E", "nu", "G")),
    "spring": (
        ("wire_diameter", "mean_diameter", "active_coils", "active_height"),
        ENDS,
    ),
    "load": ((), ("force", "stages", "displacement", "steps")),
    "supports": ((), ("top_held", "bottom_held", "seat")),
    "contact": ((), ("enabled", "stiffness", "exponent", "sliding", "friction")),
}
REQUIRED_SECTIONS = ("spring", "load")
OF_SECTIONS: Keys = (("wire_diameter", "sections"), ENDS)  # of [spring] where it has [[spring.sections]]
MOST_BYTES = 1_000_000
# Other diameters of a coil, by the first word of the key, and what makes the mean one of them.
OUTER, INNER = ", the outer diameter minus wire_diameter", ", the inner diameter plus wire_diameter"
DIAMETERS = {"outer": OUTER, "outside": OUTER, "inner": INNER, "inside": INNER, "coil": "", "spring": ""}
LOADS = ("force", "stages", "displacement")  # one of them
COILS: Keys = (("coils", "pitch", "mean_diameter"), ())  # of [[spring.sections]]


def load_scene(source: str | Path) -> Scene:
    """Scene of the catalogue by name, or of a TOML file by path.

    Raises
    ------
    InputError : unknown name, unreadable or truncated file, or a refused value, in one sentence.
    """
    if not isinstance(source, str | Path):
        raise InputError(f"SCENE must be the name of a scene or of a TOML file, got {shown(source)}")
    if str(source) in CATALOGUE:
        return CATALOGUE[str(source)]()
    path = Path(source)
    try:
        with path.open("rb") as file:
            data = file.read(MOST_BYTES + 1)
    except (OSError, ValueError) as error:  # a path with a zero byte is a ValueError
        raise InputError(
            f"SCENE must be one of {', '.join(CATALOGUE)} or a readable TOML file, "
            f"got {str(source)!r} ({getattr(error, 'strerror', None) or error})"
        ) from None
    try:
        return scene_from_text(_decoded(data), path.stem)
    except InputError as error:
        raise InputError(f"{path}: {error}") from None


def _decoded(data: bytes) -> str:
    if len(data) > MOST_BYTES:
        raise InputError(f"the file must be a scene of at most {MOST_BYTES} bytes, but it has more")
    try:
        return data.decode("utf-8-sig")  # some editors write a mark first
    except UnicodeDecodeError as error:
        raise InputError(f"the file must be UTF-8 text, but it is not from byte {error.start} on") from None


def scene_from_text(text: str, default_name: str = "scene") -> Scene:
    """Scene of a TOML text; see `load_scene`."""
    try:
        table = tomllib.loads(text)
    except (ValueError, RecursionError) as error:  # a number of thousands of digits is a ValueError
        raise InputError(
            f"the file must be complete TOML (numbers as 2.5, texts in quotes), but it is not: {error}"
        ) from None
    _refuse_unknown("top level", table, ("name", *SECTIONS))
    parts = {section: _section(table, section) for section in SECTIONS}
    return Scene(
        name=table.get("name", default_name),
        spring=_spring(parts["spring"]),
        load=_load(parts["load"]),
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
    if section == "spring" and "sections" in keys:
        _refuse_keys(section, "[spring] with sections", keys, OF_SECTIONS)
    else:
        _refuse_keys(section, f"[{section}]", keys, SECTIONS[section])
    return keys


def _refuse_keys(field: str, where: str, keys: Mapping[str, object], known: Keys) -> None:
    """Refuse keys that are unknown, and those that are missing."""
    required, optional = known
    _refuse_unknown(where, keys, required + optional)
    for key in required:
        if key not in keys:
            raise InputError(f"{field}.{key} is missing; {where} requires {', '.join(required)}")


def _refuse_unknown(where: str, keys: Mapping[str, object], allowed: tuple[str, ...]) -> None:
    for key in keys:
        if key not in allowed:
            near = _near(key[:100], allowed)
            meant = f"did you mean {near}? " if near else ""
            raise InputError(f"unknown key {shown(key)} in {where}; {meant}allowed: {', '.join(allowed)}")


def _near(key: str, allowed: tuple[str, ...]) -> str:
    """What is likely meant by an unknown key, or nothing."""
    first = key.lower().partition("_")[0]
    if first in DIAMETERS and "diam" in key.lower() and "mean_diameter" in allowed:
        return "mean_diameter" + DIAMETERS[first]
    return "".join(difflib.get_close_matches(key, allowed, n=1))


def _spring(keys: dict) -> Spring:
    """Spring of one kind of coils, or of [[spring.sections]]."""
    if "sections" not in keys:
        return Spring(**keys)
    tables = keys["sections"]
    if not isinstance(tables, list):
        raise InputError(f"spring.sections must be tables [[spring.sections]], got {shown(tables)}")
    sections = []
    for number, table in enumerate(tables, 1):
        field = f"spring.sections[{number}]"
        if not isinstance(table, dict):
            raise InputError(f"{field} must be a table with {', '.join(COILS[0])}, got {shown(table)}")
        _refuse_keys(field, f"{field} of [[spring.sections]]", table, COILS)
        sections.append(CoilSection(**table))
    return Spring.of_sections(**keys | {"sections": sections})


def _load(keys: dict) -> Load:
    """Load of one of the keys that give one."""
    given = [key for key in LOADS if key in keys]
    if not given:
        raise InputError(f"load.force is missing; [load] requires {', or '.join(LOADS)}")
    if len(given) > 1:
        raise InputError(f"[load] takes one of {', '.join(LOADS)}, got {' and '.join(given)}")
    return Load(**keys)


def _material(keys: dict) -> Material:
    """Material from E and nu, or from E and G."""
    if "G" not in keys:
        return Material(**keys)
    if "nu" in keys:
        raise InputError(
            f"material takes nu or G, not both: got nu = {shown(keys['nu'])} and G = {shown(keys['G'])}"
        )
    return Material.from_moduli(keys.get("E", Material.E), keys["G"])
