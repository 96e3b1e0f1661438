"""Page of a campaign, ``stability.md``: its words and tables are in ``page.md``."""

from __future__ import annotations

from collections.abc import Iterable
from itertools import product
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
        counts = rows["class"].value_counts().reindex(CLASSES, fill_value=0)
        facts |= {f"{model}.{name}": int(count) for name, count in counts.items()}
        facts[f"{model}.unexplained_bound"] = upper_bound(int(counts[UNEXPLAINED]), len(rows))
    write_facts(facts, out)


def page(data: pd.DataFrame) -> str:
    """The page, Markdown."""
    model, compared = data["id"].str[:1].map(TITLES), data[data["stepped"] != ""]
    models, touching = tuple(TITLES.values()), product(("spheres", "wires"), ("free", "none", "coulomb"))
    counts = {  # how scenes are told apart, and in which order
        "model": (model, models),
        "geometry": (data["geometry"] + ", " + data["sliding"], map(", ".join, touching)),
        "given": (model + ", " + data["by"], map(", ".join, product(models, (FORCE, DISPLACEMENT)))),
        "corner": (data["corner"].replace("", "none"), ("none", *CORNERS)),
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
        counts={title: _counts(title, data["class"], *groups) for title, groups in counts.items()},
        stepped=[f"{row.id} of seed {row.seed}" for row in compared.itertuples() if float(row.stepped) > 0.0],
        compared=len(compared),
        titles=models,
        largest={name: _largest(data, name) for name in NUMBERS},
        invariances={kind: [len(rows), *_largest(rows, "invariance")] for kind, rows in kinds.items()},
        listed=frame_table(listed) if len(listed) else "",
    )


def _rates(data: pd.DataFrame) -> Table:
    """Rate of each class and its upper bound, of each model and of all scenes."""
    groups = {title: data[data["id"].str[:1] == letter] for letter, title in TITLES.items()} | {"both": data}

    def rate(name: str, some: pd.DataFrame) -> str:
        count, of = int((some["class"] == name).sum()), len(some)
        return f"{count / of:.2%} (below {upper_bound(count, of):.2%})" if of else "-"

    rates = {title: [rate(name, some) for name in CLASSES] for title, some in groups.items()}
    return frame_table(pd.DataFrame({"class": CLASSES} | rates))


def _by_seed(data: pd.DataFrame) -> Table:
    """Scenes, unexplained ones and ends of the iteration of each seed and model."""
    groups = data.groupby([data["seed"].astype(int), data["id"].str[:1].map(TITLES)])
    counted = groups["class"].agg(
        scenes="size",
        unexplained=lambda classes: (classes == UNEXPLAINED).sum(),
        iteration=lambda classes: (classes == ITERATION).sum(),
    )
    return frame_table(counted.rename_axis(["seed", "model"]).reset_index())


def _counts(title: str, classes: pd.Series, labels: pd.Series, order: Iterable[str]) -> Table:
    """How many scenes of each label have each class."""
    counts = pd.crosstab(labels, classes).reindex(index=list(order), columns=CLASSES, fill_value=0)
    return frame_table(counts.rename_axis(title).reset_index())


def _largest(data: pd.DataFrame, name: str) -> list[str]:
    """Largest value of a number among the explained scenes of each model."""
    explained = data[data["class"].isin(VERIFIED)]
    found = [pd.to_numeric(explained.loc[explained["id"].str[:1] == model, name]).max() for model in MODELS]
    return ["-" if pd.isna(value) else f"{value:.1e}" for value in found]
