"""How far the results rest on what the paper does not give: material and penalty."""

from __future__ import annotations

from dataclasses import replace

from coilspring import EquilibriumPath, Material
from validation.study.cases import CASES, PathStore, case
from validation.study.document import Table
from validation.study.partialsolve import ending

MODULUS_CHANGES = (0.95, 1.05)
POISSON_RATIOS = (0.28, 0.32)
PENALTY_FACTORS = (0.1, 10.0)


def material_table(store: PathStore) -> Table:
    """Tip displacements of the equivalent beam for other materials, against the default's."""
    default = Material()
    materials = [
        (f"E {100.0 * (share - 1.0):+.0f} %", Material(default.E * share, default.nu))
        for share in MODULUS_CHANGES
    ]
    materials += [(f"nu = {nu:g}", Material(default.E, nu)) for nu in POISSON_RATIOS]
    rows = []
    for item in CASES:
        base = store.beam(item.scene)
        paths = [store.partial_beam(replace(item.scene, material=material)) for _, material in materials]
        rows.append((item.title, *(_change(path, base) for path in paths)))
    return Table(("change of UX / UY at full load (%)", *(label for label, _ in materials)), tuple(rows))


def penalty_table(store: PathStore) -> Table:
    """Tips and penetration of both models for softer and harder contact."""
    rows = []
    for name in ("spring-a", "spring-b"):
        scene = case(name).scene
        stiffness = scene.contact.stiffness
        for model, solve in (("beam", store.partial_beam), ("wire model", store.partial_wire)):
            base = solve(scene)
            for factor in (PENALTY_FACTORS[0], 1.0, PENALTY_FACTORS[1]):
                path = solve(scene.with_penalty(factor * stiffness))
                rows.append((case(name).title, model, f"{factor * stiffness:g}", *_penetration(path, base)))
    header = ("case", "model", "K (N/mm)", "UY (mm)", "change of UX / UY (%)", "largest penetration (µm)")
    return Table(header, tuple(rows))


def _penetration(path: EquilibriumPath, base: EquilibriumPath) -> tuple[str, str, str]:
    change = _change(path, base)
    if path.outcome != "completed":
        return "", change, ""
    return f"{path.tips[-1, 1]:.3f}", change, f"{1e3 * path.max_penetration[-1]:.2g}"


def _change(path: EquilibriumPath, base: EquilibriumPath) -> str:
    """Change of UX and UY at full load in %, a held UX left out; or how and when the path ended."""
    if path.outcome != "completed":
        return ending(path.outcome, path.critical_time)
    pairs = zip(path.tips[-1, :2], base.tips[-1, :2], strict=True)
    return " / ".join(f"{100.0 * (new / old - 1.0):+.2f}" for new, old in pairs if old)
