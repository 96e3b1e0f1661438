"""Force and rate against deflection, of models and of a measurement."""

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np
from matplotlib.figure import Figure

from coilspring import EquilibriumPath, InputError
from coilspring.measured import Measured
from coilspring.scene.scene import load_directions
from validation.calibration.difference import along_load, differences
from validation.calibration.rateaxis import end_axis
from validation.calibration.slope import LABEL, slope
from validation.study import style
from validation.study.models import BEAM, WIRE
from validation.study.plots import FEW, marked, png, styled

POINTS: style.Look = {"color": "black", "marker": "o", "linestyle": "", "markersize": 2.0, "zorder": 3.0}
SLOPE: style.Look = {"color": "0.2", "linewidth": 0.8, "zorder": 3.0, "label": LABEL}
LOOSE: style.Look = {"linestyle": "", "clip_on": False}  # rates of few steps: between them they are unknown
GIVEN_LINE: style.Look = {"color": style.GREY, "linewidth": 1.4, "linestyle": (0, (1, 1.2))}
Looks = Mapping[str, tuple[str, style.Look]]  # labels and lines, by model
Paths = Mapping[str, EquilibriumPath]
LOOKS: Looks = {
    BEAM: (style.BEAM_LABEL, style.BEAM_LINE),
    WIRE: (style.WIRE_LABEL, style.WIRE_LINE),
}
FIT: Looks = {"given": ("scene as given", GIVEN_LINE), "calibrated": ("calibrated", style.BEAM_LINE)}
DEFLECTION = "deflection along the load (mm)"
MOST = 80  # measured points that are drawn


def load_curves(
    paths: Paths, curve: Measured | None = None, looks: Looks = LOOKS, compared: Paths | None = None
) -> bytes:
    """A PNG: force and rate against the deflection in the direction of the load, beside a measurement."""
    with styled():
        return png(picture(paths, curve, looks, compared))


def picture(
    paths: Paths, curve: Measured | None, looks: Looks = LOOKS, compared: Paths | None = None
) -> Figure:
    """The figure of `load_curves`; with a measurement, the differences from it stand below the forces: those
    of the paths `compared`, where these are others. They are drawn, too, where they are `finer`."""
    figure = Figure(figsize=(style.DOUBLE, 2.8 if curve is None else 3.6), layout="constrained")
    mosaic: Any = [["force", "rate"]] + ([["difference", "rate"]] if curve else [])
    plots = figure.subplot_mosaic(mosaic, height_ratios=[2.0, 1.0] if curve else None)
    plots["difference" if curve else "force"].set_xlabel(DEFLECTION)
    if curve is not None:
        some = np.unique(np.linspace(0, curve.force.size - 1, MOST).astype(int))
        plots["force"].plot(curve.deflection[some], curve.force[some], **POINTS, label="measured")
        plots["difference"].axhline(0.0, color="black", linewidth=0.5)
        plots["difference"].sharex(plots["force"])
        plots["force"].tick_params(labelbottom=False)
        kind = "force" if any(path.scene.load.displacement for path in paths.values()) else "deflection"
        plots["difference"].set_ylabel(f"{kind}: model\n− measured (%)")
    finest = {name: finer(path, (compared or paths)[name]) for name, path in paths.items()}
    drawn = {name: path for name, path in finest.items() if len(path.times)}
    rates = {name: from_rest(path) for name, path in drawn.items()}
    for name, path in drawn.items():
        label, look = looks[name]
        few, look = len(path.times) <= FEW, marked(look, len(path.times))
        deflection, force = along_load(path)
        plots["force"].plot(deflection, force, **look, label=label)
        plots["rate"].plot(deflection, rates[name], **look | (LOOSE if few else {}))
        if curve is not None:
            at, shares = differences((compared or paths)[name], curve)
            plots["difference"].plot(at, 100.0 * shares, **POINTS | {"color": look["color"]})
    plots["force"].set(ylabel="force along the load (N)", xlim=(0.0, None), ylim=(0.0, None))
    if curve is not None and (found := slope(curve))[0].size:
        plots["rate"].plot(*found, **SLOPE)
    plots["rate"].set(xlabel=DEFLECTION, ylabel="rate (N/mm)", xlim=(0.0, None))
    end_axis(plots["rate"], [(path, rates[name]) for name, path in drawn.items()])
    lines, labels = plots["force"].get_legend_handles_labels()
    if slopes := [line for line in plots["rate"].get_lines() if line.get_label() == LABEL]:
        lines, labels = [lines[0], *slopes, *lines[1:]], [labels[0], LABEL, *labels[1:]]
    figure.legend(lines, labels, loc="outside lower center", ncols=2 if slopes else 3)
    return figure


def finer(path: EquilibriumPath, other: EquilibriumPath) -> EquilibriumPath:
    """Of two paths of one load the one of more steps: between few, rates that jump are seen as ramps."""
    same = replace(other.scene.load, steps=path.scene.load.steps) == path.scene.load
    return other if same and len(other.times) > len(path.times) else path


def from_rest(path: EquilibriumPath) -> np.ndarray:
    """Rates of a path, of the unloaded spring first; that one is nan of a law that is not known here."""
    start = load_directions(path.scene, np.zeros(1))
    try:
        first = path.shape.rates(path.shape.rest[None], None, start)
    except InputError:
        first = np.full(1, np.nan)
    return np.append(first, path.rates)
