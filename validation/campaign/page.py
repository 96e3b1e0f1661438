"""Page of a campaign, ``stability.md``, and its picture; words and tables are in ``page.md``."""

from itertools import product
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.collections import QuadMesh
from matplotlib.colors import BoundaryNorm
from matplotlib.figure import Figure

from validation.campaign.runs import KINDS
from validation.campaign.scenes import CORNERS, LETTERS, is_of_sections
from validation.campaign.table import DISPLACEMENT, FORCE, NUMBERS, version
from validation.campaign.verdict import (
    CLASSES,
    CRITICAL,
    ITERATION,
    REFUSED,
    UNDECIDED,
    UNEXPLAINED,
    VERIFIED,
)
from validation.study import template
from validation.study.files import write_facts, write_files, write_text
from validation.study.frames import frame_table
from validation.study.machine import versions
from validation.study.metrics import upper_bound
from validation.study.plots import drawn, styled
from validation.study.sections import MOST_SECTIONS
from validation.study.style import DOUBLE, RED
from validation.study.tables import Table

WORDS = template.template(Path(__file__).with_name("page.md"))
TITLES = {"b": "equivalent beam", "w": "wire model"}
SHAPES = {False: "cylinder or cone", True: "of sections"}
MAPS = (("penalty", "steps"), ("slenderness", "load"))


class Scale(NamedTuple):
    """How a quantity is drawn: cells between edges."""

    label: str
    edges: np.ndarray
    ticks: tuple[float, ...] = ()
    kind: str = "log"

    def within(self, share: float) -> np.ndarray:
        """The place in each cell that is such a share of its width, as drawn, from its lower edge."""
        low, high = self.edges[:-1], self.edges[1:]
        return low * (high / low) ** share if self.kind == "log" else low + (high - low) * share


SCALES = {
    "penalty": Scale("penalty K (N/mm$^k$, each scene with its own k)", np.geomspace(1e2, 1e10, 9)),
    "steps": Scale("requested steps", np.array([1, 3, 8, 22, 63, 201]), (1, 3, 10, 30, 100)),
    "slenderness": Scale("height over mean diameter", np.geomspace(0.2, 7.0, 8), (0.2, 0.5, 1, 2, 5)),
    "load": Scale("relative load", np.linspace(0.0, 1.6, 9), (0, 0.4, 0.8, 1.2, 1.6), "linear"),
}
OTHER_UNITS = ("tiny", "huge")  # whose penalties say nothing beside the others'
OTHER_FORCES = "by other forces as well"  # in the message of a path that says so
FEWEST = 20  # scenes of a cell that is coloured: of fewer the share says little
DARK, NO_DATA = 30.0, "#dcdcdc"  # %: numbers on darker cells are white; cells without data
SHARE, COUNT = 5.5, 4.5  # pt
LEVELS = np.linspace(0.0, 50.0, 11)  # %: a colour between each two
CORNER = 0.13  # of a cell, from its upper right corner to its cross


def write_page(data: pd.DataFrame, out: Path) -> None:
    """Write page and picture of the rows."""
    write_files(drawn(outcome_figure(data), "stability", exact=True), out)
    write_text(out / "stability.md", page(data))
    facts: dict[str, float] = {"seeds": data["seed"].nunique()}
    for name, counts in _counted(data["id"].str[0].map({"b": "beam", "w": "wire"}), data).iterrows():
        facts |= {f"{name}.{each}": int(count) for each, count in counts.items()}
        facts[f"{name}.unexplained_bound"] = upper_bound(int(counts[UNEXPLAINED]), int(counts.sum()))
    write_facts(facts, out)


def page(data: pd.DataFrame) -> str:
    """The page, Markdown."""
    model, compared = data["id"].str[0].map(TITLES), data[data["stepped"] != ""]
    models, touching = tuple(TITLES.values()), product(("spheres", "wires"), ("free", "none", "coulomb"))
    groups = {  # how scenes are told apart, and in which order
        "model": (model, models),
        "geometry": (data["geometry"] + ", " + data["sliding"], map(", ".join, touching)),
        "given": (model + ", " + data["by"], map(", ".join, product(models, (FORCE, DISPLACEMENT)))),
        "spring": (data["id"].map(is_of_sections).map(SHAPES.get), SHAPES.values()),
        "corner": (data["corner"].replace("", "none"), ("none", *CORNERS)),
    }
    counts = {
        title: _counted(labels, data).reindex(list(order), fill_value=0).rename_axis(title).reset_index()
        for title, (labels, order) in groups.items()
    }
    seeds = _counted([data["seed"].astype(int), model.rename("model")], data)
    seeds.insert(0, "scenes", seeds.sum(axis=1))
    listed = data.loc[data["class"].isin((UNEXPLAINED, ITERATION, REFUSED))]
    listed = listed.assign(reason=listed["reason"].where(listed["reason"] != "", listed["message"]))
    listed = listed[["seed", "id", "class", "corner", "outcome", "reason"]].rename(columns={"id": "case"})
    held = data[(data["id"].str[0] == "w") & data["sliding"].isin(["none", "coulomb"])]
    kinds = {kind: data[data["kind"] == kind] for kind in KINDS}
    return template.page(
        WORDS,
        seeds=sorted(data["seed"].unique(), key=int),
        rates=_rates(counts["model"].set_index("model")),
        unexplained=frame_table(seeds[["scenes", UNEXPLAINED, ITERATION]].reset_index()),
        sources=version(),
        used=", ".join(f"{name} {number}" for name, number in versions().items() if number),
        sections=MOST_SECTIONS,
        counts={title: frame_table(counted) for title, counted in counts.items()},
        stepped=[f"{row.id} of seed {row.seed}" for row in compared.itertuples() if float(row.stepped) > 0.0],
        compared=len(compared),
        held=len(held),
        possible=int(held["message"].str.contains(OTHER_FORCES, regex=False).sum()),
        undecided=int((data["class"] == UNDECIDED).sum()),
        titles=models,
        largest={name: _largest(data, name) for name in NUMBERS},
        invariances={kind: [len(rows), *_largest(rows, "invariance")] for kind, rows in kinds.items()},
        listed=frame_table(listed) if len(listed) else "",
    )


