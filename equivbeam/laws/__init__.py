"""Constitutive laws of a half coil: each is a table of parameters, a row a half coil, and one kernel."""

from dataclasses import astuple
from pathlib import Path
from typing import Any

import numpy as np

from coilspring.compiling.compiled import inlined
from coilspring.errors import InputError
from coilspring.scene import Factors
from coilspring.scene.material import Material
from coilspring.scene.spring import Spring
from coilspring.words import shown
from equivbeam.laws.haringx import KAX, KFL, KSH, haringx_response, haringx_rows
from equivbeam.laws.helix import Refinements, helix_response, helix_rows
from equivbeam.laws.userlaw import KNOWN, UserLaw, law_of_file, law_of_object

HARINGX, HELIX, USER = 0, 1, 2
LAWS = {"haringx": HARINGX, "helix": HELIX}


def law_of(given: Any) -> str | UserLaw:
    """The law that is meant: a name, a Python file, a module or an object, or what a path keeps of one."""
    if isinstance(given, UserLaw) or (isinstance(given, str) and given in LAWS):
        return given
    if isinstance(given, str) and given in KNOWN:
        return KNOWN[given]
    if isinstance(given, Path) or (isinstance(given, str) and given.endswith(".py")):
        return law_of_file(Path(given))
    if not isinstance(given, str) and (hasattr(given, "energy") or hasattr(given, "parameters")):
        return law_of_object(given)
    if isinstance(given, str) and "@" in given:
        raise InputError(f"law {given} must be loaded first, by a solve with the law that has this content")
    raise InputError(f"law must be one of {', '.join(LAWS)}, or a Python file, got {shown(given)}")


def name_of(law: str | UserLaw) -> str:
    """What a user calls a law: without the digest by which paths and keys keep one."""
    return law.name if isinstance(law, UserLaw) else law


def require_factors(law: str | UserLaw, factors: Factors) -> None:
    """Refuse factors of stiffnesses that a law does not have."""
    if factors.given and law != "haringx":
        raise InputError(
            f"factors must be 1 unless the law is haringx, got {astuple(factors)!r} with {name_of(law)!r}"
        )


def law_rows(
    law: str | UserLaw, spring: Spring, material: Material, refinements: Refinements, factors: Factors
) -> np.ndarray:
    """Parameters of every half coil as the law reads them, one row each; the length at rest in column L0.

    `InputError` for factors of stiffnesses that another law than the paper's does not have.
    """
    require_factors(law, factors)
    if isinstance(law, UserLaw):
        return law.rows(spring, material)
    if law == "helix":
        return helix_rows(spring, material, refinements)
    rows = haringx_rows(spring, material)
    if factors.given:
        rows[:, [KAX, KSH, KFL]] *= astuple(factors)
    return rows


@inlined
def response(law, rows, i, l, v, dth):  # noqa: E741
    """Response of the half coil `i` by a built-in law; a user's brings its own (`UserLaw.response`)."""
    return haringx_response(rows, i, l, v, dth) if law == HARINGX else helix_response(rows, i, l, v, dth)
