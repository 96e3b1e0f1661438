"""Commands that study the models, or hand a scene to other programs and to the eye.

Each gives the lines to be said, and in one sentence what is wrong.
"""

import argparse
import os
from collections.abc import Callable, Mapping
from pathlib import Path

from coilspring import CATALOGUE, EquilibriumPath, InputError, Scene, load_scene
from coilspring.errors import require_integer
from coilspring.scene.profile import OTHER_DIAMETERS
from coilspring.scene.toml import written_table
from coilspring.workers import require_workers
from validation.cli.arguments import (
    CAMPAIGN_RANGES,
    COMMON_OPTIONS,
    MODEL_OPTIONS,
    by_name,
    flag,
    given,
    refuse_other_models,
    refuse_varied,
    scene_of,
    scenes_of,
)
from validation.cli.terminal import announcing, ended_early, left_out, outcome_line
from validation.study.files import ROOT, claimed, json_bytes, prepare, write_files, write_text, writing
from validation.study.output import write_runs

Progress = Callable[[str], None]
Answer = tuple[list[str], str]
LOADING = "loading both models"


def reproduce(arguments: argparse.Namespace, folder: Path, progress: Progress) -> Answer:
    """Make the paper's tables and figures."""
    with claimed(folder), writing(folder):
        from validation.reproduce.reproduction import reproduce as run

        only, time, turned = arguments.only, arguments.time, arguments.interactive
        remarks = run(folder, only, not arguments.no_render, progress, time, turned)
    return [*remarks, f"written to {folder}"], ""


def workprecision(arguments: argparse.Namespace, folder: Path, progress: Progress) -> Answer:
    """Measure run time against error of both models."""
    extent = next((name for name in ("quick", "full") if getattr(arguments, name)), "normal")
    scenes = scenes_of(arguments)
    if scenes and arguments.page:
        raise InputError("--page takes the scenes recorded in the folder: leave out SCENE")
    progress(LOADING)
    from validation.workprecision import page, results, run

    early = ""
    with claimed(folder), writing(folder):
        if arguments.page:
            rows = page.write(folder, drawn=True)
        else:
            rows = run.workprecision(folder, arguments.only, extent, progress, scenes)
            early = results.ended_early(rows)
    return [*page.digest(rows), f"written to {folder}"], early


def calibrate(arguments: argparse.Namespace, folder: Path, progress: Progress) -> Answer:
    """Fit the equivalent beam to a measured curve."""
    scene = load_scene(arguments.scene)
    names = tuple(name.strip() for name in arguments.fit.split(","))
    if "" in names:
        raise InputError(f"--fit must be names with commas between, as axial,bending, got {arguments.fit!r}")
    progress("loading equivbeam")
    from validation.calibration import run

    with claimed(folder), writing(folder):
        progress(f"fitting {', '.join(names)}")
        files, lines = run.calibrate(scene, arguments.measured, names, **given(arguments, ("law",)))
        lines += write_runs({folder: files}, read=(arguments.measured, arguments.scene))
    other = OTHER_DIAMETERS.keys() & written_table(scene, arguments.scene)["spring"].keys()
    if other and "wire_diameter" in names:
        held = "fitted with the mean diameter of the coils as it is"
        lines.append(f"warning: {held}, not the {other.pop()} of the file: take both from calibrated.toml")
    return [*lines, f"written to {folder}"], ""


def sensitivity(arguments: argparse.Namespace, folder: Path, progress: Progress) -> Answer:
    """Vary what the paper leaves open, or inputs of scenes, in both models."""
    scenes = scenes_of(arguments)
    progress(LOADING)
    from validation.sensitivity import changes, page, run

    with claimed(folder), writing(folder):
        studies = run.sensitivity(folder, arguments.only, progress, scenes)
    lines = [line for study in studies for line in page.digest(study)]
    return [*lines, f"written to {folder}"], changes.ended_early(studies)


def regress(arguments: argparse.Namespace, folder: Path, progress: Progress) -> Answer:
    """Compare what both models find with stored baselines."""
    scenes, kept = scenes_of(arguments), arguments.baselines
    if kept is None:
        _require_shipped(scenes, arguments)
    progress(LOADING)
    from validation.regress import run
    from validation.regress.baselines import SHIPPED, shipped_runs

    scenes = scenes or run.kept_scenes(kept or SHIPPED)
    accept, times = arguments.accept, arguments.time
    lines, verdicts = [], []
    with writing(folder):
        for name, scene in scenes.items() or [("", None)]:
            out = folder / name if len(scenes) > 1 else folder
            chosen = shipped_runs(name) if scene and kept is None else None
            baseline = SHIPPED if kept is None else kept / name
            finding = run.regress(out, baseline, accept, times, progress, scene, chosen)
            verdict = f"{name}: {finding.verdict}" if name else finding.verdict
            lines += [*map(str, finding.moves), *finding.left_out, verdict]
            verdicts += [verdict] if finding.moves and not accept else []
    meant = "; where that is meant: regress --accept" if kept or Path.cwd() == ROOT else ""
    return [*lines, f"written to {folder}"], f"{'; '.join(verdicts)}{meant}" if verdicts else ""


