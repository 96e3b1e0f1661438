"""What moved between two sets of quantities, and by how much.

Tolerances are those of repeated solves: equilibria are converged to rounding, so that what moves more
was changed. Paths that do not slide remember the accepted substeps, which another processor may choose
differently. Counts are exact on the same kind of processor and within one a step elsewhere.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from itertools import zip_longest
from typing import Any

from validation.regress.baselines import COUNTS, CURVES, FORCES, MODELS, Quantities

TIP = 1e-7  # of the component's peak, or of the largest one's where it is held
FORCE = 1e-5  # of the value: a penalty turns rounding of positions into forces
CRITICAL = 1e-7  # of time: brackets of critical points are about 1e-9
SENSITIVE = 1e-4  # of time, where rounding decides where the critical point is found
ELSEWHERE = 10.0  # times wider on another kind of processor
PATH_DEPENDENT = 1e-4  # of tips, without sliding, on another kind of processor
HELD = 1e-9  # of the largest peak; a component with a smaller one is held
ROUNDING = 1e-12  # mm or N; what is smaller is 0


@dataclass(frozen=True)
class Move:
    """One quantity that is not what it was.

    Attributes
    ----------
    run : model and name of the run.
    quantity : what moved, and where.
    before, now : its values.
    measure : by how much, and how much is allowed.
    """

    run: str
    quantity: str
    before: str
    now: str
    measure: str

    def __str__(self) -> str:
        return f"{self.run}: {self.quantity} was {self.before}, is {self.now} ({self.measure})"


def compare(
    kept: Mapping[str, Mapping[str, Any]], found: Mapping[str, Mapping[str, Quantities]], processor: str
) -> tuple[Move, ...]:
    """What moved since the baselines; a run without a baseline, or the reverse, counts as moved.

    Parameters
    ----------
    kept : by model, "made" and "runs".
    found : by model, the quantities of every run.
    processor : on which `found` was computed.
    """
    moves: list[Move] = []
    for model in MODELS:
        here = kept[model]["made"]["processor"] == processor
        before, now = kept[model]["runs"], found[model]
        for name in dict.fromkeys((*before, *now)):
            run = f"{model}, {name}"
            if name not in now:
                moves.append(Move(run, "the run", "in the baselines", "missing", "accept to forget it"))
            elif name not in before:
                moves.append(Move(run, "the run", "not in the baselines", "new", "accept to keep it"))
            else:
                moves += _run(run, before[name], now[name], here)
    return tuple(moves)


def _run(run: str, before: Quantities, now: Quantities, here: bool) -> Iterator[Move]:
    """What moved in one run."""
    missing = sorted(now.keys() ^ before.keys())
    if missing:
        yield Move(run, "the list of quantities", "without", ", ".join(missing), "accept the new list")
        return
    for name in ("outcome", "steps_reached"):
        if before[name] != now[name]:
            yield Move(run, name, str(before[name]), str(now[name]), "exact")
    allowed = SENSITIVE if now["sensitive"] else CRITICAL * (1.0 if here else ELSEWHERE)
    yield from _critical(run, before["critical_time"], now["critical_time"], allowed)
    wider = 1.0 if here else (PATH_DEPENDENT / TIP if now["remembers"] else ELSEWHERE)
    if before["times"] == now["times"]:
        for name in CURVES:
            yield from _curve(run, name, before, now, TIP * wider)
        for name in FORCES:
            yield from _force(run, name, before[name], now[name], FORCE * wider)
    for name in COUNTS:
        yield from _counts(run, name, before[name], now[name], 0 if here else 1)
    if not now["sensitive"]:
        yield from _total(run, before, now, here)


def _critical(run: str, before: float | None, now: float | None, allowed: float) -> Iterator[Move]:
    if before is None or now is None:
        if before is not now:
            yield Move(run, "critical_time", str(before), str(now), "exact")
        return
    if abs(now - before) > allowed:
        yield Move(run, "critical_time", f"{before:.9g}", f"{now:.9g}", _by(now - before, allowed, "of time"))


def _curve(run: str, name: str, before: Quantities, now: Quantities, allowed: float) -> Iterator[Move]:
    """The time at which a tip component moved most."""
    peak = before["peaks"][name]
    peak = peak if peak > HELD * max(before["peaks"].values()) else max(before["peaks"].values())
    moved = [abs(b - a) for a, b in zip(before[name], now[name], strict=True)]
    if not moved or max(moved) <= allowed * peak + ROUNDING:
        return
    i = moved.index(max(moved))
    where, unit = f"{name} at time {now['times'][i]:g}", "of the peak"
    a, b = before[name][i], now[name][i]
    yield Move(run, where, f"{a:.9g}", f"{b:.9g}", _by((b - a) / peak, allowed, unit))


def _force(run: str, name: str, before: float, now: float, allowed: float) -> Iterator[Move]:
    scale = max(abs(before), abs(now))
    if abs(now - before) > allowed * scale + ROUNDING:
        measure = _by((now - before) / scale, allowed, "of the value")
        yield Move(run, f"{name} at the last step", f"{before:.9g}", f"{now:.9g}", measure)


def _counts(run: str, name: str, before: list[int], now: list[int], allowed: int) -> Iterator[Move]:
    """The first step whose count moved, and how many did."""
    pairs = enumerate(zip_longest(before, now, fillvalue=0), start=1)
    moved = [(step, a, b) for step, (a, b) in pairs if abs(b - a) > allowed]
    if moved:
        step, a, b = moved[0]
        measure = f"{sum(now) - sum(before):+d} in all, {len(moved)} steps moved, {allowed} allowed a step"
        yield Move(run, f"{name} at step {step}", str(a), str(b), measure)


def _total(run: str, before: Quantities, now: Quantities, here: bool) -> Iterator[Move]:
    """Factorisations in all, those after the last step included."""
    a, b = before["total_iterations"], now["total_iterations"]
    allowed = 0 if here else now["steps_reached"] + a // 10  # cut-backs before a critical point may differ
    if abs(b - a) > allowed:
        yield Move(run, "total_iterations", str(a), str(b), f"{b - a:+d}, {allowed} allowed")


def _by(change: float, allowed: float, unit: str) -> str:
    return f"{change:+.2g} {unit}, {allowed:.0e} allowed"
