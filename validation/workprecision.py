"""Run time against error of both models: what a given accuracy costs (``coilcheck workprecision``).

The error of a path is its distance from a reference (`validation.metrics`): the curved wire mesh of
`Extent.reference` elements a turn in `Extent.finest` steps. The reference's own error is told by half
its mesh and by half its steps; where there is no contact, the exact rod bears it out.

The time is the CPU time of the solve alone, one thread, kernels warm. All settings of a scene run in
turn, round after round, so that a disturbance of the machine falls on all; ratios are formed within a
round.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from coilspring import EquilibriumPath, InputError, Scene
from validation import penaltysweep
from validation.cases import solve_beam, solve_wire
from validation.freshness import make_ready
from validation.metrics import COMPONENTS, Comparison, compare_paths
from validation.output import prepare
from validation.penaltysweep import Sweep
from validation.provenance import write_provenance
from validation.reached import as_far
from validation.timing import Spread
from validation.worksettings import EXTENTS, PAIRS, STEPS, Extent, Setting, settings, study_scenes

SHORT, MOST_REPEATS = 0.02, 5  # s; a shorter solve is repeated within a round
TIE = 1.1  # times nearer to each other than about this factor are one
GAIN = 0.9  # a slower setting is on the front where its error is below this part of the faster ones'

# Tips at two times without contact (UX, UY in mm, ROTZ in rad): exact Cosserat rod with rigid end turns
# and the default material, integrated by shooting to 1e-10. Our own numbers, not published ones.
EXACT_ROD: Mapping[str, Mapping[float, tuple[float, float, float]]] = {
    "spring-a-no-contact": {
        0.5: (-13.325870, -3.912853, 0.707779),
        1.0: (-21.260191, -10.464994, 1.200717),
    },
    "spring-b-no-contact": {0.5: (0.0, -12.476115, 0.0), 1.0: (0.0, -25.060823, 0.0)},
}


@dataclass(frozen=True)
class Reference:
    """What a scene's paths are compared with.

    Attributes
    ----------
    path : the finest path.
    by_mesh, by_steps : what half its mesh and half its steps change.
    exact : its distance from the exact rod over the peak, where there is one.
    """

    path: EquilibriumPath
    by_mesh: Comparison
    by_steps: Comparison
    exact: float | None

    @property
    def curve(self) -> float:
        """Its own error of the load curve, over the peak."""
        return self.by_mesh.curve_max + self.by_steps.curve_max

    @property
    def shape(self) -> float:
        """Its own error of the shape, mm."""
        return self.by_mesh.shape_max + self.by_steps.shape_max


@dataclass(frozen=True)
class Point:
    """One setting on one scene: its error and its time.

    Attributes
    ----------
    setting : what was run.
    outcome : of the path; errors are those of the part that was reached.
    error : distance from the reference.
    ratio : its time over that of the paper's FE mesh, formed within each round.
    seconds : CPU seconds of the solve: the ratio times the median time of the paper's FE mesh.
    iterations : factorisations.
    """

    setting: Setting
    outcome: str
    error: Comparison
    ratio: Spread
    seconds: Spread
    iterations: int

    @property
    def competes(self) -> bool:
        """Whether it solves the scene to the end with the scene's contact model."""
        return self.outcome == "completed" and self.setting.pairs in (0, PAIRS)


@dataclass(frozen=True)
class Study:
    """All settings of one scene.

    Attributes
    ----------
    scene, reference : what was solved, and what the paths are compared with.
    points : in the order of `worksettings.settings`.
    paper : CPU seconds of the paper's FE mesh, as they were measured.
    """

    scene: Scene
    reference: Reference
    points: tuple[Point, ...]
    paper: Spread

    @property
    def curve_front(self) -> tuple[Point, ...]:
        """The fastest settings for every error of the load curve, among those that give all of it."""
        whole = [point for point in self.points if point.setting.steps >= STEPS]
        return front(whole, lambda point: max(point.error.curve_max, self.reference.curve))

    @property
    def shape_front(self) -> tuple[Point, ...]:
        """The fastest settings for every error of the shape at full load, in any number of steps."""
        return front(self.points, lambda point: max(point.error.shape_max, self.reference.shape))


def front(points: Iterable[Point], error: Callable[[Point], float]) -> tuple[Point, ...]:
    """Pareto front by time: no competitor that is faster, or as fast, has an error as small within `GAIN`."""

    def rank(point: Point) -> tuple[int, float]:
        return round(np.log(point.ratio.median) / np.log(TIE)), error(point)

    found: list[Point] = []
    for point in sorted((each for each in points if each.competes), key=rank):
        if not found or error(point) < GAIN * error(found[-1]):
            found.append(point)
    return tuple(found)


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
    from validation import workreport

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
        workreport.write(studies, sweeps, EXTENTS[extent], out, drawn=False)
    progress("drawing")
    _draw(studies, sweeps, out)
    workreport.write(studies, sweeps, EXTENTS[extent], out, drawn=True)
    write_provenance(_command(only, extent), out)
    return studies


def _command(only: Sequence[str] | None, extent: str) -> str:
    size = [] if extent == "normal" else [f"--{extent}"]
    return " ".join(["coilcheck workprecision", *size, *([f"--only {','.join(only)}"] if only else [])])


def _chosen(only: Sequence[str] | None) -> list[Scene]:
    scenes = study_scenes()
    for name in only or ():
        if name not in scenes:
            raise InputError(f"only must hold names of {', '.join(scenes)}, got {name!r}")
    return [scene for name, scene in scenes.items() if only is None or name in only]


def _draw(studies: Sequence[Study], sweeps: Sequence[Sweep], out: Path) -> None:
    """Drawing is imported here: matplotlib takes most of a second."""
    from validation import workfigures

    workfigures.write(studies, sweeps, out)


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
    return Study(scene, best, tuple(points), Spread.of(paper))


def reached(scene: Scene, setting: Setting) -> EquilibriumPath:
    """Path of one setting, complete or as far as it was reached."""
    return as_far(solve_wire if setting.mesh else solve_beam, scene, **setting.options)


def _seconds(scene: Scene, setting: Setting, known: EquilibriumPath) -> float:
    """CPU seconds of one more solve; the median of several where it is short."""
    repeats = int(np.clip(SHORT / max(known.solve_seconds, 1e-6), 1, MOST_REPEATS))
    return float(np.median([reached(scene, setting).solve_seconds for _ in range(repeats)]))


def reference(scene: Scene, extent: Extent) -> Reference:
    """The finest path with its own error."""
    finest = Setting("curved", extent.finest, extent.reference, PAIRS)
    path = solve_wire(scene, **finest.options)
    coarser = solve_wire(scene, **(finest.options | {"elements_per_turn": extent.reference // 2}))
    fewer = solve_wire(scene, **(finest.options | {"steps": extent.finest // 2}))
    return Reference(path, compare_paths(coarser, path), compare_paths(fewer, path), _from_exact(path))


def _from_exact(path: EquilibriumPath) -> float | None:
    """Largest distance from the exact rod over the peak of the component; None where there is none."""
    exact = EXACT_ROD.get(path.scene.name)
    if exact is None:
        return None
    rows = [int(np.flatnonzero(np.isclose(path.times, time))[0]) for time in exact]
    tips = np.array(list(exact.values()))
    peaks = np.abs(tips).max(axis=0)
    apart = np.abs(path.tips[rows] - tips).max(axis=0)
    return max(float(apart[i] / peaks[i]) for i in range(len(COMPONENTS)) if peaks[i] > 0.0)
