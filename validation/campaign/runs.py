"""Other runs of a scene must tell the same, and none may step over a critical point of another.

Runs in other steps, of the mirror image, in other units, or with other last digits of the input."""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np

from coilspring import EquilibriumPath, Scene, Spring
from validation.campaign.coils import largest_diameter
from validation.campaign.overlap import deepest
from validation.campaign.scenes import EVERY, Case, in_units, resized
from validation.campaign.verdict import CRITICAL, Verdict, reached, under

BRANCH = 1e-6  # difference from the fine run over the largest displacement,
LEAST_WIDTH = 4e-9  # of the time 0..1: no critical time is bracketed closer
SOLVER = 1e-8  # or this over the root of the least stiffness: what solvers leave, in the energy norm
ROUNDING = 4.0 * 2.0**-52  # of the spring's size: positions are no finer,
STICKS = 2e-6  # wire diameters: so closely it is known where pairs that stick touch and open
# And by so much more may gaps differ, after some dozens of operations; points of wires lie between two nodes.
GAPS = {"spheres": 8.0, "wires": 16.0}
FRICTION, FRICTION_TIME = 1e-3, 5e-3  # the same with friction, which follows the path; of a critical time
NEAR_CRITICAL = 0.01  # of its time: so near before a critical point paths with friction are not compared
BETWEEN = 1e-4  # where a column passes its buckling load all but neutral, before the last common state
LOAD = 1e-4  # within which a critical point is bracketed
UNCHANGED = (1.0, 1.0, 1.0)
ROWS = 3  # states of a path that are verified
MANY = 200  # steps of the fine run, nearly
PLACE = 1e-10  # of the prescribed displacement: the top is there to what rounding sums up to
STEPPED = 1e-3  # of its time, by which a run goes beyond a critical point that it stepped over
KINDS = ("mirror", "binary", "units", "perturbed")
PERTURBATION = 1e-12  # of the input
# The most that a kind may change the answer; rounding, of the first two, as much over the least stiffness.
ANSWER = {"mirror": 1e-10, "binary": 1e-10, "units": 1e-6, "perturbed": 2.0 * SOLVER}
SOFT = 1e-6  # stiffness over that at rest, below which small changes of the input may count
CRITICAL_SHIFT = 1e-7  # of a critical time; its bracket is 2e-9 wide


class Bounds(NamedTuple):
    """What other steps may change."""

    branch: float  # tips at the last common state, over the largest displacement
    critical: float  # the critical time
    between: float  # tips before


def bounds_of(run: Case | EquilibriumPath) -> Bounds:
    """Bounds for a scene by a model."""
    if path_dependent(run):
        return Bounds(FRICTION, FRICTION_TIME, FRICTION)
    return Bounds(BRANCH, LOAD, 0.0 if run.model == "equivbeam" else BETWEEN)


def path_dependent(run: Case | EquilibriumPath) -> bool:
    """Whether contact remembers something: friction or no sliding, in the wire model."""
    contact = run.scene.contact
    return run.model == "wirefe" and contact.enabled and contact.sliding != "free"


def deviation(
    path: EquilibriumPath,
    other: EquilibriumPath,
    back: Sequence[float] = UNCHANGED,
    until: float = np.inf,
) -> tuple[float, float]:
    """Difference of the tips over the largest displacement: at the last common time, and the largest.

    Rotations count as displacements at the coil's diameter; `back` are factors of the other path's tips;
    times beyond `until` are left out. Near a critical point runs with friction are too soft to be compared.
    """
    if path_dependent(path):
        ends = [run.critical_time for run in (path, other) if run.critical_time is not None]
        until = min(until, (1.0 - NEAR_CRITICAL) * min(ends, default=np.inf))
    times, mine, theirs = np.intersect1d(path.times, other.times, return_indices=True)
    mine, theirs = mine[times <= until], theirs[times <= until]
    if not mine.size:
        return 0.0, 0.0
    size = np.array([1.0, 1.0, largest_diameter(path.scene.spring)])
    tips, others = path.tips[mine] * size, other.tips[theirs] * size * back
    shares = np.abs(tips - others).max(axis=1) / np.abs(others).max()
    return float(shares[-1]), float(shares.max())


def grain(path: EquilibriumPath) -> float:
    """What is unknown of the largest displacement, as a share of it: positions are rounded, those of a stack
    coil by coil, and the places where sticking pairs touch and open are located so closely."""
    largest, spring = np.abs(path.tips[:, :2]).max(initial=0.0), path.scene.spring
    sticks = path_dependent(path) and path.scene.contact.sliding == "none"
    stacked = spring.active_coils if path.active_contacts.any() else 1.0
    finest = max(_rounding(spring) * stacked, STICKS * spring.wire_diameter * sticks)
    return finest / largest if largest > 0.0 else 0.0