def _counted(labels: pd.Series | list[pd.Series], data: pd.DataFrame) -> pd.DataFrame:
    """How many scenes of each label have each class."""
    return pd.crosstab(labels, data["class"]).reindex(columns=CLASSES, fill_value=0)


def _rates(counts: pd.DataFrame) -> Table:
    """Rate of each class and its upper bound, of each model and of all scenes."""
    counts = pd.concat((counts, counts.sum().to_frame("both").T))
    rates: dict[Any, Any] = {"class": CLASSES}
    for title, row in counts.iterrows():
        of = int(row.sum())
        bounds = [upper_bound(int(count), of) for count in row]
        shares = zip(row, bounds, strict=True)
        rates[title] = [f"{count / of:.2%} (below {bound:.2%})" if of else "-" for count, bound in shares]
    return frame_table(pd.DataFrame(rates))


def _largest(data: pd.DataFrame, name: str) -> list[str]:
    """Largest value of a number among the explained scenes of each model."""
    explained = data[data["class"].isin(VERIFIED)]
    found = [pd.to_numeric(explained.loc[explained["id"].str[0] == model, name]).max() for model in LETTERS]
    return ["-" if pd.isna(value) else f"{value:.1e}" for value in found]


def outcome_figure(data: pd.DataFrame) -> Figure:
    """Share of scenes that end at a critical point, over the numerics and over the physics."""
    letters = [letter for letter in LETTERS if data["id"].str.startswith(letter).any()] or ["b"]
    with styled():
        figure = Figure(figsize=(DOUBLE, 0.5 + 2.5 * len(letters)), layout="constrained")
        plots = figure.subplots(len(letters), 2, squeeze=False)
        for mark, axes, (letter, names) in zip("abcd", plots.flat, product(letters, MAPS), strict=False):
            mine = data[data["id"].str.startswith(letter)]
            if "penalty" in names:
                mine = mine[~mine["corner"].isin(OTHER_UNITS)]
            mesh = _map(axes, mine, names)
            axes.set_title(f"({mark}) {TITLES[letter]}")
        bar = figure.colorbar(mesh, ax=plots, shrink=0.7, aspect=30, ticks=LEVELS[::2])
        bar.set_label("share of scenes that end at\na confirmed critical point (%)")
        bar.outline.set_linewidth(0.5)
        crosses, grey = plots[0, 0].get_legend_handles_labels()[0]
        any_left = (data["class"] == UNEXPLAINED).any()
        figure.legend(handles=[crosses, grey] if any_left else [grey], loc="outside lower center", ncols=2)
    return figure


def _map(axes: Axes, data: pd.DataFrame, names: tuple[str, str]) -> QuadMesh:
    """One map: cells with their share in per cent and the number of scenes, crosses for unexplained ones."""
    places, scales = data[list(names)].astype(float), [SCALES[name] for name in names]
    there = places[names[0]] > 0.0
    data, (x, y), edges = data[there], places[there].to_numpy().T, [scale.edges for scale in scales]
    count, _, _ = np.histogram2d(x, y, bins=edges)
    critical = data["class"].isin(CRITICAL).to_numpy(dtype=float)
    share, _, _ = np.histogram2d(x, y, bins=edges, weights=critical)
    cells = np.ma.masked_where(count < FEWEST, 100.0 * share / np.maximum(count, 1.0)).T
    axes.set_facecolor(NO_DATA)
    look: Any = {"cmap": "Blues", "norm": BoundaryNorm(LEVELS, 256, extend="max")}
    look |= {"edgecolors": "white", "linewidth": 0.4}
    mesh, middles = axes.pcolormesh(*edges, cells, **look), []
    for axis, scale, letter in zip((axes.xaxis, axes.yaxis), scales, "xy", strict=True):
        middles.append(scale.within(0.5))
        limits = {f"{letter}label": scale.label, f"{letter}lim": scale.edges[[0, -1]]}
        axes.set(**limits, **{f"{letter}scale": scale.kind})
        if scale.ticks:
            axis.set_ticks(scale.ticks, [f"{tick:g}" for tick in scale.ticks])
            axis.set_ticks([], minor=True)
    for row, column in zip(*np.nonzero(~np.ma.getmaskarray(cells)), strict=True):
        value, place = cells[row, column], (middles[0][column], middles[1][row])
        look = {"ha": "center", "color": "white" if value > DARK else "black"}
        axes.text(*place, f"{value:.0f} %", va="bottom", fontsize=SHARE, **look)
        axes.text(*place, f"of {count[column, row]:.0f}", va="top", fontsize=COUNT, **look)
    odd, _, _ = np.histogram2d(x, y, bins=edges, weights=data["class"] == UNEXPLAINED)
    corners = [scale.within(1.0 - CORNER)[np.nonzero(odd)[axis]] for axis, scale in enumerate(scales)]
    look = {"color": RED, "markersize": 3.5, "markeredgewidth": 1.0}
    axes.plot(*corners, "x", **look, label="unexplained scene in the cell")
    axes.plot([], [], "s", color=NO_DATA, label=f"fewer than {FEWEST} scenes")
    axes.grid(False)
    return mesh
