"""Regressions: what both models find now against baselines (``coilcheck regress``)."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from contextlib import ExitStack
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from coilspring import Scene
from validation.regress import baselines, timeratios
from validation.regress.baselines import MODELS, Run, find, made, read, runs, runs_of
from validation.regress.comparison import Move, compare
from validation.study.cases import make_ready
from validation.study.document import Table
from validation.study.output import claimed, write_text


@dataclass(frozen=True)
class Finding:
    """What a regression run found."""

    moves: tuple[Move, ...]  # what moved; empty where there was nothing to compare with, too
    compared: int  # number of runs
    accepted: bool  # whether the baselines were written anew
    left_out: tuple[str, ...] = ()  # a sentence on each thing that cannot be had of these scenes

    @property
    def verdict(self) -> str:
        """The outcome in a few words."""
        found = f"{len(self.moves)} quantities moved" if self.moves else "nothing moved"
        return f"{self.compared} runs: {found}{'; accepted as the new baselines' if self.accepted else ''}"


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
    out : folder for ``regress.md`` and a JSON file a model, also of what was found before an interruption.
    baseline : folder of the baselines.
    accept : write what was found as the new baselines, with the ratios of times.
    times : measure and compare the ratios of times too.
    progress : called with one line on what is being done.
    scene : a user's scene; by default the catalogue's.
    chosen : runs; by default all of `baselines.runs_of` the scene, or of `baselines.runs`.

    Raises
    ------
    InputError : baselines that are missing or cannot be read, unless they are about to be written; a scene
        that neither model represents.
    """
    first = accept and not any((baseline / f"{model}.json").exists() for model in MODELS)
    kept = None if first else read(baseline)
    with ExitStack() as claims:
        for folder in (out, baseline) if accept else (out,):
            claims.enter_context(claimed(folder))
        progress("making the kernels ready")
        make_ready()
        watched = chosen or (runs() if scene is None else runs_of(scene))
        found, left_out = find(watched, progress, out)
        moves = compare(kept, found, str(made()["processor"])) if kept else ()
        if times or accept:
            ratios, untimed = timeratios.measure(progress, scene)
            left_out += untimed
            timeratios.write(ratios, out)
            moves += timeratios.compare(baseline, ratios) if times and kept else ()
        if accept:
            baselines.write(found, baseline)
            timeratios.write(ratios, baseline)
        finding = Finding(moves, sum(map(len, found.values())), accept, left_out)
        write_text(out / "regress.md", _report(finding, kept))
        return finding


def _report(finding: Finding, kept: dict[str, dict[str, Any]] | None) -> str:
    parts = ["# Regression", f"**{finding.verdict}.**", *(f"{line}." for line in finding.left_out)]
    if kept:
        origin = ("{date} on {processor}".format(**each) for each in (kept[MODELS[0]]["made"], made()))
        parts.append("Baselines of {}; compared {}.".format(*origin))
    if finding.moves:
        parts.append(str(Table(("run", "quantity", "was", "is", "by how much"), finding.moves)))
    return "\n\n".join(parts) + "\n"
