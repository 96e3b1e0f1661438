"""Scenes as commented TOML files, which `coilspring.load_scene` reads back."""

from __future__ import annotations

import json

from coilspring.scene.profile import CoilSection
from coilspring.scene.scene import Contact, Load, Scene
from coilspring.scene.spring import Spring

COLUMN = 36  # at which comments begin

HEAD = """\
# A scene for coilcheck: one spring, how it is held, and its load. Units are mm, N, MPa and rad.
# Keys that are left out take the values in brackets; `coilcheck check FILE` says what a file describes.
"""
INSTEAD = """\

# Coils of several kinds: in the place of mean_diameter, active_coils and active_height, one such table
# for each kind, from bottom to top. Each begins with the diameter at which the one below it ends.
# [[spring.sections]]
# coils = 2.0                       # turns of this kind
# pitch = [2.0, 4.0]                # at its bottom and its top, linear in the turns; or one number
# mean_diameter = [12.0, 9.0]       # the same
"""


def scene_text(scene: Scene) -> str:
    """Commented TOML text of a scene, which reads back as the same scene."""
    material, supports = scene.material, scene.supports
    tables = (
        HEAD + _line("name", scene.name, "[the file's name]"),
        "[material]\n"
        + _line("E", material.E, "Young's modulus [206000]")
        + _line("nu", material.nu, "Poisson's ratio [0.3]; or G, the shear modulus"),
        _spring_text(scene.spring),
        _load_text(scene.load),
        "[supports]\n"
        + _line("top_held", supports.top_held, "some of ux, uy, rotz, besides uz, rotx, roty [none]")
        + _line("bottom_held", supports.bottom_held, "the bottom is clamped [all three]")
        + _line("seat", supports.seat, 'end turns are "rigid" with their end or rest on a "plate" [rigid]'),
        _contact_text(scene.contact),
    )
    return "\n".join(tables)


def _spring_text(spring: Spring) -> str:
    lines = "[spring]\n" + _line("wire_diameter", spring.wire_diameter, "d")
    if not spring.sections:
        lines += (
            _line("mean_diameter", spring.mean_diameter, "of the coils at bottom and top; or one number")
            + _line("active_coils", spring.active_coils, "a multiple of 0.5 for the equivalent beam")
            + _line("active_height", spring.active_height, "of the active coils, between wire centres")
        )
    lines += (
        _line("end_turns", spring.end_turns, "not active turns at each end: 0 or at least 0.5 [1.0]")
        + _line("ends", spring.ends, 'pitch: "closed" d, "open" that of the coils next to them [closed]')
        + _line("start_phase", spring.start_phase, "angle from X to Z where the active wire begins [0.0]")
        + _line("hand", spring.hand, "left or right [left]")
    )
    if not spring.sections:
        return lines + INSTEAD
    return "\n".join((lines, *map(_section_text, spring.sections)))


def _section_text(section: CoilSection) -> str:
    return (
        "[[spring.sections]]\n"
        + _line("coils", section.coils, "turns")
        + _line("pitch", section.pitch, "at the section's bottom and top, linear in the turns")
        + _line("mean_diameter", section.mean_diameter, "the same")
    )


def _load_text(load: Load) -> str:
    if load.stages:
        given = _line("stages", load.stages, "forces Fx, Fy at the top, reached one after the other")
    elif load.displacement:
        given = _line("displacement", load.displacement, "UY of the top, reached one after the other")
    else:
        given = (
            _line("force", load.force, "Fx, Fy at the top at time 1, a dead load that grows with time")
            + "# or stages = [[0.0, -9.0], [0.0, 0.0]], forces reached one after the other, on and off,\n"
            + "# or displacement = -10.0, UY of the top, prescribed as by a test machine; or several\n"
        )
    return "[load]\n" + given + _line("steps", load.steps, "equal steps (of each stage) for results [50]")


def _contact_text(contact: Contact) -> str:
    lines = (
        "[contact]\n"
        + _line("enabled", contact.enabled, "false: coils pass through each other [true]")
        + _line("stiffness", contact.stiffness, "penalty K of a pair at 4 pairs a turn, N/mm^exponent [1e4]")
        + _line("exponent", contact.exponent, "of the penetration, 1 to 5 [1.0]")
        + _line("sliding", contact.sliding, '"free", "none", or "coulomb" with friction = ... [free]')
    )
    if contact.friction is None:
        return lines
    return lines + _line("friction", contact.friction, "coefficient")


def _line(key: str, value: object, comment: str) -> str:
    return f"{key} = {_toml(value)}".ljust(COLUMN - 1) + f" # {comment}\n"


def _toml(value: object) -> str:
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, str):
        # JSON's escapes are TOML's, but for pairs of them, and one that it leaves out
        return json.dumps(value, ensure_ascii=False).replace("\x7f", "\\u007f")
    if isinstance(value, tuple):
        return f"[{', '.join(map(_toml, value))}]"
    return repr(value)