def _require_shipped(scenes: Mapping[str, Scene], arguments: argparse.Namespace) -> None:
    """Refuse scenes of which no baselines come with coilcheck, and to write a part of those anew."""
    geometry = f" with --geometry {arguments.geometry}" if arguments.geometry else ""
    for asked, (name, scene) in zip(arguments.scenes, scenes.items(), strict=True):
        if name not in CATALOGUE or scene != CATALOGUE[name]():
            raise InputError(
                f"--baselines DIR must name a folder of yours unless SCENE is one of {', '.join(CATALOGUE)}, "
                f"got {asked}{geometry}"
            )
    if scenes and arguments.accept:
        names = ", ".join(scenes)
        raise InputError(f"--accept must go with --baselines DIR where SCENE is given, got {names}")
    if arguments.accept and Path.cwd() != ROOT:
        raise InputError(
            "--accept must go with --baselines DIR: the baselines that come with coilcheck are written anew "
            "from the root of its checkout alone"
        )


def stability(arguments: argparse.Namespace, folder: Path, progress: Progress) -> Answer:
    """Verify sampled scenes of both models."""
    case = arguments.case
    without = ("beams", "wires", "workers", "out") if case is not None else ()
    for name in given(arguments, without):
        raise InputError(
            f"{flag(name)} has no effect beside --case, which verifies one case, writing nothing"
        )
    asked = given(arguments, tuple(CAMPAIGN_RANGES))
    options = {name: require_integer(name, asked[name], *CAMPAIGN_RANGES[name]) for name in asked}
    if options.get("beams") == options.get("wires") == 0:
        raise InputError("--beams and --wires must not both be 0, which is no scene to verify")
    seeds = _seeds(options.pop("seed", None), arguments.seeds)
    progress(LOADING)
    from validation.campaign.run import campaign, digest, verified
    from validation.campaign.table import row_text
    from validation.campaign.verdict import UNEXPLAINED

    if case is not None:
        rows = [verified(case, seed) for seed in seeds]
        lines, classes = ["\n\n".join(map(row_text, rows))], [row["class"] for row in rows]
    else:
        with claimed(folder), writing(folder):
            data = campaign(folder, **options, seeds=seeds, progress=_counted(progress))
        lines, classes = [*digest(data), f"written to {folder}"], list(data["class"])
    return lines, "not every outcome is explained" if UNEXPLAINED in classes else ""


def _seeds(one: int | None, listed: str | None) -> tuple[int, ...]:
    """Seeds of a campaign; `InputError` for both options, or a list that is none of different numbers."""
    if listed is None:
        return (1 if one is None else one,)
    if one is not None:
        raise InputError(f"--seed or --seeds, not both, got {one} and {listed}")
    parts = [part.strip() for part in listed.split(",")]
    if not all(part.isdecimal() for part in parts):
        raise InputError(f"seeds must be whole numbers with commas between, as 1,2,3, got {listed!r}")
    seeds = tuple(require_integer("seeds", int(part), *CAMPAIGN_RANGES["seed"]) for part in parts)
    if len(set(seeds)) < len(seeds):
        raise InputError(f"seeds must be different, got {listed!r}")
    return seeds


def _counted(progress: Progress) -> Callable[[int, int], None]:
    """Progress by the number of scenes done."""
    return lambda done, of: progress(f"{done} of {of} scenes")


def study_law(arguments: argparse.Namespace, folder: Path, progress: Progress) -> Answer:
    """Study laws of a half coil that a user wrote."""
    files = by_name("FILE.py", arguments.laws)
    progress(LOADING)
    from validation.lawstudy import run

    lines: list[str] = []
    with claimed(folder), writing(folder):
        progress("compiling the laws")
        laws = {name: run.tried(file) for name, file in files.items()}  # before any is studied
        for name, law in laws.items():
            out = folder / name if len(laws) > 1 else folder
            lines += [*run.study_law(law, out, progress, quick=arguments.quick), f"written to {out}"]
    return lines, ""


