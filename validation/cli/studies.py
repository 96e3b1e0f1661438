"""Commands that study the models: each gives the lines to be said, and in one sentence what is wrong."""

from __future__ import annotations

import argparse
from collections.abc import Callable
from contextlib import nullcontext
from pathlib import Path

from coilspring.errors import InputError, require_integer
from validation.cli.arguments import CAMPAIGN_RANGES, given
from validation.study.output import claimed, writing

Progress = Callable[[str], None]
Answer = tuple[list[str], str]
LOADING = "loading both models"


def workprecision(arguments: argparse.Namespace, folder: Path, progress: Progress) -> Answer:
    """Measure run time against error of both models."""
    extent = next((name for name in ("quick", "full") if getattr(arguments, name)), "normal")
    progress(LOADING)
    from validation.workprecision import page, run

    with claimed(folder), writing(folder):
        if arguments.page:
            rows = page.write(folder, drawn=True)
        else:
            rows = run.workprecision(folder, arguments.only, extent, progress)
    return [*page.digest(rows), f"written to {folder}"], ""


def sensitivity(arguments: argparse.Namespace, folder: Path, progress: Progress) -> Answer:
    """Vary what the paper leaves open in both models."""
    progress(LOADING)
    from validation.sensitivity import page, run

    with claimed(folder), writing(folder):
        studies = run.sensitivity(folder, arguments.only, progress)
    return [*map(page.digest, studies), f"written to {folder}"], ""


def regress(arguments: argparse.Namespace, folder: Path, progress: Progress) -> Answer:
    """Compare what both models find with stored baselines."""
    progress(LOADING)
    from validation.regress import run

    accept, times = arguments.accept, arguments.time
    with writing(folder):
        finding = run.regress(folder, arguments.baseline, accept, times, progress)
    verdict = run.verdict(finding)
    lines = [*map(str, finding.moves), verdict, f"written to {folder}"]
    moved = finding.moves and not accept
    return lines, f"{verdict}; where that is meant: regress --accept" if moved else ""


def stability(arguments: argparse.Namespace, folder: Path, progress: Progress) -> Answer:
    """Judge sampled scenes of both models."""
    options = given(arguments, ("case", "scheduler"))
    for name, number in given(arguments, tuple(CAMPAIGN_RANGES)).items():
        options[name] = require_integer(name, number, *CAMPAIGN_RANGES[name])
    options["seeds"] = _seeds(options.pop("seed", None), arguments.seeds)
    writes = "case" not in options
    progress(LOADING)
    from validation.campaign.run import campaign

    with claimed(folder) if writes else nullcontext(), writing(folder):
        code = campaign(folder, **options, progress=lambda done, of: progress(f"{done} of {of} scenes"))
    lines = [f"written to {folder}"] if writes else []
    return lines, "not every outcome is explained" if code else ""


def _seeds(one: int | None, listed: str | None) -> tuple[int, ...]:
    """Seeds of a campaign, each once.

    Raises
    ------
    InputError : both options are given, or the list is none of whole numbers.
    """
    if listed is None:
        return (1 if one is None else one,)
    if one is not None:
        raise InputError(f"--seed or --seeds, not both, got {one} and {listed}")
    parts = [part.strip() for part in listed.split(",")]
    if not all(part.isdecimal() for part in parts):
        raise InputError(f"seeds must be whole numbers with commas between, as 1,2,3, got {listed!r}")
    return tuple(dict.fromkeys(require_integer("seeds", int(part), *CAMPAIGN_RANGES["seed"]) for part in parts))


COMMANDS = {
    "workprecision": workprecision,
    "sensitivity": sensitivity,
    "regress": regress,
    "stability": stability,
}
