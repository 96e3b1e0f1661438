"""Run time against error of both models: what a given accuracy costs (``coilcheck workprecision``).

The error of a path is its distance from a reference (`coilspring.curves`): the curved wire mesh of
`Extent.reference` elements per turn in `Extent.finest` steps. The reference's own error is estimated from
half its mesh and half its steps; where there is no contact, the exact rod bears it out.

The time is the CPU time of the solve alone, one thread, kernels warm. All settings of a scene take turns
(`validation.study.timing`); ratios to the paper's FE mesh are formed within a round.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from functools import partial
from pathlib import Path

import numpy as np
import pandas as pd

from coilspring import EquilibriumNotFound, EquilibriumPath, InputError, Scene
from coilspring.curves import compare_curves, compare_paths, over_peak
from coilspring.errors import require_names
from validation.peers.comparison import opensees
from validation.study.cases import EXACT_ROD, study_scenes
from validation.study.files import prepare, write_files
from validation.study.machine import versions
from validation.study.partialsolve import partial_path
from validation.study.paths import make_ready, solve_beam, solve_wire
from validation.study.provenance import write_provenance
from validation.study.timing import announced, interleaved, median_of, quartiles
from validation.workprecision import page, results
from validation.workprecision.results import left_out, ranked, row
from validation.workprecision.settings import (
    EXTENTS,
    PAPER_ELEMENTS,
    PAPER_MODEL,
    PEER,
    STEPS,
    Extent,
    Setting,
    fitted,
    settings,
)

PENALTY_SCENES = ("spring-a", "spring-b")
PENALTIES = (1e2, 1e3, 1e4, 1e5, 1e6)  # N/mm
HARD, LESS_HARD = 1e8, 1e7  # N/mm
SHORT, MOST_REPEATS = 0.02, 5  # s; a shorter solve is repeated within a round
Progress = Callable[[str], None]


def workprecision(
    out: Path,
    only: Sequence[str] | None = None,
    extent: str = "normal",
    progress: Progress = lambda line: None,
    scenes: Mapping[str, Scene] | None = None,
) -> pd.DataFrame:
    """Measure scenes and write ``workprecision.csv``, ``.md`` and the figures to `out`; the result.

    The tables are written anew after every scene.

    Parameters
    ----------
    only : names of scenes; None for all.
    extent : "quick", "normal" or "full".
    scenes : a user's, by their names, in the place of the study's own; in `STEPS` steps of each stage.

    Raises
    ------
    InputError : an unknown name or extent; scenes that the wire model does not represent.
    EquilibriumNotFound : the reference of no scene reaches full load.
    """
    if extent not in EXTENTS:
        raise InputError(f"extent must be one of {', '.join(EXTENTS)}, got {extent!r}")
    require_names("only", only or (), study_scenes())
    out = Path(out)
    prepare(out)
    progress("making the kernels ready")
    make_ready()
    chosen = scenes or {name: s for name, s in study_scenes().items() if only is None or name in only}
    options = [] if extent == "normal" else [f"--{extent}"]
    options += ["--only", ",".join(only)] if only else []
    command = " ".join(["coilcheck workprecision", *(scenes or ()), *options])
    found: list[pd.DataFrame] = []
    failure: InputError | EquilibriumNotFound | None = None
    for name, scene in chosen.items():
        try:
            found.append(study(scene.with_steps(STEPS), EXTENTS[extent], progress))
            if name in PENALTY_SCENES:
                found.append(penalty_rows(scene, EXTENTS[extent].rounds, progress))
        except (InputError, EquilibriumNotFound) as error:
            failure = error
            paper = Setting.wire(scene, "straight", PAPER_ELEMENTS)
            outcome = getattr(error, "outcome", results.UNSUPPORTED)
            found.append(pd.DataFrame([left_out(scene, paper, f"the reference: {error}", outcome)]))
        rows = pd.concat(found, ignore_index=True)
        if (rows["role"] == "run").any():
            write_files({results.FILE: results.to_csv(rows)}, out)
            write_provenance(command, out, openseespy=versions("openseespy")["openseespy"])
            page.write(out)
        elif name == list(chosen)[-1] and failure is not None:
            raise failure
    progress("drawing")
    return page.write(out, drawn=True)


def study(scene: Scene, extent: Extent, progress: Progress) -> pd.DataFrame:
    """Errors and times of all settings on one scene."""
    progress(f"{scene.name}: reference")
    reference, rows = _reference(scene, extent)
    paths, refused = {}, dict[str, dict[str, object]]()
    for setting in settings(scene, extent):
        progress(f"{scene.name}: {setting.label}")
        try:
            paths[setting] = reached(scene, setting)
        except InputError as refusal:
            if setting.is_paper_mesh:  # in which times are measured
                raise
            refused.setdefault(str(refusal), left_out(scene, setting, f"{setting.label}: {refusal}"))
    runs = {setting: partial(_seconds, scene, setting, path) for setting, path in paths.items()}
    seconds = interleaved(runs, announced(extent.rounds, progress, f"{scene.name}: timing"))
    paper = next(seconds[setting] for setting in runs if setting.is_paper_mesh)
    for setting, path in paths.items():
        times = _times(seconds[setting] / paper, float(np.median(paper)))
        if setting.is_paper_mesh:
            times |= quartiles("seconds", paper)
        known = {"outcome": path.outcome, "iterations": path.total_iterations} | times
        rows.append(row("run", scene, setting, compare_paths(path, reference), **known))
    try:
        rows += _peer_rows(scene, extent, reference, float(np.median(paper)), progress)
    except InputError as refusal:
        peer = Setting.wire(scene, PEER, PAPER_ELEMENTS)
        refused[str(refusal)] = left_out(scene, peer, f"OpenSees: {refusal}")
    return ranked(pd.DataFrame([*rows, *refused.values()]))


def reached(scene: Scene, setting: Setting) -> EquilibriumPath:
    """Path of one setting, complete or as far as it was reached."""
    return partial_path(solve_wire if setting.elements_per_turn else solve_beam, scene, **setting.options)


def _seconds(scene: Scene, setting: Setting, known: EquilibriumPath) -> float:
    """CPU seconds of one more solve; the median of several where it is short."""
    repeats = int(np.clip(SHORT / max(known.solve_seconds, 1e-6), 1, MOST_REPEATS))
    return median_of(repeats, lambda: reached(scene, setting).solve_seconds)


def _times(ratios: np.ndarray, paper: float) -> dict[str, float]:
    """CPU seconds, of ratios to the paper's mesh formed within each round, and the number of rounds."""
    found = {"ratio_to_paper_mesh": float(np.median(ratios)), "rounds": len(ratios)}
    return quartiles("seconds", ratios * paper) | found


