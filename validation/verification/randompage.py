"""What the study of random springs says: tables and sentences, views of its rows."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pandas as pd
from scipy.stats import binom

from validation.study.document import Block, Bullets, Heading, Picture, Table, Text
from validation.study.frames import frame_table
from validation.verification.randomscenes import KINDS, SIDE, TEXT
from validation.verification.randomsprings import COMPONENTS, LAWS, NEGLIGIBLE, PAIRS

CLASSES = ("without contact", "none closes", "up to 3 close", "more than 3 close")
NAMES = {"helix": "helix law", "haringx": "paper's law"}
FIGURE = "../reports/errorbudget/randomsprings.png"
CAPTION = (
    "Error of the tip vector of both laws on random springs. Symbol: median; bar: to the 95th percentile, "
    "or to the largest of fewer than {few} springs; grey: single springs."
)
FEW = 20  # springs, below which the largest error stands in place of a percentile
CONFIDENCE = 0.95
WORST = 10
MEASURED = (
    "Both laws with their defaults against the wire model, 10 steps, up to where the first path ends: 8 "
    f"curved elements per turn, with contact 16 and {PAIRS} sphere pairs per turn. Errors are in per cent of "
    "the wire model's peak: of the tip vector (UX, UY), or the axial force where UY is prescribed; and of "
    f"each component over its own peak. A component whose peak is below {NEGLIGIBLE:g} of the largest, ROTZ "
    "taken times the mean coil radius, is left out. Closed pairs are counted as the paper's 4 per turn: "
    "quarter turns of the wire on which pairs are closed, the largest number at once."
)


def classified(data: pd.DataFrame) -> pd.DataFrame:
    """The rows with their class of contact and each law's worst component."""
    closed = np.select([~data["contact"], data["closed"] == 0, data["closed"] <= 3], CLASSES[:3], CLASSES[3])
    worst = {f"{law}_worst": data[[f"{law}_{name}" for name in COMPONENTS]].max(axis=1) for law in LAWS}
    return data.assign(closing=closed, **worst)


def part(data: pd.DataFrame) -> list[Block]:
    """The part of the page on random springs."""
    rows = classified(data)
    return [
        Heading(2, "Random springs"),
        Text(TEXT),
        Text(MEASURED),
        Bullets(tuple(sentence(rows) for sentence in SENTENCES.values())),
        Picture(FIGURE, CAPTION.format(few=FEW)),
        Heading(3, "Tip vector, by kind and contact"),
        Text(
            f"Median / 95th percentile (springs), %; of fewer than {FEW} springs the largest, marked *max*. "
            "The kinds count alike in *all*."
        ),
        *(_vectors(rows, law) for law in LAWS),
        Heading(3, "What the sample bounds"),
        Text(
            f"The bound is above the 95th percentile with {100 * CONFIDENCE:g} % confidence, by order "
            "statistics; *seeds* is the range over the seeds."
        ),
        _bounds(rows),
        Heading(3, "Each component"),
        _components(rows),
        Heading(3, "Paths that end early"),
        _ends(rows),
        Heading(3, "The worst"),
        _worst(rows),
    ]


def number(value: float) -> str:
    """Two digits."""
    return "" if np.isnan(value) else f"{value:.2g}" if value < 99.5 else f"{value:.0f}"


def cell(errors: pd.Series) -> str:
    """Median / 95th percentile (springs)."""
    known = errors.dropna()
    if known.empty:
        return ""
    high = f"max {number(known.max())}" if len(known) < FEW else number(known.quantile(0.95))
    return f"{number(known.median())} / {high} ({len(known)})"


def percentile_bound(errors: pd.Series) -> float:
    """An error that the 95th percentile lies below with `CONFIDENCE`; not a number where no sample tells."""
    known = np.sort(errors.dropna())
    place = int(binom.ppf(CONFIDENCE, len(known), 0.95))  # no more than so many lie below the percentile
    return float(known[place]) if place < len(known) else float("nan")


def _vectors(rows: pd.DataFrame, law: str) -> Table:
    both = pd.concat((rows, rows.assign(kind="all")))
    cells = both.groupby(["kind", "closing"])[f"{law}_vector"].agg(cell).unstack(fill_value="")
    cells = cells.reindex(index=[*(kind.name for kind in KINDS), "all"], columns=CLASSES, fill_value="")
    return frame_table(cells.rename_axis(NAMES[law]).reset_index())


