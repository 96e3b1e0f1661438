"""A picture of a spring at rest."""

import math
from collections.abc import Mapping
from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import LinearSegmentedColormap
from matplotlib.figure import Figure

from coilspring import Scene, Spring
from coilspring.scene.sizing import along, sizes
from validation.study.files import write_bytes
from validation.study.plots import discs, png, styled, to_scale
from validation.study.style import BLUE, DOUBLE, RED

DISCS = 8  # along a wire diameter, of which the wire is drawn
MOST_DISCS = 20_000
WIRE = LinearSegmentedColormap.from_list("wire", ("#dfe6f0", BLUE))  # from far to near


def draw(scene: Scene, target: Path) -> None:
    """Write a PNG: the spring at rest from the side, and its coils' diameter, pitch and closing force."""
    with styled():
        figure = Figure(figsize=(DOUBLE, 4.4), layout="constrained")
        plots = figure.subplot_mosaic(
            [["side", "diameter"], ["side", "pitch"], ["side", "closing"]], width_ratios=(1.0, 1.1)
        )
        _side(plots["side"], scene.spring)
        _coils(plots, scene)
        write_bytes(target, png(figure))


def _side(axes: Axes, spring: Spring) -> None:
    """The wire from the side, nearer parts darker, and its sections in the working plane."""
    d, (first, last) = spring.wire_diameter, spring.phase_range
    length = (last - first) * float(spring.radius(np.linspace(first, last, 200)).max())
    count = min(math.ceil(length / d * DISCS), MOST_DISCS)
    points = spring.points(np.linspace(first, last, count))
    points = points[np.argsort(points[:, 2])]
    discs(axes, points[:, :2], d, array=points[:, 2], cmap=WIRE, linewidths=0.0)
    sections = spring.points(spring.circle_phases())[:, :2]
    discs(axes, sections, d, facecolors="none", edgecolors="black", linewidths=0.7)
    axes.plot((0.0, 0.0), (0.0, spring.active_height), color=RED, linewidth=0.6, marker="o", markersize=2.5)
    to_scale(axes, points, d, title="at rest, with the reference points")


def _coils(plots: Mapping[str, Axes], scene: Scene) -> None:
    """Diameter, pitch and closing force along the active coils."""
    coils, force = along(scene), sizes(scene).force
    for name, limit, title in (
        ("diameter", math.inf, "coil diameter (mm)"),
        ("pitch", scene.spring.wire_diameter, "pitch; wire, dashed (mm)"),
        ("closing", force, "closes at; load, dashed (N)"),
    ):
        axes, values = plots[name], getattr(coils, name)
        axes.plot(coils.turns, values, color=BLUE)
        top = float(values.max())
        if math.isfinite(limit):
            axes.axhline(limit, color=RED, linewidth=0.8, linestyle="--")
            top = max(top, limit)
        axes.set(title=title, xlim=(0.0, coils.turns[-1]), ylim=(0.0, 1.1 * top if top > 0.0 else 1.0))
    plots["closing"].set_xlabel("active coil, from the bottom")
