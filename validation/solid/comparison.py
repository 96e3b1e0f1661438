"""Solids of CalculiX beside rods: flexibility of a few coils, and a scene in large deflection."""

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import pandas as pd

import equivbeam
import wirefe
from coilspring import EquilibriumPath, InputError, Material, Scene, Spring
from coilspring.curves import COMPONENTS
from coilspring.scene.solidwire import wire_flexibility
from validation.solid.hexahedra import COARSE, FINE, MIDDLE, deflection, flexibility, mesh_coils
from validation.study.metrics import tip_deviation
from validation.study.partialsolve import partial_path
from wirefe.results.linear import tip_flexibility

DIRECTIONS = ("Fx", "Fy", "Fz", "Mx", "My", "Mz")
COILS = 3.0
PER_TURN = 16  # curved elements; their linear flexibility is exact
KINDS = ("beam", "solid")
SOLVERS: dict[str, tuple[Callable[..., EquilibriumPath], dict[str, Any]]] = {
    "paper's law": (equivbeam.solve, {"law": "haringx"}),
    "helix law": (equivbeam.solve, {"law": "helix"}),
    "wire model": (wirefe.solve, {"element": "curved", "elements_per_turn": 16}),
    "paper's mesh": (wirefe.solve, {}),
}
TITLES = tuple(SOLVERS)[:3]  # beside solids


def rod_flexibility(spring: Spring, material: Material, coils: float) -> np.ndarray:
    """Motion (u, rotation) of the reference point on the axis by unit forces and moments there, (6, 6).

    Of the first active coils, by the wire model with the spring's `wire_rigidity`.
    """
    end = 2.0 * np.pi * coils
    phases = np.linspace(0.0, end, round(PER_TURN * coils) + 1)
    rod = wirefe.curved_rod(spring, phases, wire_flexibility(spring, material))
    return tip_flexibility(rod, rod.points[-1] * [0.0, 1.0, 0.0])


def coil(index: float, degrees: float, coils: float) -> Spring:
    """Coils of wire of 1 mm without end turns, of a pitch angle."""
    height = coils * float(np.pi * index * np.tan(np.radians(degrees)))
    return Spring(1.0, (index, index), coils, height, end_turns=0.0)


def both(spring: Spring, material: Material, coils: float) -> dict[str, np.ndarray]:
    """`rod_flexibility` with both rigidities of the wire."""
    return {kind: rod_flexibility(replace(spring, wire_rigidity=kind), material, coils) for kind in KINDS}


def flexibilities(spring: Spring, material: Material, coils: float = COILS) -> pd.DataFrame:
    """Flexibility of the first coils in each direction, a row each, in per cent of the fine solids'.

    Columns `mesh`, `beam` and `solid` are how far the coarse solids and both rods are off; `mesh_whole`,
    `beam_whole` and `solid_whole` the largest error of an entry of the 6 x 6 matrix, over the root of its
    diagonal entries.
    """
    coils = min(coils, spring.active_coils)
    (coarse, _), (fine, seconds) = (
        flexibility(mesh_coils(spring, coils, fineness), material.E, material.nu)
        for fineness in (COARSE, FINE)
    )
    rods, size = both(spring, material, coils), np.sqrt(np.diag(fine))
    data = pd.DataFrame({"direction": DIRECTIONS, "flexibility": np.diag(fine)})
    for name, found in {"mesh": coarse, **rods}.items():
        data[name] = 100.0 * (np.diag(found) / np.diag(fine) - 1.0)
        data[f"{name}_whole"] = 100.0 * (np.abs(found - fine) / np.outer(size, size)).max()
    return data.assign(coils=coils, seconds=seconds)


def deflections(scene: Scene) -> pd.DataFrame:
    """UX, UY, ROTZ of a scene at full load without contact, a row for each model and mesh of solids.

    `off` is the largest difference to the finer solids in a component, over that component, %.
    """
    scene = scene.without_contact()
    rows: list[tuple[str, str, np.ndarray]] = []
    for name, fineness in (("coarse", COARSE), ("middle", MIDDLE)):
        rows.append(("solids", name, deflection(scene, fineness)))
        if np.isnan(rows[-1][-1]).any():
            break  # nor would the finer one
    for model in TITLES:
        for kind in KINDS:
            path = solved(scene, model, kind)
            rows.append((model, kind, path.tips[-1] if len(path.tips) else np.full(3, np.nan)))
    tips, finest = np.array([tip for *_, tip in rows]), len(rows) - len(TITLES) * len(KINDS) - 1
    data = pd.DataFrame([row[:2] for row in rows], columns=["model", "wire"])
    data[[*COMPONENTS]] = tips
    data["off"] = 100.0 * tip_deviation(tips, tips[finest])
    return data


def solved(scene: Scene, model: str, kind: str) -> EquilibriumPath:
    """Path of a model with a rigidity of the wire, as far as it goes."""
    solve, options = SOLVERS[model]
    return partial_path(solve, replace(scene, spring=replace(scene.spring, wire_rigidity=kind)), **options)


def require_force(scene: Scene) -> None:
    """Refuse scenes that the solids are not given."""
    scene.supports.require_supported("calculix")
    if scene.load.stages or scene.load.displacement:
        raise InputError("load.force must be given for calculix, got load.stages or load.displacement")


def lines(coils: pd.DataFrame, moved: pd.DataFrame) -> list[str]:
    """For a reader at the terminal."""
    head = f"flexibility of {coils['coils'].iloc[0]:g} coils against solids, clamped and free, %:"
    table = [f"  {'':<22} " + " ".join(f"{name:>7}" for name in DIRECTIONS)]
    for name, title in (("beam", "wire, beam"), ("solid", "wire, solid"), ("mesh", "solids, coarse mesh")):
        table.append(f"  {title:<22} " + " ".join(f"{value:+7.3f}" for value in coils[name]))
    table.append("full load in large deflection, without contact, mm and rad; off the finer solids, %:")
    for row in moved.itertuples():
        title = f"{row.model}, {row.wire}"
        table.append(f"  {title:<22} {row.ux:10.4f} {row.uy:10.4f} {row.rotz:10.5f} {row.off:8.3f}")
    return [head, *table]