def facts(data: pd.DataFrame) -> dict[str, float]:
    """Of the errors of the tip vector of each law, without contact and where many pairs close."""
    rows = classified(data)
    found: dict[str, float] = {}
    for law in LAWS:
        for name, closing in (("open", CLASSES[0]), ("closed", CLASSES[-1])):
            errors = rows.loc[rows["closing"] == closing, f"{law}_vector"]
            found |= {
                f"{law}.{name}.springs": int(errors.count()),
                f"{law}.{name}.median": errors.median(),
                f"{law}.{name}.percentile": errors.quantile(0.95),
                f"{law}.{name}.bound": percentile_bound(errors),
            }
    return found


def _bounds(rows: pd.DataFrame) -> Table:
    lines = []
    for law in LAWS:
        for closing in CLASSES:
            here = rows[rows["closing"] == closing]
            errors, seeds = here[f"{law}_vector"], here.groupby("seed")[f"{law}_vector"]
            high, largest = errors.quantile(0.95), errors.max()
            numbers = map(number, (errors.median(), high, percentile_bound(errors), largest))
            spans = (seeds.quantile(q) for q in (0.5, 0.95))
            ranges = (f"{number(span.min())} to {number(span.max())}" for span in spans)
            lines.append((NAMES[law], closing, str(errors.count()), *numbers, *ranges))
    header = ("law", "contact", "springs", "median", "95th percentile", "its bound", "largest")
    return Table((*header, "median, seeds", "95th percentile, seeds"), tuple(lines))


def _components(rows: pd.DataFrame) -> Table:
    names = {f"{law}_{name}": f"{law}, {name.upper()}" for law in LAWS for name in COMPONENTS}
    cells = rows.groupby(["kind", "closing"])[list(names)].agg(cell)
    every = pd.MultiIndex.from_product(([kind.name for kind in KINDS], CLASSES))
    cells = cells.reindex(every).dropna(how="all").rename_axis(["kind", "contact"])
    return frame_table(cells.rename(columns=names).reset_index())


def _ends(rows: pd.DataFrame) -> Table:
    models = ["wire", *LAWS]
    early = rows[(rows[models] != "completed").any(axis=1)]
    counts = early.groupby([*models, "closing"]).size().unstack(fill_value=0)
    counts = counts.reindex(columns=CLASSES, fill_value=0).reset_index()
    return frame_table(counts.rename(columns=NAMES | {"wire": "wire model"}))


def _worst(rows: pd.DataFrame) -> Table:
    drawn = ("seed", "number", "kind", "shape", "index", "coils", "slenderness", "phase", "closed", "wire")
    titles = dict(zip(drawn, drawn, strict=True)) | {"slenderness": "L/D", "reference": "half the pairs"}
    titles |= {"helix_steps": "steps", "helix_vector": "helix", "haringx_vector": "haringx"}
    worst = rows.nlargest(WORST, "helix_vector")[list(titles)]
    formats = {titles[name]: number for name in worst.select_dtypes("float")}
    return frame_table(worst.rename(columns=titles), formats)


def _pair(errors: pd.Series) -> str:
    """Median and 95th percentile in words."""
    high = number(errors.quantile(0.95))
    return f"{number(errors.median())} % in the median and {high} % at the 95th percentile"


def _both(errors: pd.Series) -> str:
    """The same, shorter."""
    return f"{number(errors.median())} and {number(errors.quantile(0.95))} %"


def _population(rows: pd.DataFrame) -> str:
    count = rows["closing"].value_counts().reindex(CLASSES, fill_value=0)
    return (
        f"{len(rows)} springs of {rows['seed'].nunique()} seeds and {rows['kind'].nunique()} kinds of load "
        f"and support: {count.iloc[0]} without contact; with contact {count.iloc[1]} on which no pair "
        f"closes, {count.iloc[2]} with up to three pairs closed and {count.iloc[3]} with more."
    )


