"""Figures 5, 7 and 8 of the paper, and one more on sliding; the first three are views of their data."""

from __future__ import annotations

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from coilspring import EquilibriumPath
from validation.reproduce.curves import CONTACT, TANGENTS, TIPS
from validation.study import style
from validation.study.metrics import peaks
from validation.study.plots import TIPS as LABELS
from validation.study.plots import both

DOTTED = (0, (1, 1.3))
DIFFERENCES: dict[str, style.Look] = {
    "contact": {"color": "black", "linewidth": 1.0},
    "no_contact": {"color": "black", "linewidth": 1.1, "linestyle": DOTTED},
}
COUNTS: dict[str, style.Look] = {
    "paper": {"color": style.BLUE, "marker": "o", "markersize": 2.4},
    "exact": {"color": style.NAVY, "marker": "s", "markersize": 2.4, "markerfacecolor": "white"},
}
STICKING_LINE: style.Look = {"color": style.RED, "linewidth": 2.4, "alpha": 0.5}  # both are of the wire model
FREE_LINE: style.Look = {"color": style.RED, "linewidth": 1.0, "linestyle": (0, (4, 2))}


def tip_figure(data: pd.DataFrame) -> Figure:
    """Figure 5: tip displacements of Spring A above, the models' differences below."""
    figure = Figure(figsize=(style.DOUBLE, 4.1), layout="constrained")
    plots = figure.subplots(2, 3, sharex=True, height_ratios=(2.0, 1.0))
    load = data["load_N"].to_numpy()
    for letter, tip, label, (axes, below) in zip("abc", TIPS, LABELS, plots.T, strict=True):
        for tag in CONTACT:
            beam, wire = _curves(data, tip, tag)
            both(axes, (load, beam), (load, wire))
            _name(axes, tag, load, beam, upper=(tag == "contact") == (beam[-1] < 0.0))
            below.plot(load, _share(beam, wire), **DIFFERENCES[tag])
        axes.set(ylabel=label, xlim=(0.0, load[-1]), title=f"({letter}) {label.split()[0]}")
        below.set(xlabel="load |F| (N)")
        below.axhline(0.0, color="black", linewidth=0.5)
    plots[1, 0].set_ylabel("beam softer by (%)")
    limits = np.array([axes.get_ylim() for axes in plots[1]])
    for axes in plots[1]:
        axes.set_ylim(limits[:, 0].min(), limits[:, 1].max())
    figure.legend(handles=_key(), loc="outside lower center", ncols=4, columnspacing=1.2)
    return figure


def load_figure(data: pd.DataFrame) -> Figure:
    """Figure 7: load against deflection of Spring B, and the models' difference."""
    figure = Figure(figsize=(style.DOUBLE, 2.9), layout="constrained")
    left, right = figure.subplots(1, 2, width_ratios=(1.25, 1.0))
    load = data["load_N"].to_numpy()
    for tag in CONTACT:
        beam, wire = _curves(data, "uy_mm", tag)
        both(left, (-beam, load), (-wire, load))
        _name(left, tag, -beam, load, upper=tag == "contact")
        right.plot(load, _share(beam, wire), **DIFFERENCES[tag])
    left.set(xlabel="deflection −UY (mm)", ylabel="load |Fy| (N)", title="(a) Load and deflection")
    left.set(xlim=(0.0, -data.filter(like="uy_mm").to_numpy().min()), ylim=(0.0, load[-1]))
    right.set(xlabel="load |Fy| (N)", ylabel="beam softer by (%)", title="(b) Difference of the models")
    right.set(xlim=(0.0, load[-1]))
    right.axhline(0.0, color="black", linewidth=0.5)
    figure.legend(handles=_key(), loc="outside lower center", ncols=4, columnspacing=1.2)
    return figure


def iteration_figure(data: pd.DataFrame) -> Figure:
    """Figure 8: factorisations of the equivalent beam in every substep."""
    figure = Figure(figsize=(style.DOUBLE, 2.9), layout="constrained")
    for axes, letter in zip(figure.subplots(1, 2), "ab", strict=True):
        for end, words, dashes in (("", "contact", "-"), ("-no-contact", "no contact", DOTTED)):
            for tangent in TANGENTS:
                counts = data[f"spring-{letter}{end}_{tangent}_tangent"]
                look = COUNTS[tangent] | ({} if dashes == "-" else {"marker": ""})
                name = f"{words}, {tangent.replace('paper', 'paper’s')} tangent"
                look |= {"linestyle": dashes, "linewidth": 1.0, "clip_on": False}
                axes.plot(data["substep"], counts, **look, label=name)
        title = f"({letter}) Spring {letter.upper()}"
        axes.set(xlabel="substep", ylabel="iterations", xlim=(0, len(data)), ylim=(0, None), title=title)
    figure.legend(*axes.get_legend_handles_labels(), loc="outside lower center", ncols=2)
    return figure


def sliding_figure(sticking: EquilibriumPath, free: EquilibriumPath) -> Figure:
    """Wire model of Spring B without sliding, and frictionless as far as it goes."""
    figure = Figure(figsize=(style.SINGLE, 2.6), layout="constrained")
    axes = figure.subplots()
    lines = ((sticking, STICKING_LINE, "sticking contact"), (free, FREE_LINE, "frictionless"))
    for path, look, label in lines:
        axes.plot(np.append(0.0, -path.tips[:, 1]), np.append(0.0, -path.loads[:, 1]), **look, label=label)
    axes.plot(-free.tips[-1, 1], abs(free.loads[-1, 1]), "kx", markersize=6, label="last equilibrium")
    axes.set(xlabel="deflection −UY (mm)", ylabel="load |Fy| (N)", xlim=(0, None), ylim=(0, None))
    axes.legend(loc="upper left")
    return figure


def _curves(data: pd.DataFrame, tip: str, tag: str) -> tuple[np.ndarray, np.ndarray]:
    """A tip displacement of the equivalent beam and of the wire model."""
    return data[f"{tip}_{tag}_equivbeam"].to_numpy(), data[f"{tip}_{tag}_wirefe"].to_numpy()


def _share(beam: np.ndarray, wire: np.ndarray) -> np.ndarray:
    """Beam minus wire model in magnitude over the wire model's peak, %: positive where the beam is softer."""
    return 100.0 * (np.abs(beam) - np.abs(wire)) / peaks(wire[:, None])


def _name(axes: Axes, tag: str, x: np.ndarray, y: np.ndarray, upper: bool) -> None:
    """A curve's name near its end, on its free side; `upper`: above the other curve."""
    left = upper == (y[-1] > y[0])
    place = (x[-8], y[-8]) if left else (x[-16], y[-16])
    axes.annotate(
        tag.replace("_", " "),
        place,
        textcoords="offset points",
        fontsize=7.0,
        xytext=(-5 if left else 4, 3 if upper else -3),
        ha="right" if left else "left",
        va="bottom" if upper else "top",
    )


def _key() -> list[Line2D]:
    return [
        Line2D([], [], **style.BEAM_LINE, label=style.BEAM_LABEL),
        Line2D([], [], **style.WIRE_LINE, label=style.WIRE_LABEL),
        Line2D([], [], **DIFFERENCES["contact"], label="difference with contact"),
        Line2D([], [], **DIFFERENCES["no_contact"], label="difference without"),
    ]
