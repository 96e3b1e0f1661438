"""Run time against error of both models: what a given accuracy costs (``coilcheck workprecision``).

The error of a path is its distance from a reference (`validation.study.metrics`): the curved wire mesh of
`Extent.reference` elements a turn in `Extent.finest` steps. The reference's own error is told by half
its mesh and by half its steps; where there is no contact, the exact rod bears it out.

The time is the CPU time of the solve alone, one thread, kernels warm. All settings of a scene run in
turn, round after round, so that a disturbance of the machine falls on all; ratios are formed within a
round.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path

import numpy as np

from coilspring import EquilibriumPath, InputError, Scene
from coilspring.errors import require_names
from validation.study.cases import solve_beam, solve_wire
from validation.study.metrics import compare_paths
from validation.study.output import prepare
from validation.study.partialsolve import as_far
from validation.study.provenance import write_provenance
from validation.study.scenes import study_scenes
from validation.study.timing import Spread
from validation.study.warmup import make_ready
from validation.workprecision import figures, page, penaltysweep
from validation.workprecision.peer import peer_points
from validation.workprecision.penaltysweep import Sweep
from validation.workprecision.points import Point, Study
from validation.workprecision.reference import reference
from validation.workprecision.settings import EXTENTS, Extent, Setting, settings

SHORT, MOST_REPEATS = 0.02, 5  # s; a shorter solve is repeated within a round


def workprecision(
    out: Path,
    only: Sequence[str] | None = None,
    extent: str = "normal",
    progress: Callable[[str], None] = lambda line: None,
) -> tuple[Study, ...]:
    """Measure all scenes and write ``workprecision.csv``, ``.md`` and the figures to `out`.

    Parameters
    ----------
    out : folder, made where missing. The tables are written anew after every scene.
    only : names of scenes; None for all.
    extent : "quick", "normal" or "full".
    progress : called with one line on what is being done.

    Raises
    ------
    InputError : an unknown name or extent.
    """
    if extent not in EXTENTS:
        raise InputError(f"extent must be one of {', '.join(EXTENTS)}, got {extent!r}")
    scenes = _chosen(only)
    out = Path(out)
    prepare(out)
    progress("making the kernels ready")
    make_ready()
    studies: tuple[Study, ...] = ()
    sweeps: tuple[Sweep, ...] = ()
    for scene in scenes:
        studies += (study(scene, EXTENTS[extent], progress),)
        if scene.name in penaltysweep.SCENES:
            sweeps += (penaltysweep.sweep(scene, EXTENTS[extent].rounds, progress),)
        page.write(studies, sweeps, EXTENTS[extent], out, drawn=False)
    progress("drawing")
    figures.write(studies, sweeps, out)
    page.write(studies, sweeps, EXTENTS[extent], out, drawn=True)
    write_provenance(_command(only, extent), out)
    return studies


def _command(only: Sequence[str] | None, extent: str) -> str:
    size = [] if extent == "normal" else [f"--{extent}"]
    return " ".join(["coilcheck workprecision", *size, *([f"--only {','.join(only)}"] if only else [])])


def _chosen(only: Sequence[str] | None) -> list[Scene]:
    scenes = study_scenes()
    require_names("only", only or (), scenes)
    return [scene for name, scene in scenes.items() if only is None or name in only]


def study(scene: Scene, extent: Extent, progress: Callable[[str], None]) -> Study:
    """Errors and times of all settings on one scene."""
    progress(f"{scene.name}: reference")
    best = reference(scene, extent)
    runs = settings(scene, extent)
    paths = []
    for setting in runs:
        progress(f"{scene.name}: {setting.label}")
        paths.append(reached(scene, setting))
    rounds = []
    for number in range(extent.rounds):
        progress(f"{scene.name}: timing, round {number + 1} of {extent.rounds}")
        rounds.append([_seconds(scene, *run) for run in zip(runs, paths, strict=True)])
    seconds = np.array(rounds).T
    paper = seconds[[setting.is_paper_mesh for setting in runs]][0]
    ratios = seconds / paper
    points = (
        Point(
            setting=setting,
            outcome=path.outcome,
            error=compare_paths(path, best.path),
            ratio=Spread.of(ratio),
            seconds=Spread.of(ratio * np.median(paper)),
            iterations=path.total_iterations,
        )
        for setting, path, ratio in zip(runs, paths, ratios, strict=True)
    )
    peers = peer_points(scene, extent, best, float(np.median(paper)), progress)
    return Study(scene, best, tuple(points), Spread.of(paper), peers)


def reached(scene: Scene, setting: Setting) -> EquilibriumPath:
    """Path of one setting, complete or as far as it was reached."""
    return as_far(solve_wire if setting.mesh else solve_beam, scene, **setting.options)


def _seconds(scene: Scene, setting: Setting, known: EquilibriumPath) -> float:
    """CPU seconds of one more solve; the median of several where it is short."""
    repeats = int(np.clip(SHORT / max(known.solve_seconds, 1e-6), 1, MOST_REPEATS))
    return float(np.median([reached(scene, setting).solve_seconds for _ in range(repeats)]))
