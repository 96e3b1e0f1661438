"""3D pictures of deformed springs by pyvista, off screen and in a subprocess.

A subprocess that fails or takes too long costs these pictures, not the run.
"""

from __future__ import annotations

import sys
import tempfile
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from validation.study.style import BLUE, GREY, RED
from validation.view.process import Subprocess
from validation.view.shapes import PARTS, Shapes, bands, picture_frame, spaces, view

if TYPE_CHECKING:
    import pyvista

COMMAND = (sys.executable, "-m", "validation.view.render3d")
TIMEOUT = 60.0  # s; a picture takes about one
PIXELS = 1300  # a side
SIDES = 40  # of a tube; where two nearly coincide, fewer make their intersection ragged
LINE = 0.08  # radius of the wire at rest over its own


class Rendering:
    """A subprocess that renders panels; as a context it cleans up after itself."""

    def __init__(self, panels: tuple[Shapes, ...]) -> None:
        self._folder = tempfile.TemporaryDirectory(prefix="coilcheck-")
        folder = Path(self._folder.name)
        self._files = [folder / f"panel{i}.png" for i in range(len(panels))]
        arrays = {f"{part}{i}": getattr(panel, part) for i, panel in enumerate(panels) for part in PARTS}
        np.savez(folder / "panels.npz", diameter=panels[0].diameter, count=len(panels), **arrays)
        self._process = Subprocess([*COMMAND, str(folder / "panels.npz")])

    def result(self) -> list[Path] | str:
        """One PNG for each panel, waited for; or in a few words why there are none."""
        failure = self._process.failure(TIMEOUT)
        if failure:
            return failure
        return self._files if all(file.is_file() for file in self._files) else "it wrote no picture"

    def __enter__(self) -> Rendering:
        return self

    def __exit__(self, *error: object) -> None:
        self._process.__exit__(*error)
        self._folder.cleanup()


def main(source: Path) -> None:
    """Draw the panels stored in `source` beside it; what the subprocess runs."""
    with np.load(source) as stored:
        data = dict(stored)
    count, diameter = int(data["count"]), float(data["diameter"])
    every = np.concatenate([data[f"{part}{i}"] for i in range(count) for part in PARTS])
    for i in range(count):
        rest, beam, wire = (data[f"{part}{i}"] for part in PARTS)
        _draw(rest, beam, wire, diameter, every, source.parent / f"panel{i}.png")


def _draw(
    rest: np.ndarray, beam: np.ndarray, wire: np.ndarray, diameter: float, every: np.ndarray, file: Path
) -> None:
    """One panel; `every` are all points that the frame has to hold."""
    import pyvista

    plotter = pyvista.Plotter(off_screen=True, window_size=[PIXELS, PIXELS], lighting="light kit")
    plotter.set_background("white")
    behind = 2.0 * np.ptp(every, axis=0).max() * view()[2]  # which a parallel projection does not show
    add_spring(plotter, rest - behind, beam, wire, diameter)
    aim(plotter, every, diameter)
    plotter.enable_anti_aliasing("ssaa")
    plotter.screenshot(file)
    plotter.close()


def add_spring(
    plotter: pyvista.Plotter,
    rest: np.ndarray,
    beam: np.ndarray,
    wire: np.ndarray,
    diameter: float,
    sides: int = SIDES,
) -> None:
    """Pieces of the beam's tube and of the wire model's in turn, and a line where the wire was at rest."""
    radius = 0.5 * diameter
    shine: dict[str, Any] = {"smooth_shading": True, "specular": 0.2, "ambient": 0.35, "diffuse": 0.75}
    plotter.add_mesh(tubes([rest], LINE * radius, 6), color=GREY, lighting=False)
    plotter.add_mesh(tubes(spaces(beam), radius, sides), color=BLUE, **shine)
    plotter.add_mesh(tubes(bands(wire), radius, sides), color=RED, **shine)


def tubes(pieces: list[np.ndarray], radius: float, sides: int) -> pyvista.PolyData:
    """Tubes around lines of points."""
    import pyvista

    lines, start = [], 0
    for piece in pieces:
        lines += [len(piece), *range(start, start + len(piece))]
        start += len(piece)
    mesh = pyvista.PolyData(np.concatenate(pieces), lines=np.array(lines))
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
