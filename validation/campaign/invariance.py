"""Invariances: answers must not depend on the mirror image, units or last digits of the input."""

from __future__ import annotations

import math
from dataclasses import replace

from coilspring import EquilibriumPath, Scene
from validation.campaign.runs import UNCHANGED, deviation, force_grain, grain, remembered
from validation.campaign.scenes import EVERY, Case, in_units
from validation.campaign.verdict import CRITICAL, Verdict, ended, reached

# Where friction or its limit, no sliding, make the answer depend on the substeps, rounding may change these.
KINDS = ("mirror", "binary", "units", "perturbed")
ROUNDING = 1e-10  # over the softness: what rounding may change
SOLVER = 1e-6  # what the solver's tolerance may change
PERTURBATION, ANSWER = 1e-12, 1e-8  # of the input, and the most that this may change the answer
SOFT = 1e-6  # stiffness over that at rest, below which small changes of the input may count
CRITICAL_SHIFT = 1e-7  # of a critical time; its bracket is 2e-9 wide


def mirrored(scene: Scene, wire: bool) -> Scene:
    """The image in the Y-Z plane: load, and the side on which the wire begins; of a wire, its hand too."""
    x, y = scene.load.force
    spring = replace(scene.spring, start_phase=scene.spring.start_phase + math.pi)
    if wire:
        spring = replace(spring, hand={"left": "right", "right": "left"}[spring.hand])
    return replace(scene, spring=spring, load=replace(scene.load, force=(-x, y)))


def changed(case: Case, kind: str) -> tuple[Scene, tuple[float, ...]]:
    """The scene of a kind, and the factors that bring its tips back to those of the case."""
    scene, same = case.scene, UNCHANGED
    if kind == "mirror":
        return mirrored(scene, case.model == "wirefe"), (-1.0, 1.0, -1.0)
    if kind == "perturbed":
        more, less = 1.0 + PERTURBATION, 1.0 - PERTURBATION
        x, y = scene.load.force
        # a spring whose coils touch at rest is another one where its height differs by rounding
        taller = 1.0 if case.corner == "touching" else more
        spring = replace(scene.spring, active_height=scene.spring.active_height * taller)
        material = replace(scene.material, E=scene.material.E * less)
        displacement = tuple(more * value for value in scene.load.displacement)
        load = replace(scene.load, force=(x * more, y), displacement=displacement)
        return replace(scene, spring=spring, material=material, load=load), same
    length, force = _units(case, kind)
    return in_units(scene, length, force), (1.0 / length, 1.0 / length, 1.0)


def _units(case: Case, kind: str) -> tuple[float, float]:
    """Factors of lengths and forces; such that the penalty stays within its range."""
    if kind == "binary":
        a = case.number // len(KINDS) % 7 - 3
        return 2.0**a, 2.0 ** (2 * a - abs(a) - case.number % 3)
    return (1e3, 1e6) if case.corner == "tiny" else (1e-3, 1e-6)


def verify_invariance(verdict: Verdict, case: Case, path: EquilibriumPath, loose: float = 0.0) -> str:
    """Verify the case's turn of the invariances and return its kind; `loose` is what friction may change."""
    kind = KINDS[(case.number + case.number // EVERY) % len(KINDS)]  # so that corners take all in turn
    scene, back = changed(case, kind)
    other = reached(case, scene)
    compared = Verdict()
    _compare(compared, kind, path, other, back, verdict.numbers.get("least", 1.0), loose)
    verdict.take(compared, bool(compared.differences) and remembered(case, path, other, back))
    return kind


def _compare(
    verdict: Verdict,
    kind: str,
    path: EquilibriumPath,
    other: EquilibriumPath,
    back: tuple[float, ...],
    least: float,
    loose: float,
) -> None:
    """What a change of this kind changes."""
    if other.outcome == "not_converged" and not ended(other):
        verdict.complain(f"{kind}: {path.outcome}, but changed it ends as {other.outcome}: {other.message}")
        return
    if not (ended(path) or ended(other)) and (path.outcome in CRITICAL) != (other.outcome in CRITICAL):
        verdict.differ(f"{kind}: {path.outcome}, but changed it ends as {other.outcome}")
        return
    most = {"mirror": ROUNDING / least, "binary": ROUNDING / least, "perturbed": ANSWER}.get(kind, SOLVER)
    if kind == "perturbed" and least <= SOFT:
        return
    _, largest = deviation(path, other, back)
    verdict.ask("invariance", largest, max(most, loose, grain(path)), f"{kind} changes the answer")
    if path.critical_time is not None and other.critical_time is not None:
        shift = abs(path.critical_time - other.critical_time) / path.critical_time
        most = max(CRITICAL_SHIFT, loose, force_grain(path))
        verdict.ask("critical_shift", shift, most, f"{kind} shifts the critical time")
