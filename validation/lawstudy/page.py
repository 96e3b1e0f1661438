"""The page of a law, whose words are in ``page.md``: tables, what the sentences count, and the figure."""

from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
from matplotlib.figure import Figure

from coilspring.curves import COMPONENTS
from equivbeam.laws.userlaw import UserLaw
from validation.campaign.verdict import CLASSES as OUTCOMES
from validation.lawstudy.springs import BAD, LAW, MESHES, breakdown
from validation.study import template
from validation.study.frames import frame_table
from validation.study.models import LAWS
from validation.study.plots import png, styled
from validation.study.style import BLUE, DOUBLE, LIGHT_RED, NAVY, RED, Look
from validation.study.tables import Table
from validation.study.template import significant
from validation.verification.randompage import CLASSES, cell, errors

COMPARED = (*LAWS, LAW)
FEWEST = 5  # springs of a kind, below which it is not named
NEARER = 0.99  # times another law's error: what is nearer to it counts as equal
GREEN = "#2e8b57"
LOOKS: dict[str, Look] = {
    "haringx": {"color": BLUE, "marker": "o", "label": "haringx"},
    "helix": {"color": NAVY, "marker": "D", "label": "helix"},
    LAW: {"color": GREEN, "marker": "*", "markersize": 9.0, "label": "this law"},
    "straight 40": {"color": LIGHT_RED, "marker": "s", "label": "wire, straight 40 (paper's mesh)"},
    "curved 4": {"color": RED, "marker": "v", "label": "wire, curved 4"},
    "curved 8": {"color": RED, "marker": "^", "label": "wire, curved 8"},
}
Data = dict[str, pd.DataFrame]


def pair(springs: pd.DataFrame, law: str, closing: int) -> str:
    """Median / 95th percentile of a law's error in a class of contact."""
    found = errors(springs, f"{law}_vector", closing)
    return f"{significant(found.median())} / {significant(found.quantile(0.95))}"


def gain(springs: pd.DataFrame) -> float:
    """Share of the difference of both built-in laws that the law takes away, of medians without contact."""
    haringx, helix, law = (errors(springs, f"{name}_vector", 0).median() for name in COMPARED)
    return float((haringx - law) / (haringx - helix))


def nearer(springs: pd.DataFrame, law: str) -> str:
    """On how many springs the law is nearer than another, per cent."""
    return f"{100.0 * (springs[f'{LAW}_vector'] < NEARER * springs[f'{law}_vector']).mean():.0f}"


def weakest(springs: pd.DataFrame) -> dict[str, Any]:
    """Kind and class with the largest share of springs on which the law is broken, and the others' counts."""
    table = breakdown(springs)
    many = table[table["springs"] >= FEWEST]
    table = many if len(many) else table
    worst = table.loc[(table["broken"] / table["springs"]).idxmax()]
    beside = {law: int(breakdown(springs, law).loc[worst.name, "broken"]) for law in LAWS}
    counts = {name: int(worst[name]) for name in ("broken", "springs")}
    return {"kind": worst["kind"], "contact": worst["contact"]} | counts | beside


def differences(limits: pd.DataFrame) -> pd.Series:
    """Differences from the closed form, or from haringx where there is none, per cent."""
    target = limits["formula"].astype(float).fillna(limits["haringx"].astype(float))
    return 100.0 * (limits["found"].astype(float) / target - 1.0)


def early(row: Any) -> str:
    """That the path ends before the load does, where it does so."""
    return "" if row.outcome == "completed" else " (ends early)"


def on_case(row: Any, law: str) -> str:
    """A law's errors on a case."""
    parts = (getattr(row, f"{law}_{component}", np.nan) for component in COMPONENTS)
    ended = "" if getattr(row, f"{law}_outcome") == "completed" else " ends early"
    detail = ", ".join(f"{part:.2f}" for part in parts if not np.isnan(part))
    return f"{getattr(row, f'{law}_error'):.2f} ({detail}){ended}"


FUNCTIONS = (pair, gain, nearer, weakest, differences, breakdown, on_case, cell)
WORDS = template.template(Path(__file__).with_name("page.md"), FUNCTIONS)
WORDS.globals.update(bad=BAD, laws=COMPARED, classes=CLASSES, components=COMPONENTS, outcomes=OUTCOMES)
SUMMARY = ("cases", "springs", "gain", "breaks", "time", "stability", "limits")  # blocks of the page


def files(law: UserLaw, data: Data) -> tuple[dict[str, bytes], list[str]]:
    """The page and its figure by file name, and the summary."""
    with styled():
        picture = png(draw(data["place"]))
    text = template.page(WORDS, law=law, f=data, code="@code@", tables=tables(data))
    source = law.source[1].rstrip() if law.source else ""
    text = text.replace("@code@", f"```python\n{source}\n```")  # its lines stay as they are
    summary = [template.statement(WORDS, name, data) for name in SUMMARY]
    return {"law.md": text.encode(), "law.png": picture}, summary


def tables(data: Data) -> dict[str, Table]:
    """Tables whose columns are those of the data."""
    place, limits = data["place"], data["limits"]
    cells = [f"{row.error:.2g} %, {row.ms:.3g} ms{early(row)}" for row in place.itertuples()]
    texts = place.assign(text=cells)
    texts = texts.pivot(index="scene", columns="series", values="text")[[*COMPARED, *MESHES]]
    formats = dict.fromkeys(("found", "formula", "haringx"), "{:.5g}") | {"off": "{:+.2f} %"}
    return {
        "place": frame_table(texts.reindex(place["scene"].unique()).reset_index()),
        "limits": frame_table(limits.assign(off=differences(limits)), formats),
        "derivatives": frame_table(data["derivatives"], {"deviation": "{:.1e}"}),
    }


def draw(data: pd.DataFrame) -> Figure:
    """A panel for each spring: error over CPU time of the laws and of some meshes of the wire model."""
    scenes = data["scene"].unique()
    figure = Figure(figsize=(DOUBLE, 4.2), layout="constrained")
    grid = figure.subplots(2, -(-len(scenes) // 2), sharex=True, sharey=True, squeeze=False)
    for axes, scene in zip(grid.flat, scenes, strict=False):
        for row in data[data["scene"] == scene].itertuples():
            full = "none" if early(row) else "full"
            axes.plot(row.ms, row.error, linestyle="none", fillstyle=full, **LOOKS[row.series])
        axes.set(xscale="log", yscale="log", title=scene)
    for axes in grid[-1]:
        axes.set_xlabel("CPU time (ms)")
    for axes in grid[:, 0]:
        axes.set_ylabel("error of the curve (%)")
    figure.legend(*grid[0, 0].get_legend_handles_labels(), loc="outside lower center", ncols=3)
    return figure
