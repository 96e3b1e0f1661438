"""Figure of the study of random springs: error of both laws by kind of load and support."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import matplotlib
import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from validation.study.output import write_bytes
from validation.study.plots import png
from validation.study.style import BLUE, DOUBLE, GREY, NAVY, RC
from validation.verification.randompage import CLASSES, FEW, classified
from validation.verification.randomscenes import KINDS

FILE = Path("reports/errorbudget/randomsprings.png")
LOOKS: dict[str, dict[str, Any]] = {
    "helix": {"color": NAVY, "marker": "D", "label": "helix law, median to 95th percentile"},
    "haringx": {"color": BLUE, "marker": "o", "label": "paper's law, likewise"},
}
SPRING: dict[str, Any] = {
    "color": GREY,
    "marker": ".",
    "linestyle": "none",
    "markersize": 2.4,
    "alpha": 0.6,
    "markeredgewidth": 0,
}
PANELS = (("(a) no pair closes", CLASSES[:2]), ("(b) pairs close", CLASSES[2:]))
BESIDE, SPREAD = 0.19, 0.11  # of a law from the middle of its row, and of single springs around it


def write(data: pd.DataFrame, file: Path = FILE) -> None:
    """Write the PNG."""
    looks: Any = RC
    with matplotlib.rc_context(looks):
        write_bytes(file, png(draw(classified(data))))


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
