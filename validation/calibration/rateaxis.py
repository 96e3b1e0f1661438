"""How far the axis of rates goes: as far as the spring is progressive, not as coils pressed solid."""

import numpy as np
from matplotlib.axes import Axes

from coilspring import EquilibriumPath
from coilspring.scene.sizing import sizes
from coilspring.words import plain
from validation.calibration.difference import along_load, undirected
from validation.study.plots import FEW

NEARLY_ALL = 0.95  # of the deflection, over which the usual rates are
# A spring is solid where it has gone so much of its travel, and where its rate is so many times that at rest:
# wires, which are inclined, close a little before the travel, which is that of circles.
GONE, SOLID = 0.95, 10.0
STEEP = 20.0  # times the usual rate, beyond which an axis is cut before solid, too
MARGIN = 1.3  # times the largest rate that is shown, where a cut axis ends
WORTH = 2.0  # times the end of a cut axis: up to such rates it is not cut
LEAST = 0.1  # of the mean rate, which the axis shows on both sides of it


def end_axis(axes: Axes, curves: list[tuple[EquilibriumPath, np.ndarray]]) -> None:
    """Limits of the rates' axis, for paths with their rates from rest on; what is beyond is said in words."""
    shown, cut = [], []
    for path, rates in curves:
        deflection = along_load(path)[0]
        solid = deflection >= solid_from(path, rates)
        far = solid | (rates > STEEP * usual_rate(deflection, rates))
        shown.append(rates[~far & np.isfinite(rates)])
        cut.append((deflection, rates, bool(solid.any())))
    if not curves or not any(each.size for each in shown):
        return
    low, top = (float(bound(np.concatenate(shown))) for bound in (np.min, np.max))
    top *= MARGIN
    cut = [each for each in cut if np.nanmax(each[1]) > WORTH * top > 0.0]
    if not cut:
        _widen(axes, low, top / MARGIN)
    elif any(rates.size <= FEW + 1 for _, rates in curves):
        axes.set_yscale("log")  # marks beyond the end of an axis would not be seen
    else:
        floor = low - (MARGIN - 1.0) * (top - low)
        axes.set_ylim(max(floor, 0.0) if low >= 0.0 else floor, top)
        _say(axes, cut, top)


def solid_from(path: EquilibriumPath, rates: np.ndarray) -> float:
    """Deflection along the load from which on a path presses its spring solid, mm; infinite where nowhere."""
    deflection = along_load(path)[0]
    if undirected(path.scene) or path.scene.direction != (0.0, -1.0):
        return np.inf
    start = next(iter(rates[np.isfinite(rates)]), np.inf)
    solid = (deflection >= GONE * sizes(path.scene).travel) & (rates > SOLID * start)
    return float(deflection[int(np.argmax(solid))]) if solid.any() else np.inf


def usual_rate(deflection: np.ndarray, rates: np.ndarray) -> float:
    """Rate not exceeded over nearly all of the deflection; between two steps the smaller one counts."""
    lengths = np.abs(np.diff(deflection))
    smaller = np.fmin(rates[1:], rates[:-1])
    order = np.argsort(smaller)
    gone = np.cumsum(lengths[order])
    return float(smaller[order][np.searchsorted(gone, NEARLY_ALL * gone[-1])])


def _widen(axes: Axes, low: float, high: float) -> None:
    """Show at least `LEAST` on both sides of rates that hardly vary."""
    mean = 0.5 * (low + high)
    bottom, top = axes.get_ylim()
    axes.set_ylim(min(bottom, mean - LEAST * abs(mean)), max(top, mean + LEAST * abs(mean)))


def _say(axes: Axes, cut: list[tuple[np.ndarray, np.ndarray, bool]], top: float) -> None:
    """Where and how far rates go on beyond the end of the axis, and whether that is of a solid spring."""
    at = min(float(deflection[int(np.argmax(rates > top))]) for deflection, rates, _ in cut)
    most = max(float(np.nanmax(rates)) for _, rates, _ in cut)
    right = at > 0.5 * axes.get_xlim()[1]
    axes.annotate(
        f"{'solid: ' if all(solid for *_, solid in cut) else ''}rises to {plain(most, 3)} N/mm ↑",
        (at, 1.0),
        xycoords=axes.get_xaxis_transform(),
        xytext=(-6.0 if right else 6.0, -3.0),
        textcoords="offset points",
        ha="right" if right else "left",
        va="top",
    )
