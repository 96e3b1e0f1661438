"""Deformed shapes of both models at full load, as Figures 4 and 6 show them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from coilspring import EquilibriumPath
from validation.study.cases import PathStore, case
from validation.study.document import Table

POINTS_PER_TURN = 80  # of the pictures
DATA_STRIDE = 4  # of those points, in the CSV files
VIEW = (0.35, 0.28, 1.0)  # from where the springs are looked at in space
# In space the wire model is drawn as bands around the beam's tube, like dashes over a line, and a
# little thicker, so that coinciding surfaces do not fight for the same pixels.
BAND_SCALE = 1.08
BANDS_PER_TURN = 4
BAND_SHARE = 0.4  # of the wire's length under a band


@dataclass(frozen=True)
class Shapes:
    """One panel: the wire at rest and as both models deform it.

    Attributes
    ----------
    name, title, spring : scene, what to write above the panel, and the name of the case.
    diameter : of the wire, mm.
    rest, beam, wire : (points, 3) centrelines, mm.
    rest_circles, beam_circles, wire_circles : (circles, 2) where the wire crosses the working plane, mm.
    """

    name: str
    title: str
    spring: str
    diameter: float
    rest: np.ndarray
    beam: np.ndarray
    wire: np.ndarray
    rest_circles: np.ndarray
    beam_circles: np.ndarray
    wire_circles: np.ndarray

    def overlaps(self, circles: np.ndarray) -> np.ndarray:
        """Overlap of each circle with its neighbour one coil above, 0 where apart, mm."""
        return overlaps(circles, self.diameter)


def overlaps(circles: np.ndarray, diameter: float) -> np.ndarray:
    """Overlap of each circle with its neighbour one coil above, 0 where apart, mm."""
    distance = np.linalg.norm(circles[2:] - circles[:-2], axis=1)
    # closed coils lie at one diameter: what rounding leaves is no overlap
    return np.where(distance < diameter - 1e-9, diameter - distance, 0.0)


def shapes(store: PathStore, name: str) -> Shapes:
    """Shapes of a catalogue scene at full load."""
    scene = case(name).scene
    beam, wire = store.beam(scene), store.wire(scene)
    spring = scene.spring
    contact = "with contact" if scene.contact.enabled else "without contact"
    return Shapes(
        name=name,
        title=contact,
        spring=case(name).title,
        diameter=spring.wire_diameter,
        rest=spring.points(_phases(beam)),
        beam=beam.centreline(-1, POINTS_PER_TURN),
        wire=wire.centreline(-1, POINTS_PER_TURN),
        rest_circles=spring.points(spring.circle_phases())[:, :2],
        beam_circles=beam.circle_centres(-1),
        wire_circles=wire.circle_centres(-1),
    )


def _phases(path: EquilibriumPath) -> np.ndarray:
    first, last = path.scene.spring.phase_range
    count = round((last - first) / (2.0 * np.pi) * POINTS_PER_TURN) + 1
    return np.linspace(first, last, count)


def view() -> np.ndarray:
    """Axes of the picture as rows: to the right, up, towards the eye."""
    toward = np.array(VIEW) / np.linalg.norm(VIEW)
    right = np.cross((0.0, 1.0, 0.0), toward)
    right /= np.linalg.norm(right)
    return np.array([right, np.cross(toward, right), toward])


def bands(points: np.ndarray) -> list[np.ndarray]:
    """Pieces of a wire with spaces between them."""
    period = POINTS_PER_TURN // BANDS_PER_TURN
    length = round(BAND_SHARE * period) + 1
    first = (period - length) // 2
    return [points[start : start + length] for start in range(first, len(points) - length, period)]


def centreline_table(panels: tuple[Shapes, ...]) -> Table:
    """Centrelines of all panels, one row a point."""
    rows = []
    for panel in panels:
        for model in ("rest", "beam", "wire"):
            points = getattr(panel, model)[::DATA_STRIDE]
            label = {"rest": "at rest", "beam": "equivbeam", "wire": "wirefe"}[model]
            rows += [
                (
                    panel.name,
                    label,
                    f"{index * DATA_STRIDE / POINTS_PER_TURN:g}",
                    *(f"{x:.5f}" for x in point),
                )
                for index, point in enumerate(points)
            ]
    return Table(("scene", "model", "turn", "x_mm", "y_mm", "z_mm"), tuple(rows))


def circle_table(panels: tuple[Shapes, ...]) -> Table:
    """Contact circles of all panels and their overlap with the neighbour one coil above."""
    rows = []
    for panel in panels:
        for label, circles in (("equivbeam", panel.beam_circles), ("wirefe", panel.wire_circles)):
            overlap = np.append(panel.overlaps(circles), (0.0, 0.0))
            rows += [
                (panel.name, label, str(index), f"{x:.6f}", f"{y:.6f}", f"{gap:.6f}")
                for index, ((x, y), gap) in enumerate(zip(circles, overlap, strict=True))
            ]
    return Table(("scene", "model", "circle", "x_mm", "y_mm", "overlap_mm"), tuple(rows))
