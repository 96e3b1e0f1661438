"""Commands that judge the models: each gives the lines to be said, and in one sentence what is wrong."""

from __future__ import annotations

import argparse
import importlib
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
    extent = next((name for name in ("quick", "full") if hasattr(arguments, name)), "normal")
    progress(LOADING)
    run = importlib.import_module("validation.workprecision.run").workprecision
    with claimed(folder), writing(folder):
        studies = run(folder, getattr(arguments, "only", None), extent, progress)
    digest = importlib.import_module("validation.workprecision.page").digest
    return [*map(digest, studies), f"written to {folder}"], ""


def sensitivity(arguments: argparse.Namespace, folder: Path, progress: Progress) -> Answer:
    """Vary what the paper leaves open in both models."""
    progress(LOADING)
    run = importlib.import_module("validation.sensitivity.run").sensitivity
    with claimed(folder), writing(folder):
        studies = run(folder, getattr(arguments, "only", None), progress)
    digest = importlib.import_module("validation.sensitivity.page").digest
    return [*map(digest, studies), f"written to {folder}"], ""


def regress(arguments: argparse.Namespace, folder: Path, progress: Progress) -> Answer:
    """Compare what both models find with stored baselines."""
    progress(LOADING)
    regression = importlib.import_module("validation.regress.run")
    accept, times = hasattr(arguments, "accept"), hasattr(arguments, "time")
    with writing(folder):
        finding = regression.regress(folder, arguments.baseline, accept, times, progress)
    verdict = regression.verdict(finding)
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
    campaign = importlib.import_module("validation.campaign.run").campaign
    with claimed(folder) if writes else nullcontext(), writing(folder):
        code = campaign(folder, **options, progress=lambda done, of: progress(f"{done} of {of} scenes"))
    lines = [f"written to {folder}"] if writes else []
    return lines, "not every outcome is explained" if code else ""


COMMANDS = {
    "workprecision": workprecision,
    "sensitivity": sensitivity,
    "regress": regress,
    "stability": stability,
}
