"""Regressions: what both models find now against baselines (``coilcheck regress``).

Tolerances are those of repeated solves: equilibria are converged to rounding, so that what moves more
was changed. Paths with sticking contact depend on the accepted substeps, which another processor may choose
differently. Counts are exact on the same kind of processor and within one a step elsewhere; of a step with
many iterations within a third of them, since rounding decides how often it is cut back.
"""

import os
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import ExitStack
from dataclasses import dataclass, replace
from itertools import zip_longest
from pathlib import Path
from typing import Any, NamedTuple

from coilspring import Scene, load_scene
from coilspring.curves import NEGLIGIBLE
from coilspring.scene.scene import SECTIONS
from coilspring.scene.toml import scene_table, scene_text
from coilspring.words import counted, rounded
from validation.regress import baselines, timeratios
from validation.regress.baselines import Quantities, Run, find, made, of_runs, read, runs, runs_of
from validation.study.files import claimed, write_text, writing
from validation.study.models import MODELS
from validation.study.paths import make_ready
from validation.study.tables import Table

SCENE = "scene.toml"  # beside the baselines of a user's scene: what they are of
FORCES = ("contact_force", "force_times_number", "max_penetration")
# of a quantity by its first word
UNITS = {"rotz": " rad"} | dict.fromkeys(("ux", "uy", "max_penetration"), " mm")
UNITS |= dict.fromkeys(("load_y", "contact_force", "force_times_number"), " N")
COUNTS = ("iterations", "active_contacts")
TIP = 1e-7  # of the component's peak, or of the largest one's where it is fixed
FORCE = 1e-5  # of the value: a penalty turns rounding of positions into forces
CRITICAL = 1e-7  # of time: brackets of critical points are about 1e-9
SENSITIVE = 1e-4  # of time, where rounding decides where the critical point is found
ELSEWHERE = 10.0  # times wider on another kind of processor
MANY = 1.0 / 3.0  # share of a step's iterations, there
PATH_DEPENDENT = 1e-4  # of tips, without sliding, on another kind of processor
ROUNDING = 1e-12  # mm or N; what is smaller is 0
Texts = Iterator[tuple[str, str, str, str]]  # fields of a `Move`, without the run


class Move(NamedTuple):
    """One quantity that is not what it was."""

    run: str  # model and name of the run
    quantity: str  # what moved, and where
    before: str  # its value in the baselines
    now: str  # its value now
    measure: str  # by how much, and how much is allowed

    def __str__(self) -> str:
        return f"{self.run}: {self.quantity} was {self.before}, is {self.now} ({self.measure})"


@dataclass(frozen=True)
class Finding:
    """What a regression run found."""

    moves: tuple[Move, ...]  # what moved; empty where there was nothing to compare with, too
    compared: int  # number of runs
    accepted: bool  # whether the baselines were written anew
    left_out: tuple[str, ...] = ()  # a sentence on each thing that cannot be had of these scenes
    first: bool = False  # whether there were no baselines before

    @property
    def verdict(self) -> str:
        """The outcome in a few words."""
        if self.first:
            return f"{counted(self.compared, 'baseline')} written"
        count = len(self.moves)
        found = f"{count} quantit{'y' if count == 1 else 'ies'} moved" if count else "nothing moved"
        accepted = "; accepted as the new baselines" if self.accepted else ""
        return f"{counted(self.compared, 'run')}: {found}{accepted}"


def regress(
    out: Path,
    baseline: Path,
    accept: bool = False,
    times: bool = False,
    progress: Callable[[str], None] = lambda line: None,
    scene: Scene | None = None,
    chosen: Sequence[Run] | None = None,
) -> Finding:
    """Run what is watched and compare it with the baselines.

    Parameters
    ----------
    out : folder for ``regress.md`` and a JSON file a model.
    baseline : folder of the baselines.
    accept : write what was found as the new baselines, with the ratios of times.
    times : measure and compare the ratios of times too.
    progress : called with one line on what is being done.
    scene : a user's scene; by default the catalogue's.
    chosen : runs, with whose baselines alone they are compared; by default all of `baselines.runs_of` the
        scene, or of `baselines.runs`.

    Raises
    ------
    InputError : baselines that are missing or cannot be read, unless they are about to be written; a scene
        that neither model represents.
    """
    with writing(baseline):
        first = accept and not any((baseline / f"{model}.json").exists() for model in MODELS)
    kept = None if first else read(baseline)
    with ExitStack() as claims:
        for folder in (out, baseline) if accept else (out,):
            claims.enter_context(claimed(folder))
        progress("making the kernels ready")
        make_ready()
        watched = chosen or (runs() if scene is None else runs_of(scene))
        if chosen and kept:
            kept = of_runs(kept, chosen)
        found, left_out = find(watched, progress)
        baselines.write(found, out)
        moves = compare(kept, found, str(made()["processor"])) if kept else ()
        if scene is not None and kept and (baseline / SCENE).is_file():
            moves = (*_scene_moves(load_scene(baseline / SCENE), scene), *moves)
        if times or accept:
            ratios, untimed = timeratios.measure(progress, scene)
            left_out += untimed
            timeratios.write(ratios, out)
            changed = timeratios.compare(baseline, ratios) if times and kept else ()
            moves += tuple(Move("times", *each) for each in changed)
        if accept:
            baselines.write(found, baseline)
            if scene is not None:
                write_text(baseline / SCENE, scene_text(scene))
            timeratios.write(ratios, baseline)
        finding = Finding(moves, sum(map(len, found.values())), accept, left_out, first)
        write_text(out / "regress.md", _page(finding, kept))
        return finding


