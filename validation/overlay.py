"""One spring by both models in one picture: what the top does, and where the coils are."""

from __future__ import annotations

import matplotlib
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from coilspring import EquilibriumPath
from validation.figures import TIPS, both, discs, png
from validation.metrics import COMPONENTS, answered
from validation.springfigures import BEAM_CIRCLE, REST_CIRCLE, WIRE_CIRCLE
from validation.style import BEAM_LABEL, BEAM_LINE, DOUBLE, GREY, RC, WIRE_LABEL, WIRE_LINE

LABELS = dict(zip(COMPONENTS, TIPS, strict=True))
HELD = 1e-9  # mm, rad: tips below are held freedoms' rounding


def overlay(beam: EquilibriumPath, wire: EquilibriumPath) -> bytes:
    """A PNG: displacements of the top, or the axial force where UY is prescribed, and the contact circles at
    the last time that both reached."""
    with matplotlib.rc_context(RC):
        figure = Figure(figsize=(DOUBLE, 4.4), layout="constrained")
        plots = figure.subplot_mosaic([[name, "shape"] for name in LABELS], width_ratios=(1.15, 1.0))
        for name in LABELS:
            _curve(plots[name], beam, wire, name)
            plots[name].tick_params(labelbottom=name == "rotz")
        plots["rotz"].set_xlabel(_abscissa(beam)[1])
        _shape(plots["shape"], beam, wire)
        figure.legend(handles=_key(), loc="outside lower center", ncols=3)
        return png(figure)


def _abscissa(path: EquilibriumPath) -> tuple[np.ndarray, str]:
    """What grows along a path: its load, or the time of its history."""
    load = path.scene.load
    if load.stages or load.displacement:
        return path.times, "time"
    return np.hypot(*path.loads.T), "load |F| (N)"


def _curve(axes: Axes, beam: EquilibriumPath, wire: EquilibriumPath, name: str) -> None:
    """One component of both models."""
    values = [answered(path)[name] for path in (beam, wire)]
    both(axes, (_abscissa(beam)[0], values[0]), (_abscissa(wire)[0], values[1]))
    if max(np.abs(each).max(initial=0.0) for each in values) < HELD:
        axes.set_ylim(-1.0, 1.0)  # its rounding is no curve
    driven = name == "uy" and beam.scene.load.displacement
    axes.set(ylabel="force FY (N)" if driven else LABELS[name], xlim=(0.0, None))


def _shape(axes: Axes, beam: EquilibriumPath, wire: EquilibriumPath) -> None:
    """The contact circles of both models, to scale."""
    spring = beam.scene.spring
    common, mine, theirs = np.intersect1d(beam.times, wire.times, return_indices=True)
    groups = [(spring.points(spring.circle_phases())[:, :2], REST_CIRCLE)]
    if common.size:
        groups += [
            (beam.circle_centres(mine[-1]), BEAM_CIRCLE),
            (wire.circle_centres(theirs[-1]), WIRE_CIRCLE),
        ]
    for centres, look in groups:
        discs(axes, centres, spring.wire_diameter, **look)
    every = np.concatenate([centres for centres, _ in groups])
    low, high = every.min(axis=0) - spring.wire_diameter, every.max(axis=0) + spring.wire_diameter
    title = f"contact circles at time {common[-1]:g}" if common.size else "no common step"
    axes.set(aspect="equal", xlim=(low[0], high[0]), ylim=(low[1], high[1]), xlabel="X (mm)", title=title)
    axes.set_ylabel("Y (mm)")
    axes.grid(False)


def _key() -> list[Line2D]:
    return [
        Line2D([], [], **BEAM_LINE, label=BEAM_LABEL),
        Line2D([], [], **WIRE_LINE, label=WIRE_LABEL),
        Line2D([], [], color=GREY, marker="o", linestyle="", markerfacecolor="none", label="at rest"),
    ]