def force_grain(path: EquilibriumPath, row: int | None = None) -> float:
    """What the rounding of the positions makes of a hard pair's force, across the wires or along them where
    it sticks, as a share of the largest load up to a row, or up to the path's end."""
    contact, states = path.scene.contact, path.states
    load = float(np.abs(path.loads).max(initial=0.0)) if row is None else largest_load(path, row)
    if row is None and path.last_state is not None and path.end_bracket is not None:  # beyond the last row
        states = np.concatenate((states, path.last_state[None]))
        load = max(load, path.end_bracket[0] * float(np.abs(path.scene.load.force).max()))
    depth = float(deepest(path, states).max(initial=0.0))
    if not (depth > 0.0 and load > 0.0):
        return 0.0
    # the scene's stiffness is that of a pair at 4 a turn: the beam has 2; of the wire a node may be touched
    # from both sides, by all that stand on an element
    spring, K, k = path.scene.spring, 2.0 * contact.stiffness, contact.exponent
    if path.model == "wirefe":
        options: Mapping[str, Any] = path.options
        K *= 4.0 / min(options["pairs_per_turn"], options["elements_per_turn"])
    across = K * k * depth ** (k - 1.0)
    along = K * spring.wire_diameter ** (k - 1.0) * (contact.sliding != "free")
    gaps = GAPS[contact.geometry if path.model == "wirefe" else "spheres"]
    return gaps * _rounding(spring) * max(across, along) / load


def _rounding(spring: Spring) -> float:
    """How fine positions are, mm: the height, or the radius, is the largest of them."""
    return ROUNDING * max(spring.active_height, 0.5 * largest_diameter(spring))


def largest_load(path: EquilibriumPath, row: int) -> float:
    """Largest load of a path up to a row, N: a reaction may pass through zero."""
    return float(np.hypot(*path.loads[: row % len(path.times) + 1].T).max())


def compare(
    verdict: Verdict,
    path: EquilibriumPath,
    other: EquilibriumPath,
    verify: Callable[[Verdict, float], None],
) -> None:
    """Take what `verify` finds of two runs; where they differ, and one says that from some time on coils
    can hold other forces, they are compared up to there."""
    for until in dict.fromkeys((np.inf, _undecided(path, other))):
        found = Verdict(numbers=dict(verdict.numbers))
        verify(found, until)
        if not found.complaints:
            break
    if until < np.inf and not found.complaints:
        verdict.others.append(other)
    verdict.numbers = found.numbers
    verdict.complaints += found.complaints


def _undecided(path: EquilibriumPath, other: EquilibriumPath, time: float = 1.0) -> float:
    """Time from which on one of two runs says that others are possible; the second ends at a `time` of the
    first. Infinite where neither does."""
    both = (1.0, path.undecided_time), (time, other.undecided_time)
    return min((share * since for share, since in both if since is not None), default=np.inf)


def end_alike(path: EquilibriumPath, other: EquilibriumPath) -> bool:
    """Whether two runs have one outcome, or two of which rounding or friction decides.

    Which kind of critical point it is may depend on rounding alone. Next to one the state moves without
    bound: with friction, whether wires overlap before is known no better than the critical time.
    """
    kinds = {CRITICAL[0] if run.outcome in CRITICAL else run.outcome for run in (path, other)}
    return len(kinds) == 1 or (path_dependent(path) and kinds == {CRITICAL[0], "interpenetration"})


def verify_branch(
    verdict: Verdict, path: EquilibriumPath, other: EquilibriumPath, name: str, until: float = np.inf
) -> None:
    """The path must be the other run's, and end as that does, but for what ends by the iteration, or beyond
    `until`."""
    bounds = bounds_of(path)
    most = max(bounds.branch, SOLVER / max(verdict.numbers.get("least", 1.0), 1e-12) ** 0.5, grain(path))
    last, largest = deviation(path, other, until=until)
    verdict.ask("branch", last, most, f"off the branch of the {name}")
    verdict.ask("branch", largest, max(most, bounds.between), f"off the branch of the {name} before the end")
    if "not_converged" in (path.outcome, other.outcome) or until < np.inf:
        return
    if not end_alike(path, other):
        verdict.complain(f"{path.outcome}, but the {name} ends as {other.outcome}: {other.message}")
    if path.end_bracket is not None and other.end_bracket is not None:
        (low, high), (first, last) = path.end_bracket, other.end_bracket
        mine, theirs, width = low + high, first + last, high - low + last - first
        scale = max(mine, theirs, LOAD)
        most = max(bounds.critical, width / scale)
        verdict.ask(
            "critical_shift", abs(mine - theirs) / scale, most, f"another critical time than the {name}'s"
        )


def verify_steps(verdict: Verdict, case: Case, path: EquilibriumPath) -> None:
    """The path must be that of one step and that of 200: one outcome, one critical time, the same tips.

    Neither run may go on beyond a critical point at which the other ends.
    """
    beyond, steps = max(STEPPED, bounds_of(case).critical), case.scene.load.steps
    fine = steps * max(round(MANY / steps), 2)  # so that the path's times are among its own
    for name, count in (("run in one step", 1), ("fine run", fine)):
        if count == steps:
            continue
        other = reached(case, steps=count)
        verdict.stop(name, other)
        verdict.numbers.setdefault("stepped", 0.0)

        def verify(found: Verdict, until: float, name: str = name, other: EquilibriumPath = other) -> None:
            for stops, who, goes in ((other, "the path", path), (path, f"the {name}", other)):
                if stops.outcome in CRITICAL and stops.critical_time is not None and until == np.inf:
                    end = max([0.0, *goes.times[-1:], *(goes.end_bracket or ())[:1]])
                    if end > stops.critical_time * (1.0 + beyond):
                        found.numbers["stepped"] = 1.0
                        found.complain(f"{who} stepped over a critical point at {stops.critical_time:.6g}")
            verify_branch(found, path, other, name, until)

        compare(verdict, path, other, verify)


