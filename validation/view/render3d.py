"""3D pictures of deformed springs by pyvista, off screen and in a subprocess.

A subprocess that fails or takes too long costs these pictures, not the run.
"""

from __future__ import annotations

import sys
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from validation.study.style import BLUE, GREY, RED
from validation.view.process import Drawing, given
from validation.view.shapes import Shapes, bands, picture_frame, spaces, view

if TYPE_CHECKING:
    import pyvista

COMMAND = (sys.executable, "-m", "validation.view.render3d")
TIMEOUT = 60.0  # s; a picture takes about one
PIXELS = 1300  # a side
SIDES = 40  # of a tube; where two nearly coincide, fewer make their intersection ragged
LINE = 0.08  # radius of the wire at rest over its own


class Rendering(Drawing):
    """A subprocess that renders panels."""

    def __init__(self, panels: tuple[Shapes, ...]) -> None:
        super().__init__(COMMAND)
        self.give(panels)
        self._files = [self.folder / f"panel{i}.png" for i in range(len(panels))]

    def result(self) -> list[Path] | str:
        """One PNG for each panel, waited for; or in a few words why there are none."""
        return self.failure(TIMEOUT, self._files, "it wrote no picture") or self._files


def main(folder: Path) -> None:
    """Draw the panels given in `folder`; what the subprocess runs."""
    import pyvista

    panels = given(folder)
    diameter = panels[0].diameter
    every = np.concatenate([part for panel in panels for part in panel.parts])  # what the frame has to hold
    behind = 2.0 * np.ptp(every, axis=0).max() * view()[2]  # which a parallel projection does not show
    for i, panel in enumerate(panels):
        plotter = pyvista.Plotter(off_screen=True, window_size=[PIXELS, PIXELS], lighting="light kit")
        plotter.set_background("white")
        add_spring(plotter, (panel.rest - behind, panel.beam, panel.wire), diameter)
        aim(plotter, every, diameter)
        plotter.enable_anti_aliasing("ssaa")
        plotter.screenshot(folder / f"panel{i}.png")
        plotter.close()


def add_spring(
    plotter: pyvista.Plotter, parts: Sequence[np.ndarray], diameter: float, sides: int = SIDES
) -> None:
    """Pieces of the beam's tube and of the wire model's in turn, and a line where the wire was at rest."""
    rest, beam, wire = parts
    radius = 0.5 * diameter
    shine: dict[str, Any] = {"smooth_shading": True, "specular": 0.2, "ambient": 0.35, "diffuse": 0.75}
    plotter.add_mesh(tubes([rest], LINE * radius, 6), color=GREY, lighting=False)
    plotter.add_mesh(tubes(spaces(beam), radius, sides), color=BLUE, **shine)
    plotter.add_mesh(tubes(bands(wire), radius, sides), color=RED, **shine)


def tubes(pieces: list[np.ndarray], radius: float, sides: int) -> pyvista.PolyData:
    """Tubes around lines of points."""
    import pyvista

    lines = [pyvista.PolyData(piece, lines=[len(piece), *range(len(piece))]) for piece in pieces]
    mesh = pyvista.merge(lines, merge_points=False)
    return mesh.tube(radius=radius, n_sides=sides, capping=True)


def aim(plotter: pyvista.Plotter, every: np.ndarray, diameter: float) -> None:
    """Parallel projection whose frame just holds all points."""
    camera = plotter.camera
    camera.focal_point, camera.parallel_scale = picture_frame(every, diameter)
    camera.position = camera.focal_point + 200.0 * view()[2]
    camera.up = (0.0, 1.0, 0.0)
    camera.parallel_projection = True
    plotter.renderer.reset_camera_clipping_range()


if __name__ == "__main__":
    main(Path(sys.argv[1]))
