"""Commands that study the models: each gives the lines to be said, and in one sentence what is wrong."""

from __future__ import annotations

import argparse
from collections.abc import Callable
from contextlib import nullcontext
from pathlib import Path

from coilspring.errors import require_integer
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
    writes = "case" not in options
    progress(LOADING)
    from validation.campaign.run import campaign

    with claimed(folder) if writes else nullcontext(), writing(folder):
        code = campaign(folder, **options, progress=lambda done, of: progress(f"{done} of {of} scenes"))
    lines = [f"written to {folder}"] if writes else []
    return lines, "not every outcome is explained" if code else ""


def study_law(arguments: argparse.Namespace, folder: Path, progress: Progress) -> Answer:
    """Study a law of a half coil that a user wrote."""
    progress(LOADING)
    from validation.lawstudy.run import study_law as run

    lines: list[str] = []
    with claimed(folder), writing(folder):
        for law in arguments.law:
            out = folder / Path(law).stem if len(arguments.law) > 1 else folder
            lines += [*run(law, out, progress, quick=arguments.quick), f"written to {out}"]
    return lines, ""


COMMANDS = {
    "study-law": study_law,
    "workprecision": workprecision,
    "sensitivity": sensitivity,
    "regress": regress,
    "stability": stability,
}
