"""What the study of random springs says: figure, tables, and what sentences of ``randomsprings.md`` count."""

import math
from itertools import product
from pathlib import Path

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from scipy.stats import binom

from coilspring.curves import COMPONENTS
from validation.study import template
from validation.study.files import write_bytes
from validation.study.frames import frame_table
from validation.study.metrics import CONFIDENCE
from validation.study.plots import png, styled
from validation.study.style import BLUE, DOUBLE, GREY, NAVY, Look
from validation.study.template import significant
from validation.verification import randomscenes, randomsprings
from validation.verification.randomscenes import KINDS
from validation.verification.randomsprings import HELIX_FIRST

CLASSES = ("without contact", "none closes", "up to 3 close", "more than 3 close")
NAMES = {"helix": "helix law", "haringx": "paper's law"}
FEW = 20  # springs, below which the largest error stands in place of a percentile
WORST = 10  # springs in the table of the worst, whose columns are:
TITLES = {name: name for name in ("seed", "number", "kind", "shape", "index", "coils")}
TITLES |= {"slenderness": "L/D", "phase": "phase", "closed": "closed", "wire": "wire"}
TITLES |= {"reference": "half the pairs", "helix_steps": "steps"}
TITLES |= {f"{law}_vector": law for law in HELIX_FIRST}
FILE = Path("reports/errorbudget/randomsprings.png")
LOOKS: dict[str, Look] = {
    "helix": {"color": NAVY, "marker": "D", "label": "helix law, median to 95th percentile"},
    "haringx": {"color": BLUE, "marker": "o", "label": "paper's law, likewise"},
}
SPRING: Look = {"color": GREY, "marker": ".", "linestyle": "none", "markersize": 2.4}
SPRING |= {"alpha": 0.6, "markeredgewidth": 0}
PANELS = (("(a) no pair closes", CLASSES[:2]), ("(b) pairs close", CLASSES[2:]))
BESIDE, SPREAD = 0.19, 0.11  # of a law from the middle of its row, and of single springs around it


def classified(data: pd.DataFrame) -> pd.DataFrame:
    """The rows with their class of contact and each law's worst component."""
    closed = np.select([~data["contact"], data["closed"] == 0, data["closed"] <= 3], CLASSES[:3], CLASSES[3])
    worst = {
        f"{law}_worst": data[[f"{law}_{name}" for name in COMPONENTS]].max(axis=1) for law in HELIX_FIRST
    }
    return data.assign(closing=closed, **worst)


def errors(rows: pd.DataFrame, column: str, *closing: int, kind: str = "") -> pd.Series:
    """A column of the springs of some classes of contact, whose kind matches a pattern; by default all."""
    classes = [CLASSES[place] for place in closing]
    return rows.loc[rows["closing"].isin(classes) & rows["kind"].str.contains(kind), column]


def cell(errors: pd.Series) -> str:
    """Median / 95th percentile (springs)."""
    known = errors.dropna()
    if known.empty:
        return ""
    high = f"max {significant(known.max())}" if len(known) < FEW else significant(known.quantile(0.95))
    return f"{significant(known.median())} / {high} ({len(known)})"


def both(errors: pd.Series) -> str:
    """Median and 95th percentile with its bound."""
    return f"{significant(errors.median())} and {high(errors)}"


def in_words(errors: pd.Series) -> str:
    """The same, said in words."""
    return f"{significant(errors.median())} % in the median and {high(errors)} at the 95th percentile"


def high(errors: pd.Series) -> str:
    """95th percentile with its bound."""
    bound = percentile_bound(errors)
    words = "no bound" if np.isnan(bound) else f"bound {significant(bound)} %"
    return f"{significant(errors.quantile(0.95))} % ({words})"


def percentile_bound(errors: pd.Series) -> float:
    """An error that the 95th percentile lies below with `CONFIDENCE`; nan where the sample is small."""
    known = np.sort(errors.dropna())
    place = int(binom.ppf(CONFIDENCE, len(known), 0.95))  # no more than so many lie below the percentile
    return float(known[place]) if place < len(known) else float("nan")


def fewest() -> int:
    """Springs of the least sample whose 95th percentile has a bound, which is its largest error."""
    return math.ceil(math.log(1.0 - CONFIDENCE) / math.log(0.95))


