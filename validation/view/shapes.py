"""Deformed shapes of both models at full load, as Figures 4 and 6 show them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from validation.study.cases import case
from validation.study.tables import Table

if TYPE_CHECKING:
    from validation.study.paths import PathStore

POINTS_PER_TURN = 80  # of the pictures
DATA_STRIDE = 4  # of those points, in the CSV files
PIXELS = 1300  # a side of a picture in space
PARTS = ("rest", "beam", "wire")  # of a picture in space
VIEW = (0.35, 0.28, 1.0)  # from where the springs are seen in space
# In space pieces of both models alternate: coinciding surfaces would fight for the same pixels.
BANDS_PER_TURN = 4
BAND_SHARE = 0.4  # of the wire's length that the wire model takes


@dataclass(frozen=True)
class Shapes:
    """One panel: the wire at rest and as both models deform it, mm."""

    name: str  # of the scene
    title: str  # above the panel
    spring: str  # name of the case
    diameter: float  # of the wire
    rest: np.ndarray  # (points, 3) centreline
    beam: np.ndarray
    wire: np.ndarray
    rest_circles: np.ndarray  # (circles, 2) where the wire crosses the working plane
    beam_circles: np.ndarray
    wire_circles: np.ndarray

    @property
    def parts(self) -> list[np.ndarray]:
        """What a picture in space shows, by `PARTS`."""
        return [getattr(self, part) for part in PARTS]


def overlaps(circles: np.ndarray, diameter: float) -> np.ndarray:
    """Overlap of each circle with its neighbour one coil above, 0 where there is none, mm."""
    distance = np.linalg.norm(circles[2:] - circles[:-2], axis=1)
    # closed coils lie at one diameter: what rounding leaves is no overlap
    return np.where(distance < diameter - 1e-9, diameter - distance, 0.0)


def shapes(store: PathStore, name: str) -> Shapes:
    """Shapes of a catalogue scene at full load."""
    scene = case(name).scene
    beam, wire, spring = store.beam(scene), store.wire(scene), scene.spring
    first, last = spring.phase_range
    phases = np.linspace(first, last, round((last - first) / (2.0 * np.pi) * POINTS_PER_TURN) + 1)
    return Shapes(
        name=name,
        title="with contact" if scene.contact.enabled else "without contact",
        spring=case(name).title,
        diameter=spring.wire_diameter,
        rest=spring.points(phases),
        beam=beam.centreline(-1, POINTS_PER_TURN),
        wire=wire.centreline(-1, POINTS_PER_TURN),
        rest_circles=spring.points(spring.circle_phases())[:, :2],
        beam_circles=beam.circle_centres(-1),
        wire_circles=wire.circle_centres(-1),
    )


def view() -> np.ndarray:
    """Axes of the picture as rows: to the right, up, towards the eye."""
    toward = np.array(VIEW) / np.linalg.norm(VIEW)
    right = np.cross((0.0, 1.0, 0.0), toward)
    right /= np.linalg.norm(right)
    return np.array([right, np.cross(toward, right), toward])


def picture_frame(points: np.ndarray, diameter: float) -> tuple[np.ndarray, float]:
    """Centre and half the side, mm, of a square picture that just holds wires through the points."""
    axes = view()
    seen = points @ axes.T
    low, high = seen.min(axis=0) - diameter, seen.max(axis=0) + diameter
    return 0.5 * (low + high) @ axes, 0.5 * float((high - low)[:2].max())


def bands(points: np.ndarray) -> list[np.ndarray]:
    """Pieces of a wire with spaces between them."""
    return [points[start : stop + 1] for start, stop in _ends(len(points))]


def spaces(points: np.ndarray) -> list[np.ndarray]:
    """The pieces that `bands` leaves out."""
    ends = np.array([0, *_ends(len(points)).ravel(), len(points) - 1]).reshape(-1, 2)
    return [points[start : stop + 1] for start, stop in ends if stop > start]


def _ends(count: int) -> np.ndarray:
    """First and last points of the bands of a wire of so many points."""
    period = POINTS_PER_TURN // BANDS_PER_TURN
    length = round(BAND_SHARE * period)
    start = np.arange((period - length - 1) // 2, count - length - 1, period)
    return np.stack((start, start + length), axis=1)


def centreline_table(panels: tuple[Shapes, ...]) -> Table:
    """Centrelines of all panels, one row a point."""
    rows = [
        (panel.name, label, f"{index * DATA_STRIDE / POINTS_PER_TURN:g}", *(f"{x:.5f}" for x in point))
        for panel in panels
        for label, points in (("at rest", panel.rest), ("equivbeam", panel.beam), ("wirefe", panel.wire))
        for index, point in enumerate(points[::DATA_STRIDE])
    ]
    return Table(("scene", "model", "turn", "x_mm", "y_mm", "z_mm"), tuple(rows))


def circle_table(panels: tuple[Shapes, ...]) -> Table:
    """Contact circles of all panels and their overlap with the neighbour one coil above."""
    rows = [
        (panel.name, label, str(index), *(f"{value:.6f}" for value in (*centre, overlap)))
        for panel in panels
        for label, circles in (("equivbeam", panel.beam_circles), ("wirefe", panel.wire_circles))
        for index, (centre, overlap) in enumerate(
            zip(circles, (*overlaps(circles, panel.diameter), 0.0, 0.0), strict=True)
        )
    ]
    return Table(("scene", "model", "circle", "x_mm", "y_mm", "overlap_mm"), tuple(rows))
