"""Changes of the load curves by one input at a time, a DataFrame for each case.

A change is positive where the top moves farther than with our default, in per cent of the default's peak,
as `coilspring.curves` has it. The size of an input is the largest of its changes at any load.
"""

import math
from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from coilspring import InputError, Scene
from coilspring.curves import COMPONENTS, over_peak
from validation.sensitivity.inputs import OpenInput, Variant
from validation.sensitivity.topheight import TipCurve, raised
from validation.study.cases import CASES
from validation.study.files import write_bytes
from validation.study.frames import TIPS, frame_table
from validation.study.models import BEAM, MODELS, WIRE
from validation.study.partialsolve import ending
from validation.study.paths import PathStore
from validation.study.store import Store

NO_INPUT, COMPLETED = "not an input", "completed"
ROUNDING = 1e-6  # %: a smaller change counts as none
BASE_TIPS = tuple(f"base_{name}" for name in TIPS)
CHANGES = tuple(f"{name}_change_percent" for name in COMPONENTS)
CURVE, DEVIATION = "curve_change_percent", "models_apart_percent"
COLUMNS = (
    *("case", "model", "input", "kind", "default", "value", "outcome", "critical_time", *BASE_TIPS, *TIPS),
    *(*CHANGES, CURVE, "curve_component", "curve_time", DEVIATION),
)
FORMATS = {
    "critical_time": "{:.6f}",
    "curve_time": "{:g}",
    **dict.fromkeys((*BASE_TIPS, *TIPS), "{:.9g}"),
    **dict.fromkeys((*CHANGES, CURVE, DEVIATION), "{:.6g}"),
}
Curves = Mapping[tuple[str, str], tuple[TipCurve, TipCurve]]  # base and changed by model and value


@dataclass(frozen=True)
class Study:
    """Changes of one scene."""

    name: str  # of a catalogue's scene, or of a user's
    # a row for every value of every input in each model, also where it has no such input; none where no path
    # of the scene as it is reaches full load
    data: pd.DataFrame
    inputs: tuple[OpenInput, ...]  # what is varied
    deviation: float | None  # %: largest difference of the two models, None where one has no curve
    prescribed: bool = False  # whether UY is: the axial force, N, takes its place
    left_out: tuple[str, ...] = ()  # a sentence on each thing that the scene cannot be given
    resolution: float | None = None  # %: change by twice the steps where the path matters, else None

    @property
    def title(self) -> str:
        """Name for a reader."""
        return next((each.title for each in CASES if each.name == self.name), self.name)


def changes(
    name: str,
    scene: Scene,
    inputs: tuple[OpenInput, ...],
    progress: Callable[[str], None],
    keep: Store | None = None,
) -> Study:
    """Vary the inputs of a scene; `InputError` where neither model represents it. A store keeps paths."""
    store = PathStore(lambda line: None, keep or Store(None))
    defaults, left_out = _defaults(store, name, scene)
    if not defaults:
        return Study(name, pd.DataFrame(columns=COLUMNS), (), None, left_out=tuple(left_out))
    rows: list[dict[str, Any]] = []
    for item in inputs:
        progress(f"{name}: {item.title}")
        curves, refused = {}, {}
        for model in defaults:
            try:
                for variant in item.variants(scene, model):
                    base = _solved(store, model, Variant("", scene, variant.base_options))
                    curves[model, variant.value] = base, _solved(store, model, variant)
            except InputError as refusal:
                refused[model] = str(refusal)
        for why in dict.fromkeys(refused.values()):
            models = " and ".join(model for model in refused if refused[model] == why)
            left_out.append(f"{item.title}, {models}: {why}")
        rows += [row for row in input_rows(item, curves, defaults) if row["model"] not in refused]
    apart = largest_deviation(*defaults.values()) if len(defaults) == len(MODELS) else None
    data = pd.DataFrame(rows, columns=COLUMNS).assign(case=name)
    resolution = _resolution(store, scene, defaults.get(WIRE))
    return Study(name, data, inputs, apart, bool(scene.load.displacement), tuple(left_out), resolution)


def _defaults(store: PathStore, name: str, scene: Scene) -> tuple[dict[str, TipCurve], list[str]]:
    """Curves of the models that represent a scene and reach full load, and a sentence on each other."""
    found, left_out, refused = {}, [], 0
    for model in MODELS:
        try:
            curve = _solved(store, model, Variant("", scene))
        except InputError as error:
            left_out.append(f"{model}: {error}")
            refused += 1
            continue
        if curve.outcome == COMPLETED:
            found[model] = curve
        else:
            left_out.append(f"{model} ends short of full load: {ending(curve.outcome, curve.critical_time)}")
    if refused == len(MODELS):
        raise InputError(f"{name}: no model has a load curve to vary: {'; '.join(left_out)}")
    return found, left_out