def _by_class(law: str) -> Callable[[pd.DataFrame], str]:
    def sentence(rows: pd.DataFrame) -> str:
        found = [rows.loc[rows["closing"] == closing, f"{law}_vector"] for closing in CLASSES]
        words = [_both(errors) for errors in found]
        return (
            f"Over all these kinds of load the {NAMES[law]}'s tip is off by {words[0]} without contact "
            f"(median and 95th percentile), {words[1]} where no pair closes, {words[2]} where up to three "
            f"close and {words[3]} where more do."
        )

    return sentence


def _guided(rows: pd.DataFrame) -> str:
    guided = rows[rows["kind"].str.startswith("guided, ")]
    free, closed = (guided.loc[guided["closing"] == CLASSES[k], "helix_vector"] for k in (0, 3))
    other = guided.loc[guided["closing"] == CLASSES[0], "haringx_vector"]
    return (
        f"On guided springs loaded along their axis the helix law is off by {_pair(free)} without contact "
        f"(the paper's law by {_both(other)}), and by {_both(closed)} where more than three pairs close."
    )


def _side_force(rows: pd.DataFrame) -> str:
    combined = rows[rows["kind"].str.endswith("combined") & ~rows["contact"]]
    return (
        f"Under an axial force with {100 * SIDE:g} % of it sideways, without contact, the worst component "
        f"is off by {_pair(combined['helix_worst'])} with the helix law, {_both(combined['haringx_worst'])} "
        "with the paper's."
    )


def _small_components(rows: pd.DataFrame) -> str:
    free = rows[~rows["kind"].str.startswith("guided, ") & (rows["closed"] > 0)]
    return (
        "Where pairs close on springs that can sway or tilt, a component that is small beside the others is "
        f"known least: the worst one is off by {_pair(free['helix_worst'])} with the helix law, "
        f"{_both(free['haringx_worst'])} with the paper's."
    )


def _closer(rows: pd.DataFrame) -> str:
    medians = rows.groupby(["kind", "closing"])[["helix_vector", "haringx_vector"]].median().dropna()
    closer = int((medians["helix_vector"] < medians["haringx_vector"]).sum())
    nearer = (rows["helix_vector"] < rows["haringx_vector"]).mean()
    return (
        f"The helix law has the smaller median in {closer} of {len(medians)} cells of kind and contact, and "
        f"the smaller error on {100 * nearer:.0f} % of the springs."
    )


def _bound(rows: pd.DataFrame) -> str:
    bounds = [percentile_bound(rows.loc[rows["closing"] == CLASSES[k], "helix_vector"]) for k in (0, 3)]
    return (
        f"With {100 * CONFIDENCE:g} % confidence the 95th percentile of the helix law's error is below "
        f"{number(bounds[0])} % without contact and below {number(bounds[1])} % where more than three pairs "
        "close."
    )


def _seeds(rows: pd.DataFrame) -> str:
    spans = []
    for closing in (CLASSES[0], CLASSES[3]):
        found = rows[rows["closing"] == closing].groupby("seed")["helix_vector"].quantile(0.95)
        spans.append(f"from {number(found.min())} to {number(found.max())} %")
    return (
        f"From seed to seed the 95th percentile of the helix law's error goes {spans[0]} without contact and "
        f"{spans[1]} where more than three pairs close."
    )


def _reference(rows: pd.DataFrame) -> str:
    found = [rows.loc[rows["closing"] == CLASSES[k], "reference"] for k in (0, 2, 3)]
    words = [_both(errors) for errors in found]
    return (
        f"The wire model is not exact either: half the pairs per turn move its tip by {words[1]} where up to "
        f"three close and {words[2]} where more do; without contact twice the elements move it by "
        f"{words[0]}."
    )


def _early(rows: pd.DataFrame) -> str:
    counts = [int((rows[model] != "completed").sum()) for model in ("wire", *LAWS)]
    lost = int(rows["helix_vector"].isna().sum())
    return (
        f"Before full load end {counts[0]} paths of the wire model, {counts[1]} of the helix law and "
        f"{counts[2]} of the paper's; they are compared up to where the first ends, {lost} springs not at "
        "all."
    )


SENTENCES: dict[str, Callable[[pd.DataFrame], str]] = {
    "population": _population,
    "guided": _guided,
    "helix": _by_class("helix"),
    "haringx": _by_class("haringx"),
    "side force": _side_force,
    "small components": _small_components,
    "closer": _closer,
    "bound": _bound,
    "seeds": _seeds,
    "reference": _reference,
    "early ends": _early,
}