def _reference(scene: Scene, extent: Extent) -> tuple[EquilibriumPath, list[dict[str, object]]]:
    """The finest path, and rows of its own error."""
    half = fitted(scene, extent.reference // 2)
    finest = Setting.wire(scene, "curved", 2 * half, steps=extent.finest)
    path = solve_wire(scene, **finest.options)
    coarse, short = replace(finest, elements_per_turn=half), replace(finest, steps=extent.finest // 2)
    rows = [
        row(role, scene, setting, compare_paths(solve_wire(scene, **setting.options), path))
        for role, setting in (("half mesh", coarse), ("half steps", short))
    ]
    if exact := EXACT_ROD.get(scene.name):
        places = [int(np.flatnonzero(np.isclose(path.times, time))[0]) for time in exact]
        tips = np.array(list(exact.values()))
        far = float(np.nanmax(np.abs(over_peak(path.tips[places], tips))))
        rows.append(row("exact rod", scene, finest, None, last_time=1.0, curve_max=far))
    return path, rows


def _peer_rows(
    scene: Scene, extent: Extent, reference: EquilibriumPath, paper: float, progress: Progress
) -> list[dict[str, object]]:
    """All settings of OpenSees, the wire model's straight mesh and penalty; none where it is not installed.

    `paper` : CPU seconds of the paper's FE mesh, by which its times are given.
    """
    peer = opensees()
    if peer is None:
        return []
    rows = []
    for mesh, steps in extent.peers:
        setting = Setting.wire(scene, PEER, mesh, steps=steps)
        progress(f"{scene.name}: {setting.label}")
        ratios = []
        for _ in range(extent.peer_rounds):
            beside = partial_path(solve_wire, scene).solve_seconds
            run = peer.run(scene, steps, peer.tolerance(scene), elements_per_turn=mesh)
            ratios.append(run.seconds / beside)
        error = compare_curves(run.curve, reference)
        whole = len(run.tips) == scene.with_steps(steps).load.rows
        known = {"outcome": "completed" if whole else "not_converged", "iterations": run.iterations}
        rows.append(row("opensees", scene, setting, error, **known, **_times(np.array(ratios), paper)))
    return rows


def penalty_rows(scene: Scene, rounds: int, progress: Progress) -> pd.DataFrame:
    """What the penalty costs: times, and errors of each model against itself with a penalty of `HARD`.

    With exponent 1 the penetration, and with it the error, falls in proportion to the penalty; so what a
    tenth of `HARD` changes is more than the reference's own error. All runs take turns, round after round.
    """
    mesh = Setting.wire(scene, "straight", PAPER_ELEMENTS)

    def solved(setting: Setting, penalty: float) -> EquilibriumPath:
        return reached(scene.with_penalty(penalty), setting)

    progress(f"{scene.name}: hard contact")
    hard = {setting: solved(setting, HARD) for setting in (PAPER_MODEL, mesh)}
    own = {setting: compare_paths(solved(setting, LESS_HARD), path) for setting, path in hard.items()}
    paths = {(setting, penalty): solved(setting, penalty) for setting in hard for penalty in PENALTIES}
    runs = {run: lambda run=run: solved(*run).solve_seconds for run in paths}
    seconds = interleaved(runs, announced(rounds, progress, f"{scene.name}: penalties"))
    paper = seconds[mesh, scene.contact.stiffness]
    rows = []
    for (setting, penalty), path in paths.items():
        taken = seconds[setting, penalty]
        found = row(
            "penalty", scene, setting, compare_paths(path, hard[setting]), outcome=path.outcome,
            iterations=path.total_iterations, **quartiles("seconds", taken), rounds=rounds,
            ratio_to_paper_mesh=float(np.median(taken / paper)),
            reference_curve_error=own[setting].curve_max, reference_shape_error_mm=own[setting].shape_max,
            on_curve_front=0, on_shape_front=0,
        )  # fmt: skip
        rows.append(found | {"penalty": penalty})
    return pd.DataFrame(rows)
