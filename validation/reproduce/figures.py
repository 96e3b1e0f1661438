"""Figures 5, 7 and 8 of the paper, and one more on sliding."""

from __future__ import annotations

import numpy as np
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from coilspring import EquilibriumPath
from validation.study.cases import PathStore, case
from validation.study.plots import TIPS, both
from validation.study.style import (
    BEAM_LABEL,
    BEAM_LINE,
    BLUE,
    DOUBLE,
    RED,
    SINGLE,
    STEEL,
    WIRE_LABEL,
    WIRE_LINE,
    Look,
)

CONTACT_LINE: Look = {"color": "black", "linewidth": 1.0}
HELD_LINE: Look = {"color": RED, "linewidth": 2.4, "alpha": 0.7}  # both are of the wire model
FREE_LINE: Look = {"color": "black", "linewidth": 1.0, "linestyle": (0, (4, 2))}
EXACT_LINE: Look = {
    "color": STEEL, "marker": "s", "markerfacecolor": "white", "linewidth": 0.8, "linestyle": "--",
}  # fmt: skip
NO_CONTACT_LINE: Look = {"color": "black", "linewidth": 1.1, "linestyle": (0, (1, 1.3))}


def tip_figure(store: PathStore) -> Figure:
    """Figure 5: tip displacements of Spring A above, the models' differences below."""
    figure = Figure(figsize=(DOUBLE, 4.1), layout="constrained")
    plots = figure.subplots(2, 3, sharex=True, height_ratios=(2.0, 1.0))
    for name, label, line in _contact_and_without("spring-a"):
        beam, wire = store.beam(case(name).scene), store.wire(case(name).scene)
        load = np.hypot(*beam.loads.T)
        for index, (axes, below) in enumerate(plots.T):
            both(axes, (load, beam.tips[:, index]), (load, wire.tips[:, index]))
            axes.annotate(label, (load[-1], beam.tips[-1, index]), **_beside())
            below.plot(load, _share(beam, wire, index), **line)
    for index, (axes, below) in enumerate(plots.T):
        axes.set(ylabel=TIPS[index], xlim=(0.0, 15.0), title=f"({'abc'[index]})")
        below.set(xlabel="load |F| (N)", ylabel="beam softer by (%)")
        below.axhline(0.0, color="black", linewidth=0.5)
    _one_range(plots[1])
    figure.legend(handles=_key(), loc="outside lower center", ncols=4, columnspacing=1.2)
    return figure


def load_figure(store: PathStore) -> Figure:
    """Figure 7: load against deflection of Spring B, and the models' difference."""
    figure = Figure(figsize=(DOUBLE, 2.9), layout="constrained")
    left, right = figure.subplots(1, 2, width_ratios=(1.25, 1.0))
    for name, label, line in _contact_and_without("spring-b"):
        beam, wire = store.beam(case(name).scene), store.wire(case(name).scene)
        load = np.abs(beam.loads[:, 1])
        both(left, (-beam.tips[:, 1], load), (-wire.tips[:, 1], load))
        side = {"xytext": (-6, 0), "ha": "right"} if label == "contact" else {"xytext": (5, -6), "ha": "left"}
        left.annotate(label, (-wire.tips[-10, 1], load[-10]), **(_beside() | side))
        right.plot(load, _share(beam, wire, 1), **line)
    left.set(xlabel="deflection −UY (mm)", ylabel="load |Fy| (N)", xlim=(0, 29), ylim=(0, 205), title="(a)")
    right.set(xlabel="load |Fy| (N)", ylabel="beam softer by (%)", xlim=(0, 205), title="(b)")
    right.axhline(0.0, color="black", linewidth=0.5)
    figure.legend(handles=_key(), loc="outside lower center", ncols=4, columnspacing=1.2)
    return figure


def iteration_figure(store: PathStore) -> Figure:
    """Figure 8: factorisations of the equivalent beam in every substep."""
    figure = Figure(figsize=(DOUBLE, 2.9), layout="constrained")
    lines = (
        ("", "paper", "contact, paper’s tangent", {"color": BLUE, "marker": "o", "linewidth": 1.0}),
        ("", "exact", "contact, exact tangent", EXACT_LINE),
        ("-no-contact", "paper", "no contact, paper’s tangent", NO_CONTACT_LINE),
    )
    for axes, letter in zip(figure.subplots(1, 2), "ab", strict=True):
        for ending, tangent, label, style in lines:
            counts = store.beam(case(f"spring-{letter}{ending}").scene, tangent=tangent).iterations
            axes.plot(
                np.arange(1, counts.size + 1), counts, **style, markersize=2.4, label=label, clip_on=False
            )
        title = f"({letter}) Spring {letter.upper()}"
        axes.set(xlabel="substep", ylabel="iterations", xlim=(0, 51), ylim=(0, None), title=title)
    figure.legend(*axes.get_legend_handles_labels(), loc="outside lower center", ncols=3)
    return figure


def sliding_figure(held: EquilibriumPath, free: EquilibriumPath) -> Figure:
    """Wire model of Spring B without sliding, and frictionless as far as it goes."""
    figure = Figure(figsize=(SINGLE, 2.6), layout="constrained")
    axes = figure.subplots()
    for path, style, label in ((held, HELD_LINE, "no sliding"), (free, FREE_LINE, "frictionless")):
        axes.plot(np.append(0.0, -path.tips[:, 1]), np.append(0.0, -path.loads[:, 1]), **style, label=label)
    axes.plot(-free.tips[-1, 1], abs(free.loads[-1, 1]), "kx", markersize=6, label="last equilibrium")
    axes.set(xlabel="deflection −UY (mm)", ylabel="load |Fy| (N)", xlim=(0, None), ylim=(0, None))
    axes.legend(loc="upper left")
    return figure


def _contact_and_without(name: str) -> tuple[tuple[str, str, dict], ...]:
    """Scene, label and line of the difference, with and without contact."""
    return (name, "contact", CONTACT_LINE), (f"{name}-no-contact", "no contact", NO_CONTACT_LINE)


def _share(beam: EquilibriumPath, wire: EquilibriumPath, index: int) -> np.ndarray:
    """Beam minus wire model in magnitude over the wire model's peak, %: positive where the beam is softer."""
    mine, other = np.abs(beam.tips[:, index]), np.abs(wire.tips[:, index])
    return 100.0 * (mine - other) / other.max()


def _one_range(plots: np.ndarray) -> None:
    """The same vertical range for all."""
    limits = np.array([axes.get_ylim() for axes in plots])
    for axes in plots:
        axes.set_ylim(limits[:, 0].min(), limits[:, 1].max())


def _beside() -> dict[str, object]:
    """Where and how a curve's name stands beside its end."""
    return {"xytext": (3, 0), "textcoords": "offset points", "ha": "left", "va": "center", "fontsize": 7.0}


def _key() -> list[Line2D]:
    return [
        Line2D([], [], **BEAM_LINE, label=BEAM_LABEL),
        Line2D([], [], **WIRE_LINE, label=WIRE_LABEL),
        Line2D([], [], **CONTACT_LINE, label="difference with contact"),
        Line2D([], [], **NO_CONTACT_LINE, label="difference without"),
    ]