def _resolution(store: PathStore, scene: Scene, default: TipCurve | None) -> float | None:
    """Change of the wire model by twice the steps, on which closed pairs that remember make it depend, %."""
    if default is None or not scene.contact.enabled or scene.contact.sliding == "free":
        return None
    finer = TipCurve.of(store.partial_wire(scene.with_steps(2 * scene.load.steps)))
    if finer.outcome != COMPLETED:
        return None
    return largest_deviation(replace(finer, tips=finer.tips[1::2]), default)


def _solved(store: PathStore, model: str, variant: Variant) -> TipCurve:
    if variant.rise and "rotz" not in variant.scene.supports.top_held:  # else all its points move alike
        return raised(variant.scene, model, variant.rise)
    solve = store.partial_beam if model == BEAM else store.partial_wire
    return TipCurve.of(solve(variant.scene, **variant.options))


def input_rows(item: OpenInput, curves: Curves, defaults: Mapping[str, TipCurve]) -> Iterator[dict[str, Any]]:
    """Rows of one input."""
    for model in MODELS:
        head = {"model": model, "input": item.name, "kind": item.kind, "default": item.default}
        found = {value: pair for (which, value), pair in curves.items() if which == model}
        if not found:
            yield head | {"outcome": NO_INPUT}
        for value, (base, curve) in found.items():
            row = head | {"value": value} | change(base, curve)
            same = {**defaults, **{each: pair[1] for (each, other), pair in curves.items() if other == value}}
            if len(same) == len(MODELS) and all(each.outcome == COMPLETED for each in same.values()):
                row[DEVIATION] = largest_deviation(same[BEAM], same[WIRE])
            yield row


def change(base: TipCurve, curve: TipCurve) -> dict[str, Any]:
    """What changes from one curve to the other; a curve short of full load has no number."""
    if base.outcome != COMPLETED:  # of what the change would be
        return {"outcome": base.outcome, "critical_time": base.critical_time}
    row = {"outcome": curve.outcome, "critical_time": curve.critical_time}
    row |= zip(BASE_TIPS, base.tips[-1], strict=True)
    if curve.outcome != COMPLETED:
        return row
    by_load = farther(curve.tips, base.tips, base.counted)
    step, component = np.unravel_index(np.nanargmax(np.abs(by_load)), by_load.shape)
    by_load = np.where(np.abs(by_load) < ROUNDING, 0.0, by_load)
    row |= zip(TIPS, curve.tips[-1], strict=True)
    row |= zip(CHANGES, by_load[-1], strict=True)
    row[CURVE] = float(by_load[step, component])
    if row[CURVE]:  # nothing has no place
        row |= {"curve_component": COMPONENTS[component], "curve_time": curve.times[step]}
    return row


def farther(tips: np.ndarray, base: np.ndarray, counted: Sequence[bool] = (True, True, True)) -> np.ndarray:
    """How much farther the top moves than in the base, % of its peak, (steps, 3); nan where it is fixed."""
    common = slice(min(len(tips), len(base)))
    direction = np.sign(base[np.abs(base).argmax(axis=0), range(len(COMPONENTS))])
    return 100.0 * np.where(counted, direction, np.nan) * over_peak(tips[common], base, common)


def largest_deviation(curve: TipCurve, base: TipCurve) -> float:
    """Largest difference as far as both curves go, %."""
    return float(np.nanmax(np.abs(farther(curve.tips, base.tips, base.counted))))


def values(data: pd.DataFrame) -> pd.DataFrame:
    """The rows with a value: the model has the input."""
    return data[data["outcome"] != NO_INPUT]


def sizes(data: pd.DataFrame) -> pd.DataFrame:
    """Largest change by each input (rows) in each model (columns), %; the largest inputs first."""
    size = data[CURVE].abs().groupby([data["input"], data["model"]]).max().unstack()
    size = size.reindex(index=values(data)["input"].unique(), columns=MODELS).fillna(0.0)
    return size.loc[size.max(axis=1).sort_values(ascending=False, kind="stable").index]


def together(data: pd.DataFrame, model: str, kinds: Collection[str]) -> float:
    """Root of the sum of squares of the sizes of all inputs of some kinds, %."""
    return math.hypot(*sizes(data[data["kind"].isin(kinds)])[model])


def worst(data: pd.DataFrame, model: str, kinds: Collection[str]) -> pd.Series:
    """The row of the largest change of a model by inputs of some kinds."""
    able = data[(data["model"] == model) & data["kind"].isin(kinds)]
    return able.loc[able[CURVE].abs().idxmax()]


def ended_early(studies: Sequence[Study]) -> str:
    """Scenes that are left out since no path of theirs reaches full load, in one sentence; or nothing."""
    left = (f"{study.name}: {'; '.join(study.left_out)}" for study in studies if study.data.empty)
    return "; ".join(left)


def write_csv(studies: Sequence[Study], out: Path) -> None:
    """Write ``sensitivity.csv``; of a prescribed displacement the axial force stands for UY."""
    data = pd.concat([study.data for study in studies], ignore_index=True)[list(COLUMNS)]
    write_bytes(out / "sensitivity.csv", frame_table(data, FORMATS).csv())