def _page(finding: Finding, kept: Mapping[str, Mapping[str, Any]] | None) -> str:
    """The finding as Markdown; `kept`: the baselines, where there were any."""
    parts = ["# Regression", f"**{finding.verdict}.**", *(f"{line}." for line in finding.left_out)]
    if kept:
        origin = ("{date} on {processor}".format(**each) for each in (kept[MODELS[0]]["made"], made()))
        parts.append("Baselines of {}; compared {}.".format(*origin))
    if finding.moves:
        parts.append(str(Table(("run", "quantity", "was", "is", "by how much"), finding.moves)))
    return "\n\n".join(parts) + "\n"


def kept_scenes(folder: Path) -> dict[str, Scene]:
    """Scenes of a user's baselines in a folder, by name; none where it holds those of the catalogue."""
    files = sorted(folder.glob(f"*/{SCENE}")) if os.path.isdir(folder) else []
    return {file.parent.name: replace(load_scene(file), name=file.parent.name) for file in files}


def _scene_moves(before: Scene, now: Scene) -> Iterator[Move]:
    """Keys of the scene that are not those of the baselines."""
    was, new = scene_table(before), scene_table(now)
    for section in SECTIONS:
        for key in dict.fromkeys((*was[section], *new[section])):
            old, given = (str(rounded(table[section].get(key, "not given"))) for table in (was, new))
            if old != given:
                yield Move("the scene", f"{section}.{key}", old, given, "the baselines are of another scene")


def compare(
    kept: Mapping[str, Mapping[str, Any]], found: Mapping[str, Mapping[str, Quantities]], processor: str
) -> tuple[Move, ...]:
    """What moved in runs `found` on a processor since the baselines `kept`; a run that only one of them has
    counts as moved."""
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
                moves += [Move(run, *each) for each in _moved(before[name], now[name], here)]
    return tuple(moves)


def _moved(before: Quantities, now: Quantities, here: bool) -> Texts:
    """What moved in one run."""
    for name in sorted(now.keys() - before.keys()):
        yield name, "not in the baselines", "new", "accept to keep it"
    for name in sorted(before.keys() - now.keys()):
        yield name, "in the baselines", "missing", "accept to forget it"
    before = now | before  # the others are compared
    a, b = before["critical_time"], now["critical_time"]
    both = a is not None and b is not None
    for name in ("outcome", "steps_reached", *(() if both else ("critical_time",))):
        if before[name] != now[name]:
            yield name, str(before[name]), str(now[name]), "exact"
    if both:
        allowed = SENSITIVE if now["sensitive"] else CRITICAL * (1.0 if here else ELSEWHERE)
        yield from _value("critical_time", a, b, 1.0, "of time", allowed)
    wider = 1.0 if here else (PATH_DEPENDENT / TIP if now["remembers"] else ELSEWHERE)
    if before["times"] == now["times"]:
        largest = max(before["peaks"].values())
        for name, peak in before["peaks"].items():
            scale = peak if peak > NEGLIGIBLE * largest else largest
            yield from _curve(name, before, now, scale, TIP * wider)
        force = max(map(abs, (*before["load_y"], *now["load_y"])), default=0.0)
        yield from _curve("load_y", before, now, force, FORCE * wider)
        for name in FORCES:
            a, b = before[name], now[name]
            scale = max(abs(a), abs(b))
            yield from _value(f"{name} at the last step", a, b, scale, "of the value", FORCE * wider)
    for name in COUNTS:
        many = MANY if name == "iterations" else 0.0
        yield from _counts(name, before[name], now[name], (0, 0.0) if here else (1, many))
    a, b = before["total_iterations"], now["total_iterations"]  # those after the last step included
    each = sum(max(1, int(MANY * count)) for count in before["iterations"])
    extra = 0 if here else each + a // 10  # cut-backs before a critical point may differ
    if not now["sensitive"] and abs(b - a) > extra:
        yield "total_iterations", str(a), str(b), f"{b - a:+d}, {extra} allowed"


def _value(what: str, before: float, now: float, scale: float, unit: str, allowed: float) -> Texts:
    """A number that moved by more than the allowed part of a scale."""
    if abs(now - before) > allowed * scale + ROUNDING:
        by = f"{(now - before) / scale:+.2g} {unit}, {allowed:.0e} allowed"
        of = UNITS.get(what.partition(" ")[0], "")
        yield what, f"{before:.9g}{of}", f"{now:.9g}{of}", by


def _curve(name: str, before: Quantities, now: Quantities, scale: float, allowed: float) -> Texts:
    """The time at which a component moved most."""
    rows = zip(now["times"], before[name], now[name], strict=True)
    time, a, b = max(rows, key=lambda row: abs(row[2] - row[1]), default=(0.0, 0.0, 0.0))
    yield from _value(f"{name} at time {time:g}", a, b, scale, "of the peak", allowed)


def _counts(name: str, before: list[int], now: list[int], spare: tuple[int, float]) -> Texts:
    """The first step whose count moved, and how many did, by more than is allowed: a number, or a share."""
    pairs = enumerate(zip_longest(before, now, fillvalue=0), start=1)
    most, share = spare
    moved = [(step, a, b) for step, (a, b) in pairs if abs(b - a) > max(most, share * a)]
    if moved:
        step, a, b = moved[0]
        allowed = max(most, int(share * a))
        steps = counted(len(moved), "step")
        measure = f"{sum(now) - sum(before):+d} in all, {steps} moved, {allowed} allowed a step"
        yield f"{name} at step {step}", str(a), str(b), measure
