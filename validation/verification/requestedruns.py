"""Accuracy on request, on one random spring after the other: its errors, estimates and times.

The error is measured against the wire model by `REFERENCE`; what `FINER` changes is its own error. Time is
CPU time, of `wirefe.solve_to` and of the cheapest of single runs on the levels of `LEVELS`, with `DENSITIES`
stations for each element, whose error is small enough, all else included: medians of runs that take turns.
"""

import math
import time
from collections.abc import Iterable, Iterator
from contextlib import suppress
from dataclasses import replace
from itertools import cycle, product
from typing import Any

import numpy as np

import wirefe
from coilspring import EquilibriumPath, InputError, Load, Scene
from validation.study.partialsolve import partial_path
from validation.study.provenance import models
from validation.study.sections import in_sections
from validation.verification.randomscenes import KINDS, Drawn, plain, population
from wirefe import model
from wirefe.meshes import MOST, Levels, difference

ACCURACIES = (1e-2, 1e-3, 1e-4)
SEED, EACH = 20, 38  # springs of every kind and seed
COILS = 5.0  # at most: the reference takes seconds
# Elements and stations a turn, and times the scene's steps where there is friction.
REFERENCE, FINER = (64, 1538, 4), (128, 1998, 8)
LEVELS = (4, 6, 8, 12, 16, 24, 32, 48, 64, 96)  # levels among which the cheapest sufficient one is
DENSITIES = (4, 8, 16)  # stations for each element there, up to `MOST`
# Kinds of springs besides those of `KINDS`, all of which are on rigid ends, loaded once, and of few sections.
PLATES, UNLOADED, SECTIONS = OTHERS = ("on plates", "unloaded to 30 %", "of sections")
BACK = 0.3  # share of the load that is left where it is unloaded
FIRST_OTHER = 1_000_000  # offset of the seed for each of `OTHERS`, so that their springs are new
# What the coils of a kind's springs do in contact, one after the other: geometry, sliding, friction. The
# reference of wires with friction, or that stick, takes minutes where many pairs close: there are none.
CONTACTS: tuple[tuple[str, str, float | None], ...] = (
    *[("wires", "free", None)] * 4,
    *[("spheres", "free", None)] * 2,
    ("spheres", "coulomb", 0.1),
    ("spheres", "none", None),
)
REPEATS = 5  # of each timing
REFUSED, NUMBERS = "refused", ("stations", "estimated", "true", "seconds", "cheapest")
COLUMNS = (
    *("sources", "seed", "kind", "number", "coils", "contact", "closed", "reference", "own"),
    *("asked", "outcome", "level", *NUMBERS),
)


def springs(each: int, seed: int = SEED) -> Iterator[tuple[Drawn, Scene]]:
    """Random springs of at most `COILS` coils, `each` of every kind of load and of `OTHERS`, in turn."""
    kinds = [_short(population(seed, 100 * each, {kind.name})) for kind in KINDS]
    for place, kind in product(range(each), (*kinds, *(_others(seed, each, name) for name in OTHERS))):
        drawn = next(kind)
        geometry, sliding, friction = CONTACTS[place % len(CONTACTS)]
        contact = replace(drawn.scene.contact, geometry=geometry, sliding=sliding, friction=friction)
        yield drawn, replace(drawn.scene, contact=contact)


def _short(drawn: Iterable[Drawn]) -> Iterator[Drawn]:
    """Those of at most `COILS` coils."""
    return (found for found in drawn if found.scene.spring.active_coils <= COILS)


def _others(seed: int, each: int, name: str) -> Iterator[Drawn]:
    """Springs of one of `OTHERS` under mostly axial loads of every kind, in turn."""
    form = in_sections if name == SECTIONS else plain
    offset = seed + FIRST_OTHER * (1 + OTHERS.index(name))
    axial = [kind.name for kind in KINDS if kind.is_axial]
    kinds = cycle([_short(population(offset, 100 * each, {kind}, form)) for kind in axial])
    for number, kind in enumerate(kinds):
        drawn = next(kind)
        load, supports = drawn.scene.load, drawn.scene.supports
        if name == PLATES:
            supports = replace(supports, seat="plate")
        elif name == UNLOADED:
            load = _and_back(load)
        scene = replace(drawn.scene, load=load, supports=supports)
        yield replace(drawn, seed=seed, number=number, kind=name, scene=scene)