def sweep(arguments: argparse.Namespace, folder: Path, progress: Progress) -> Answer:
    """Solve a grid of scenes with one model, or as accurately as asked for."""
    workers, accuracy = arguments.workers, arguments.accuracy
    # an accuracy is the wire model's, whatever is chosen for it
    model = arguments.model = arguments.model if accuracy is None else "wirefe"
    refuse_other_models(arguments, tuple(name for names in MODEL_OPTIONS.values() for name in names))
    require_workers(workers)
    scene = scene_of(arguments)
    from validation.sweep import grid, run

    table = written_table(scene, arguments.scene)
    varied = grid.read_varied(arguments.vary, table)
    keys = [each.key for each in varied]
    refuse_varied(arguments, keys)
    progress(f"loading {model}")
    progress = announcing(progress, model, scene)
    asked, lines, found = run.Choice.of(model, given(arguments, MODEL_OPTIONS[model])), [], None
    about: dict[str, object] = {"overridden": given(arguments, COMMON_OPTIONS), **run.UNASKED}
    points = list(grid.points(table, varied))
    with claimed(folder), writing(folder):
        if accuracy is not None:
            from validation.sweep.choice import choose

            found = choose(points, varied, accuracy, progress)
            points = found.grid
            lines.append(found.line)
            about |= {"accuracy": accuracy, "estimated_error": found.error, "sampled": found.sampled}
        solver, count = found.candidate if found else lambda scene: asked, _counted(progress)
        with run.kept_sweeps(folder) as kept:
            rows = run.sweep(
                folder, table, varied, points, solver, workers=workers, progress=count, about=about
            )
        choices = [(point.scene, solver(point.scene)) for point in points if point.scene]
        run.write_picture(folder, rows, keys, scene, choices[0][1].model)
        lines += kept
    lines += run.digest(rows, keys)
    lines += dict.fromkeys(line for each, by in choices for line in left_out(each, by.model, by.options))
    return [*lines, f"written to {folder}"], run.ended_early(rows)


def export(arguments: argparse.Namespace, folder: Path, progress: Progress) -> Answer:
    """Write the input deck of a scene for another program."""
    from validation.peers import calculix

    scene = scene_of(arguments)
    text = calculix.deck(scene)
    with claimed(folder):
        write_text(folder / calculix.FILE, text)
    said = [f"written to {folder / calculix.FILE}; run it there by: ccx {calculix.JOB}"]
    if scene.contact.enabled and scene.contact.sliding == "none":
        said.append("its contact is frictionless: a spring element cannot hold a pair where it closed")
    return said, ""


def referee(arguments: argparse.Namespace, folder: Path, progress: Progress) -> Answer:
    """Run a peer on a scene beside the wire model."""
    scene, peer = scene_of(arguments), arguments.peer
    if arguments.solid:
        return _solids(scene, peer, folder, progress)
    with claimed(folder):
        progress(f"solving with wirefe and {peer}")
        from validation.peers.comparison import compare

        found = compare(scene, peer)
        values = {"scene": scene.name, "peer": peer, "remark": found.remark, "steps": found.rows}
        seconds = {"wirefe": found.wire.solve_seconds, peer: found.peer.seconds}
        summary = {**values, "curve_max": found.difference, "ended_early": found.early, "seconds": seconds}
        write_files({f"{peer}.json": json_bytes(summary), f"{peer}.csv": found.csv()}, folder)
    failure = f"{'; '.join(found.early)}; what was reached is written" if found.early else ""
    return [*found.lines(), f"written to {folder}"], failure


def _solids(scene: Scene, peer: str, folder: Path, progress: Progress) -> Answer:
    """Compare rods with solid elements of CalculiX."""
    from validation.solid import comparison
    from validation.study.frames import to_csv

    if peer != "calculix":
        raise InputError(f"--solid goes with calculix alone, got --with {peer}")
    comparison.require_force(scene)
    with claimed(folder):
        progress("flexibility of a few coils by solids: about a minute")
        coils = comparison.flexibilities(scene.spring, scene.material)
        progress("full load by solids in large deflection: minutes")
        moved = comparison.deflections(scene)
        write_files({"flexibility.csv": to_csv(coils), "deflection.csv": to_csv(moved)}, folder)
    left_out = ["contact is left out"] if scene.contact.enabled else []
    return [*left_out, *comparison.lines(coils, moved), f"written to {folder}"], ""


def view(arguments: argparse.Namespace, folder: Path, progress: Progress) -> Answer:
    """Show the wire as it deforms, in a window or as a movie."""
    from validation.view import animation, frames

    movie = arguments.movie
    run = Path(arguments.scene)
    source = frames.of_run(run) if os.path.isdir(run) else load_scene(arguments.scene)
    animation.require(movie)
    if movie is not None:
        prepare(movie.parent, movie)

    paths: list[EquilibriumPath] = []  # that of a scene

    def load() -> frames.Frames:
        if not isinstance(source, Scene):
            return source
        paths.append(frames.solved(source, progress))
        return frames.of_path(paths[0])

    if movie is None:
        animation.show(load)
        lines = []
    else:
        remark = animation.film(load, movie, progress)
        lines = [*([remark] if remark else []), f"written to {movie}"]
    early = ended_early(*paths, what_is_done="shown" if movie is None else "written")
    return [*map(outcome_line, paths), *lines], early


STUDIES = (reproduce, workprecision, sensitivity, sweep, regress, stability, study_law, calibrate)
COMMANDS = {each.__name__.replace("_", "-"): each for each in (*STUDIES, export, referee, view)}
