"""Page of a campaign, ``stability.md``: its words and tables are in ``page.md``."""

from __future__ import annotations

from pathlib import Path

import pandas as pd

from validation.campaign.figure import TITLES, outcome_figure
from validation.campaign.runs import KINDS
from validation.campaign.scenes import CORNERS, MODELS
from validation.campaign.table import DISPLACEMENT, FORCE, NUMBERS, version
from validation.campaign.verdict import CLASSES, ITERATION, REFUSED, UNEXPLAINED, VERIFIED
from validation.study import template
from validation.study.document import Table
from validation.study.frames import frame_table
from validation.study.machine import versions
from validation.study.metrics import upper_bound
from validation.study.output import write_facts, write_files, write_text
from validation.study.plots import drawn

PAGE = template.template(Path(__file__).with_name("page.md"))


def write_page(data: pd.DataFrame, out: Path) -> None:
    """Write page and picture of the rows."""
    write_files(drawn(outcome_figure(data), "stability"), out)
    write_text(out / "stability.md", page(data))
    facts: dict[str, float] = {"seeds": data["seed"].nunique()}
    for model, rows in data.groupby(data["id"].str[0].map({"b": "beam", "w": "wire"})):
        counts = rows["class"].value_counts()
        facts |= {f"{model}.{name}": int(counts.get(name, 0)) for name in CLASSES}
        facts[f"{model}.unexplained_bound"] = upper_bound(int(counts.get(UNEXPLAINED, 0)), len(rows))
    write_facts(facts, out)


def page(data: pd.DataFrame) -> str:
    """The page, Markdown."""
    model, compared = data["id"].str[:1].map(TITLES), data[data["stepped"] != ""]
    counts = {
        "model": {title: model == title for title in TITLES.values()},
        "geometry": {
            f"{geometry}, {sliding}": (data["geometry"] == geometry) & (data["sliding"] == sliding)
            for geometry in ("spheres", "wires")
            for sliding in ("free", "none", "coulomb")
        },
        "given": {
            f"{title}, {by}": (model == title) & (data["by"] == by)
            for title in TITLES.values()
            for by in (FORCE, DISPLACEMENT)
        },
        "corner": {name or "none": data["corner"] == name for name in ("", *CORNERS)},
    }
    listed = data.loc[data["class"].isin((UNEXPLAINED, ITERATION, REFUSED))]
    listed = listed.assign(reason=listed["reason"].where(listed["reason"] != "", listed["message"]))
    listed = listed[["seed", "id", "class", "corner", "outcome", "reason"]].rename(columns={"id": "case"})
    kinds = {kind: data[data["kind"] == kind] for kind in KINDS}
    return template.page(
        PAGE,
        seeds=sorted(data["seed"].unique(), key=int),
        rates=_rates(data),
        unexplained=_by_seed(data),
        sources=version(),
        used=", ".join(f"{name} {number}" for name, number in versions().items() if number),
        counts={
            title: _counts(title, {name: data[chosen] for name, chosen in groups.items()})
            for title, groups in counts.items()
        },
        stepped=[
            f"{row.id} of seed {row.seed}"
            for row in compared[compared["stepped"].astype(float) > 0.0].itertuples()
        ],
        compared=len(compared),
        titles=TITLES.values(),
        largest={name: _largest(data, name) for name in NUMBERS},
        invariances={kind: [len(rows), *_largest(rows, "invariance")] for kind, rows in kinds.items()},
        listed=frame_table(listed) if len(listed) else "",
    )


def _rates(data: pd.DataFrame) -> Table:
    """Rate of each class and its upper bound, of each model and of all scenes."""
    groups = {title: data[data["id"].str[:1] == letter] for letter, title in TITLES.items()}
    rows = []
    for name in CLASSES:
        row = {"class": name}
        for title, some in (groups | {"both": data}).items():
            count, of = int((some["class"] == name).sum()), len(some)
            row[title] = f"{count / of:.2%} (below {upper_bound(count, of):.2%})" if of else "-"
        rows.append(row)
    return frame_table(pd.DataFrame(rows))


def _by_seed(data: pd.DataFrame) -> Table:
    """Scenes, unexplained ones and ends of the iteration of each seed and model."""
    groups = data.groupby([data["seed"].astype(int), data["id"].str[:1].map(TITLES)])
    counted = groups["class"].agg(
        scenes="size",
        unexplained=lambda classes: (classes == UNEXPLAINED).sum(),
        iteration=lambda classes: (classes == ITERATION).sum(),
    )
    return frame_table(counted.rename_axis(["seed", "model"]).reset_index())


def _counts(title: str, groups: dict[str, pd.DataFrame]) -> Table:
    """How many scenes of each group have each class."""
    counts = {
        name: rows["class"].value_counts().reindex(CLASSES, fill_value=0) for name, rows in groups.items()
    }
    return frame_table(pd.DataFrame(counts).T.rename_axis(title).reset_index())


def _largest(data: pd.DataFrame, name: str) -> list[str]:
    """Largest value of a number among the explained scenes of each model."""
    explained = data[data["class"].isin(VERIFIED)]
    found = [pd.to_numeric(explained.loc[explained["id"].str[:1] == model, name]).max() for model in MODELS]
    return ["-" if pd.isna(value) else f"{value:.1e}" for value in found]
