"""Page of a campaign, ``stability.md``: its words and tables are in ``page.md``."""

from __future__ import annotations

from pathlib import Path

import pandas as pd

from validation.campaign.figure import TITLES, outcome_figure
from validation.campaign.invariance import KINDS
from validation.campaign.scenes import CORNERS, MODELS
from validation.campaign.table import DISPLACEMENT, FORCE, NUMBERS, version
from validation.campaign.verdict import (
    CLASSES,
    CONFIRMED,
    DEVIATES,
    ENDED,
    REFUSED,
    RIGHT,
    THROUGH,
    UNEXPLAINED,
)
from validation.study import template
from validation.study.document import Table
from validation.study.frames import frame_table
from validation.study.machine import versions
from validation.study.output import write_facts, write_files, write_text
from validation.study.plots import drawn

PAGE = template.template(Path(__file__).with_name("page.md"))


def write_page(data: pd.DataFrame, out: Path, seed: int) -> None:
    """Write page and picture of the rows."""
    write_files(drawn(outcome_figure(data), "stability"), out)
    write_text(out / "stability.md", page(data, seed))
    counts = data.groupby([data["id"].str[0].map({"b": "beam", "w": "wire"}), "class"]).size()
    names = [(model, name) for model in ("beam", "wire") for name in CLASSES]
    write_facts({".".join(name): int(counts.get(name, 0)) for name in names}, out)


def page(data: pd.DataFrame, seed: int) -> str:
    """The page, Markdown."""
    model, compared = data["id"].str[:1].map(TITLES), data[data["stepped"] != ""]
    counts = {
        "model": {title: model == title for title in TITLES.values()},
        "given": {
            f"{title}, {by}": (model == title) & (data["by"] == by)
            for title in TITLES.values()
            for by in (FORCE, DISPLACEMENT)
        },
        "corner": {name or "none": data["corner"] == name for name in ("", *CORNERS)},
    }
    listed = data.loc[data["class"].isin((UNEXPLAINED, ENDED, DEVIATES, REFUSED))]
    listed = listed.assign(reason=listed["reason"].where(listed["reason"] != "", listed["message"]))
    listed = listed[["id", "corner", "outcome", "reason"]].rename(columns={"id": "case"})
    kinds = {kind: data[data["kind"] == kind] for kind in KINDS}
    return template.page(
        PAGE,
        seed=seed,
        sources=version(),
        used=", ".join(f"{name} {number}" for name, number in versions().items() if number),
        counts={
            title: _counts(title, {name: data[chosen] for name, chosen in groups.items()})
            for title, groups in counts.items()
        },
        stepped=list(compared.loc[compared["stepped"].astype(float) > 0.0, "id"]),
        compared=len(compared),
        titles=TITLES.values(),
        largest={name: _largest(data, name) for name in NUMBERS},
        invariances={kind: [len(rows), *_largest(rows, "invariance")] for kind, rows in kinds.items()},
        listed=frame_table(listed) if len(listed) else "",
    )


def _counts(title: str, groups: dict[str, pd.DataFrame]) -> Table:
    """How many scenes of each group have each class."""
    counts = {
        name: rows["class"].value_counts().reindex(CLASSES, fill_value=0) for name, rows in groups.items()
    }
    return frame_table(pd.DataFrame(counts).T.rename_axis(title).reset_index())


def _largest(data: pd.DataFrame, name: str) -> list[str]:
    """Largest value of a number among the explained scenes of each model."""
    explained = data[data["class"].isin((RIGHT, CONFIRMED, THROUGH))]
    found = [pd.to_numeric(explained.loc[explained["id"].str[:1] == model, name]).max() for model in MODELS]
    return ["-" if pd.isna(value) else f"{value:.1e}" for value in found]