def cell_sizes(rows: pd.DataFrame) -> pd.Series:
    """Springs in each cell of kind and contact."""
    sizes = rows.groupby(["kind", "closing"])["helix_vector"].count()
    return sizes[sizes > 0]


def over_seeds(rows: pd.DataFrame, column: str, closing: int, share: float) -> str:
    """Range of a quantile over the seeds."""
    found = rows[rows["closing"] == CLASSES[closing]].groupby("seed")[column].quantile(share)
    return f"{significant(found.min())} to {significant(found.max())}"


FUNCTIONS = (errors, cell, both, in_words, percentile_bound, over_seeds, fewest, cell_sizes)
WORDS = template.template(Path(__file__).with_name("randomsprings.md"), FUNCTIONS)
WORDS.globals.update(
    **{"drawn": randomscenes, "study": randomsprings, "few": FEW, "confidence": CONFIDENCE},
    **{"classes": CLASSES, "names": NAMES, "kinds": [kind.name for kind in KINDS]},
)


def page(data: pd.DataFrame) -> str:
    """The part of the page on random springs: sentences, and tables of early ends and of the worst."""
    rows, models = classified(data), ["wire", *HELIX_FIRST]
    early = rows[(rows[models] != "completed").any(axis=1)]
    counts = early.groupby([*models, "closing"]).size().unstack(fill_value=0)
    counts = counts.reindex(columns=CLASSES, fill_value=0).reset_index()
    worst = rows.nlargest(WORST, "helix_vector")[list(TITLES)]
    formats = {TITLES[name]: significant for name in worst.select_dtypes("float")}
    return template.page(
        WORDS,
        f=rows,
        ends=frame_table(counts.rename(columns=NAMES | {"wire": "wire model"})),
        worst=frame_table(worst.rename(columns=TITLES), formats),
    )


def facts(data: pd.DataFrame) -> dict[str, float]:
    """Of the errors of the tip vector of each law, without contact and where many pairs close."""
    rows = classified(data)
    found: dict[str, float] = {}
    for law, (name, closing) in product(HELIX_FIRST, (("open", 0), ("closed", 3))):
        known = errors(rows, f"{law}_vector", closing)
        values = {"springs": int(known.count()), "median": known.median()}
        values |= {"percentile": known.quantile(0.95), "bound": percentile_bound(known)}
        found |= {f"{law}.{name}.{key}": value for key, value in values.items()}
    return found


def write_figure(data: pd.DataFrame) -> None:
    """Write the PNG."""
    with styled():
        write_bytes(FILE, png(draw(classified(data))))


def draw(rows: pd.DataFrame) -> Figure:
    """A panel for springs on which nothing closes and one for the others, a line for each kind and law."""
    figure = Figure(figsize=(DOUBLE, 3.6), layout="constrained")
    plots = figure.subplots(1, 2, sharex=True, sharey=True)
    for axes, (title, classes) in zip(plots, PANELS, strict=True):
        _panel(axes, rows[rows["closing"].isin(classes)])
        axes.set(title=title, xlabel="error of the tip vector (%)", xscale="log", xlim=(1e-4, 100.0))
    plots[0].set_yticks(range(len(KINDS)), [kind.name for kind in KINDS])
    plots[0].invert_yaxis()
    handles = [Line2D([], [], linewidth=1.6, markersize=4.5, **look) for look in LOOKS.values()]
    handles.append(Line2D([], [], **(SPRING | {"markersize": 5.0}), label="one spring"))
    figure.legend(handles=handles, loc="outside lower center", ncols=3)
    return figure


def _panel(axes: Axes, rows: pd.DataFrame) -> None:
    rng = np.random.default_rng(0)
    for place, kind in enumerate(KINDS):
        for (law, look), side in zip(LOOKS.items(), (-BESIDE, BESIDE), strict=True):
            errors = rows.loc[rows["kind"] == kind.name, f"{law}_vector"].dropna()
            if errors.empty:
                continue
            jitter = place + side + rng.uniform(-SPREAD, SPREAD, len(errors))
            axes.plot(errors, jitter, **SPRING)
            high = errors.max() if len(errors) < FEW else errors.quantile(0.95)
            axes.plot([errors.median(), high], [place + side] * 2, color=look["color"], linewidth=1.6)
            axes.plot(errors.median(), place + side, linestyle="none", markersize=4.5, **look)
    axes.grid(axis="y", visible=False)
