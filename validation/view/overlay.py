"""One spring by both models in one picture: what the top does, and where the coils are."""

from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from coilspring import EquilibriumPath
from coilspring.curves import COMPONENTS, Curve, moved, over_peak
from validation.study import style
from validation.study.plots import both, discs, png, styled, to_scale

LABELS = dict(zip(COMPONENTS, style.TIP_LABELS, strict=True))
DIFFERENCE: style.Look = {"color": "black", "linewidth": 1.0}
KEY: tuple[style.Look, ...] = (
    {**style.BEAM_LINE, "label": style.BEAM_LABEL},
    {**style.WIRE_LINE, "label": style.WIRE_LABEL},
)
REST: style.Look = {"color": style.GREY, "marker": "o", "linestyle": "", "markerfacecolor": "none"}


def overlay(beam: EquilibriumPath, wire: EquilibriumPath) -> bytes:
    """`picture` as a PNG."""
    with styled():
        return png(picture(beam, wire))


def picture(beam: EquilibriumPath, wire: EquilibriumPath) -> Figure:
    """What the top does, and the contact circles at the last time that both reached.

    Where the top moves along the axis alone: force against deflection, and the difference of both curves.
    Else each component that moves, against the load; where UY is prescribed the axial force.
    """
    free = np.array(COMPONENTS)[moved(np.concatenate((beam.tips, wire.tips)))].tolist()
    figure = Figure(figsize=(style.DOUBLE, 4.4), layout="constrained")
    axial = free == ["uy"]
    names = ["curve", "difference"] if axial else free or list(COMPONENTS)
    heights = (2.2, 1.0) if axial else [1.0] * len(names)
    rows: Any = [[name, "shape"] for name in names]
    plots = figure.subplot_mosaic(rows, width_ratios=(1.15, 1.0), height_ratios=heights)
    for name in names[:-1]:
        plots[name].sharex(plots[names[-1]])
        plots[name].tick_params(labelbottom=False)
    if axial:
        _axial(plots["curve"], plots["difference"], beam, wire)
    else:
        _curves([plots[name] for name in names], names, beam, wire)
    _shape(plots["shape"], beam, wire)
    reached = [look for look, path in zip(KEY, (beam, wire), strict=True) if len(path.times)]
    key = [Line2D([], [], **look) for look in (*reached, REST | {"label": "at rest"})]
    figure.legend(handles=key, loc="outside lower center", ncols=3)
    return figure


def _axial(above: Axes, below: Axes, beam: EquilibriumPath, wire: EquilibriumPath) -> None:
    """Force against deflection, pressing counted up, and below by what the models differ where both have the
    same load, or the same deflection where that is prescribed."""
    deflections = [-path.tips[:, 1] for path in (beam, wire)]
    forces = [-path.loads[:, 1] for path in (beam, wire)]
    both(above, (deflections[0], forces[0]), (deflections[1], forces[1]))
    above.set_ylabel("force −FY (N)")
    what, values = ("force", forces) if beam.scene.load.displacement else ("deflection", deflections)
    _, mine, theirs = np.intersect1d(beam.times, wire.times, return_indices=True)
    difference = 100.0 * over_peak(values[0][mine, None], values[1][:, None], theirs)
    below.plot(np.append(0.0, deflections[1][theirs]), np.append(0.0, difference), **DIFFERENCE)
    below.axhline(0.0, color="black", linewidth=0.5)
    below.set(xlabel="deflection −UY (mm)", ylabel=f"beam − wire model,\n{what} (% of peak)")


def _curves(plots: list[Axes], names: list[str], beam: EquilibriumPath, wire: EquilibriumPath) -> None:
    """Components of both models over the load, or over time where the load has a history."""
    load, paths = beam.scene.load, (beam, wire)
    by_time = load.stages or load.displacement
    along = [path.times if by_time else np.hypot(*path.loads.T) for path in paths]
    for axes, name in zip(plots, names, strict=True):
        both(axes, *((x, Curve.of(path).by_name[name]) for x, path in zip(along, paths, strict=True)))
        driven = name == "uy" and load.displacement
        axes.set(ylabel="force FY (N)" if driven else LABELS[name], xlim=(0.0, None))
    plots[-1].set_xlabel("time" if by_time else "load |F| (N)")


def _shape(axes: Axes, beam: EquilibriumPath, wire: EquilibriumPath) -> None:
    """The contact circles of both models, to scale."""
    spring = beam.scene.spring
    common, mine, theirs = np.intersect1d(beam.times, wire.times, return_indices=True)
    groups = [(spring.points(spring.circle_phases())[:, :2], style.REST_CIRCLE)]
    if common.size:
        groups.append((beam.circle_centres(mine[-1]), style.BEAM_CIRCLE))
        groups.append((wire.circle_centres(theirs[-1]), style.WIRE_CIRCLE))
    for centres, look in groups:
        discs(axes, centres, spring.wire_diameter, **look)
    every = np.concatenate([centres for centres, _ in groups])
    title = f"contact circles at time {common[-1]:g}" if common.size else "no common step"
    to_scale(axes, every, spring.wire_diameter, title=title)
