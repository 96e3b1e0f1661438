"""One spring by both models in one picture: what the top does, and where the coils are."""

from __future__ import annotations

from collections.abc import Sequence

import matplotlib
import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import EllipseCollection
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from coilspring import EquilibriumPath
from validation.figures import png
from validation.springfigures import BEAM_CIRCLE, REST_CIRCLE, WIRE_CIRCLE
from validation.style import BEAM_LABEL, BEAM_LINE, DOUBLE, GREY, RC, WIRE_LABEL, WIRE_LINE

COMPONENTS = ("UX (mm)", "UY (mm)", "ROTZ (rad)")


def overlay(beam: EquilibriumPath, wire: EquilibriumPath) -> bytes:
    """A PNG: displacements of the top, or the axial force where UY is prescribed, and the contact circles at
    the last time that both reached."""
    with matplotlib.rc_context(RC):
        figure = Figure(figsize=(DOUBLE, 4.4), layout="constrained")
        names = ("ux", "uy", "rotz")
        plots = figure.subplot_mosaic([[name, "shape"] for name in names], width_ratios=(1.15, 1.0))
        for index, name in enumerate(names):
            _curve(plots[name], (beam, wire), index)
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


def _curve(axes: Axes, paths: Sequence[EquilibriumPath], index: int) -> None:
    """One component of both models, from the unloaded spring on."""
    driven = index == 1 and bool(paths[0].scene.load.displacement)
    largest = 0.0
    for path, style in zip(paths, (BEAM_LINE, WIRE_LINE), strict=True):
        values = path.loads[:, 1] if driven else path.tips[:, index]
        axes.plot(np.append(0.0, _abscissa(path)[0]), np.append(0.0, values), **style)
        largest = max(largest, float(np.abs(values).max(initial=0.0)))
    if largest < 1e-9:
        axes.set_ylim(-1.0, 1.0)  # held: its rounding is no curve
    axes.set(ylabel="force FY (N)" if driven else COMPONENTS[index], xlim=(0.0, None))
    if index < 2:
        axes.tick_params(labelbottom=False)


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
        size = np.full(len(centres), spring.wire_diameter)
        axes.add_collection(
            EllipseCollection(
                size, size, np.zeros(len(centres)), units="xy", offsets=centres,
                offset_transform=axes.transData, **look,
            )
        )  # fmt: skip
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
