"""Invariances: answers must not depend on the mirror image, units or last digits of the input."""

from __future__ import annotations

import math
from dataclasses import replace

from coilspring import EquilibriumPath, Scene
from validation.campaign.runs import (
    LOAD,
    UNCHANGED,
    Bounds,
    bounds_of,
    common_end,
    deviation,
    force_grain,
    grain,
    path_dependent,
)
from validation.campaign.scenes import EVERY, Case, in_units
from validation.campaign.verdict import CRITICAL, STUCK, Verdict, reached

KINDS = ("mirror", "binary", "units", "perturbed")
ROUNDING = 1e-10  # over the softness: what rounding may change
SOLVER = 1e-6  # what the solver's tolerance may change
PERTURBATION, ANSWER = 1e-12, 1e-8  # of the input, and the most that this may change the answer
SOFT = 1e-6  # stiffness over that at rest, below which small changes of the input may count
CRITICAL_SHIFT = 1e-7  # of a critical time; its bracket is 2e-9 wide


def changed(case: Case, kind: str) -> tuple[Scene, tuple[float, ...]]:
    """The scene of a kind, and the factors that bring its tips back to those of the case."""
    scene, spring, load = case.scene, case.scene.spring, case.scene.load
    x, y = load.force
    if kind == "mirror":  # in the Y-Z plane: load, and the side on which the wire begins; of a wire, its hand
        hand = spring.hand
        if case.model == "wirefe":
            hand = "right" if hand == "left" else "left"
        image = replace(spring, start_phase=spring.start_phase + math.pi, hand=hand)
        return replace(scene, spring=image, load=replace(load, force=(-x, y))), (-1.0, 1.0, -1.0)
    if kind == "perturbed":
        more, less = 1.0 + PERTURBATION, 1.0 - PERTURBATION
        # a spring whose coils touch at rest is another one where its height differs by rounding
        taller = 1.0 if case.corner == "touching" else more
        displacement = tuple(more * value for value in load.displacement)
        other = replace(
            scene,
            spring=replace(spring, active_height=spring.active_height * taller),
            material=replace(scene.material, E=scene.material.E * less),
            load=replace(load, force=(x * more, y), displacement=displacement),
        )
        return other, UNCHANGED
    # units such that the penalty stays within its range
    length, force = (1e3, 1e6) if case.corner == "tiny" else (1e-3, 1e-6)
    if kind == "binary":
        power = case.number // len(KINDS) % 7 - 3
        length, force = 2.0**power, 2.0 ** (2 * power - abs(power) - case.number % 3)
    return in_units(scene, length, force), (1.0 / length, 1.0 / length, 1.0)


def verify_invariance(verdict: Verdict, case: Case, path: EquilibriumPath) -> str:
    """Verify the case's turn of the invariances, and return its kind."""
    kind = KINDS[(case.number + case.number // EVERY) % len(KINDS)]  # so that corners take all in turn
    scene, back = changed(case, kind)
    other, least = reached(case, scene), verdict.numbers.get("least", 1.0)
    verdict.stop(kind, other)
    if STUCK not in (path.outcome, other.outcome) and (path.outcome in CRITICAL) != (
        other.outcome in CRITICAL
    ):
        verdict.complain(f"{kind}: {path.outcome}, but changed it ends as {other.outcome}")
    elif kind != "perturbed" or least > SOFT:
        bounds = {
            "mirror": ROUNDING / least,
            "binary": ROUNDING / least,
            "units": SOLVER,
            "perturbed": ANSWER,
        }
        loose = bounds_of(case) if path_dependent(case.scene, case.model) else Bounds(0.0, 0.0, 0.0)
        most = max(bounds[kind], loose.branch, grain(path))
        found = deviation(path, other, back, common_end(path, other))[1]
        verdict.ask("invariance", found, most, f"{kind} changes the answer")
        if path.critical_time is not None and other.critical_time is not None:
            shift = abs(path.critical_time - other.critical_time) / max(path.critical_time, LOAD)
            most = max(CRITICAL_SHIFT, loose.critical, force_grain(path))
            verdict.ask("critical_shift", shift, most, f"{kind} shifts the critical time")
    return kind