def _and_back(load: Load) -> Load:
    """The load, and then a share of it."""
    (x, y), pressed = load.force, tuple(share * uy for uy in load.displacement for share in (1.0, BACK))
    stages = () if pressed else ((x, y), (BACK * x, BACK * y))
    return Load(steps=load.steps, stages=stages, displacement=pressed)


def rows(drawn: Drawn, scene: Scene, accuracies: Iterable[float] = ACCURACIES) -> list[dict[str, Any]]:
    """What was found of a spring, for each accuracy."""
    levels, contact = Levels.of(scene, None), scene.contact
    exact, finer = _reference(scene, levels, *REFERENCE), _reference(scene, levels, *FINER)
    answers = {asked: _timed(wirefe.solve_to, scene, accuracy=asked)[0] for asked in accuracies}
    cheapest = _cheapest(scene, levels, exact, accuracies)
    seconds = _in_turns(scene, [asked for asked, path in answers.items() if path], cheapest)
    head = {
        **{"sources": models(), "seed": drawn.seed, "kind": drawn.kind, "number": drawn.number},
        "coils": scene.spring.active_coils,
        "contact": f"{contact.geometry} {contact.sliding}" if contact.enabled else "none",
        "closed": int(exact.active_contacts.max(initial=0)),
        "reference": exact.outcome,
        "own": difference(exact, finer),
    }
    found = []
    for asked, path in answers.items():
        row = {"asked": asked, "outcome": REFUSED, "level": 0} | dict.fromkeys(NUMBERS, math.nan)
        if path:
            row |= {"outcome": path.outcome, "level": path.options["elements_per_turn"]}
            row |= {"stations": path.options["pairs_per_turn"], "estimated": path.estimated_error}
            row |= {"true": difference(path, exact)}
            row |= dict(zip(("seconds", "cheapest"), seconds[asked], strict=True))
        found.append(head | row)
    return found


def _timed(solve: Any, scene: Scene, **options: Any) -> tuple[EquilibriumPath | None, float]:
    """A path as far as it was reached, None where it was refused, and the CPU time of all that it took.

    What runs before have left in memory is cleared, which makes the second run on a mesh up to half as long.
    """
    path = None
    model._topology.cache_clear()
    began = time.process_time()
    with suppress(InputError):
        path = partial_path(solve, scene, **options)
    return path, time.process_time() - began


def _in_turns(
    scene: Scene, accuracies: Iterable[float], cheapest: dict[float, dict[str, Any]]
) -> dict[float, tuple[float, float]]:
    """CPU time of the answer and of the cheapest run for each accuracy, medians of `REPEATS` that take turns;
    the latter not a number where no run is good enough."""
    found: dict[float, list[tuple[float, float]]] = {asked: [] for asked in accuracies}
    for _ in range(REPEATS):
        for asked, times in found.items():
            answer = _timed(wirefe.solve_to, scene, accuracy=asked)[1]
            mesh = cheapest.get(asked)
            times.append((answer, _timed(wirefe.solve, scene, **mesh)[1] if mesh else math.nan))
    return {asked: tuple(np.median(times, axis=0).tolist()) for asked, times in found.items()}


def _reference(scene: Scene, levels: Levels, level: int, stations: int, times: int) -> EquilibriumPath:
    """A path that errors are measured from, with so many times the steps where there is friction."""
    options = levels.options(level, stations)
    steps = scene.load.steps * (times if scene.contact.coefficient else 1)
    return partial_path(wirefe.solve, scene, steps=steps, **options)


def _cheapest(
    scene: Scene, levels: Levels, exact: EquilibriumPath, accuracies: Iterable[float]
) -> dict[float, dict[str, Any]]:
    """Mesh of the cheapest single run whose error is small enough, for each accuracy for which there is one:
    each was timed twice."""
    found: list[tuple[float, float, dict[str, Any]]] = []
    touching = scene.contact.enabled and levels.spheres is None
    for density in DENSITIES if touching else DENSITIES[:1]:
        for level in sorted({levels.at_least(level) for level in LEVELS}):
            mesh = levels.options(level, min(density * level, MOST))
            (path, first), (_, second) = (_timed(wirefe.solve, scene, **mesh) for _ in range(2))
            assert path is not None
            found.append((min(first, second), difference(path, exact), mesh))
            if found[-1][1] <= min(accuracies):
                break
    enough = {asked: [run for run in found if run[1] <= asked] for asked in accuracies}
    return {asked: min(runs, key=lambda run: run[0])[2] for asked, runs in enough.items() if runs}