def verified_rows(path: EquilibriumPath) -> set[int]:
    """States of a path that are verified, the last among them."""
    count = len(path.times)
    return {count - 1 - (count * k) // ROWS for k in range(ROWS)} & set(range(count))


def verify_place(verdict: Verdict, path: EquilibriumPath, row: int, y: float) -> None:
    """The top's y must be where it is prescribed."""
    scene, time = path.scene, float(path.times[row])
    (displacement,) = scene.load.displacement
    share = abs(y - scene.spring.active_height - time * displacement) / abs(displacement)
    most = max(PLACE, _rounding(scene.spring) / abs(displacement))
    verdict.ask("place", share, most, f"top elsewhere at time {time:.6g}")


def sharp_critical(verdict: Verdict, path: EquilibriumPath) -> float | None:
    """Critical time, whose bracket must be small; None where the path has none."""
    critical, width = path.critical_time, path.critical_bracket
    if critical is None or width is None:
        verdict.complain(f"{path.outcome} without a critical time")
        return None
    if not critical > 0.0:
        verdict.complain(f"{path.outcome} at rest")
        return None
    most = max(LOAD, LEAST_WIDTH / critical)
    verdict.ask("bracket", width / critical, most, "critical time is not that sharp")
    return critical


def just_before(
    verdict: Verdict, case: Case, path: EquilibriumPath, shares: Sequence[float]
) -> list[EquilibriumPath]:
    """Paths of the case up to shares before a path's critical time; none where one is not reached."""
    assert path.critical_time is not None
    paths: list[EquilibriumPath] = []
    for share in shares:
        time = path.critical_time * (1.0 - share)
        paths.append(reached(case, under(case.scene, time)))
        if paths[-1].outcome != "completed":
            ends_early(verdict, path, paths[-1], time)
            return []
    return paths


def ends_early(verdict: Verdict, path: EquilibriumPath, other: EquilibriumPath, time: float) -> None:
    """Complain of a run, to a `time` before a path's critical one, that ends on the way, unless one of the
    two says that from before there on coils can hold other forces, or it is as near as the critical time of
    a path with friction is known."""
    assert other.end_bracket is not None
    assert path.critical_time is not None
    ended, known = time * other.end_bracket[0], path.critical_time * (1.0 - FRICTION_TIME)
    if ended >= _undecided(path, other, time) * (1.0 - FRICTION_TIME):
        verdict.others.append(other)
    elif not (path_dependent(path) and end_alike(path, other) and ended >= known):
        verdict.complain(f"just before the critical time {path.critical_time:.6g}: {other.outcome}")


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
            spring=resized(spring, 1.0, taller),
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
    other = reached(case, scene)
    verdict.stop(kind, other)

    def verify(found: Verdict, until: float) -> None:
        _verify_changed(found, case, path, other, (kind, back, until))

    compare(verdict, path, other, verify)
    return kind


def _verify_changed(
    verdict: Verdict,
    case: Case,
    path: EquilibriumPath,
    other: EquilibriumPath,
    change: tuple[str, Sequence[float], float],
) -> None:
    """The path must be that of the changed scene, up to a time; `change`: its kind, the factors that bring
    its tips back, and that time."""
    (kind, back, until), least = change, verdict.numbers.get("least", 1.0)
    ends = path.outcome, other.outcome
    if until == np.inf and "not_converged" not in ends and not end_alike(path, other):
        verdict.complain(f"{kind}: {ends[0]}, but changed it ends as {ends[1]}")
    elif kind != "perturbed" or least > SOFT:
        answer = ANSWER[kind] / (least if kind in KINDS[:2] else 1.0)
        loose = bounds_of(case) if path_dependent(case) else Bounds(0.0, 0.0, 0.0)
        # two runs may end a step of Newton's method apart: what the verified states are from equilibrium
        missing = 2.0 * verdict.numbers.get("residual", 0.0) / max(least, 1e-12) ** 0.5
        most = max(answer, loose.branch, grain(path), missing)
        verdict.ask("invariance", deviation(path, other, back, until)[1], most, f"{kind} changes the answer")
        if path.critical_time is not None and other.critical_time is not None and until == np.inf:
            scale = max(path.critical_time, LOAD)
            shift = abs(path.critical_time - other.critical_time) / scale
            known = sum(each.critical_bracket or 0.0 for each in (path, other)) / scale
            most = max(CRITICAL_SHIFT, loose.critical, force_grain(path) + force_grain(other), known)
            verdict.ask("critical_shift", shift, most, f"{kind} shifts the critical time")
