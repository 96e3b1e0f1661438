"""What the subprocess of `validation.view.process` draws by pyvista: springs in space, frames that move."""

import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pyvista

from validation.study.style import BLUE, GREY, RED
from validation.view.frames import Frames
from validation.view.htmlscene import FILE
from validation.view.process import given
from validation.view.shapes import PIXELS, Shapes, bands, picture_frame, spaces, view

SIDES = 40  # of a tube; where two nearly coincide, fewer make their intersection ragged
LINE = 0.08  # radius of the wire at rest over its own

# springs to be turned in a browser
FEW_SIDES = 16  # of a tube; the file grows with it
GAP, LETTER = 6.0, 1.6  # mm between springs; height of the words
EYE = (0.12, 0.3, 1.4)  # from where it is seen at first, over the width of what is seen
KEY = (("equivalent beam", BLUE), ("wire model, alternating", RED), ("at rest", GREY))

# a window, or pictures of a movie
SIZE = [1000, 720]  # room for the scale beside the spring
SPHERE = 0.62  # radius of a contact sphere over the wire's diameter: to be seen around the tube
TITLE = "contact, N\n"  # clear of the largest number
SCALE = {"color": "black", "fmt": "%.3g", "vertical": True, "position_x": 0.9, "render": False}
SLIDER: dict[str, Any] = {
    **{"title": "step", "title_height": 0.02, "fmt": "%.0f", "color": "black", "interaction_event": "always"},
    **{"pointa": (0.25, 0.08), "pointb": (0.75, 0.08), "slider_width": 0.02, "tube_width": 0.004},
}
LIGHTS = "three lights"  # those of a light kit, which are five, take half as long again
ROOM = 0.8  # of the window's height, which leaves the slider clear of the wire


def main(folder: Path, what: str) -> None:
    """Draw what is given in `folder`, and write it there."""
    if what == "panels":
        draw_panels(folder, given(folder))
    elif what == "scene":
        export_scene(folder, given(folder))
    else:
        draw_frames(folder, window=what == "window")


def draw_panels(folder: Path, panels: Sequence[Shapes]) -> None:
    """Deformed springs, a PNG for each, which one frame holds."""
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


def export_scene(folder: Path, panels: Sequence[Shapes]) -> None:
    """Springs side by side in one HTML file."""
    # a viewer that is not used, but would be downloaded
    sys.modules["trame.widgets.vtklocal"] = None  # type: ignore[assignment]
    plotter = pyvista.Plotter(off_screen=True, window_size=[1200, 800])
    plotter.set_background("white")
    low, high = _row(plotter, panels)
    for i, (words, colour) in enumerate(KEY):
        place = low[0] + (i + 0.5) / len(KEY) * (high[0] - low[0])
        _write(plotter, words, place, low[1] - 5.0 * LETTER, colour)
    camera = plotter.camera
    camera.focal_point = 0.5 * (low + high) - (0.0, 3.0 * LETTER, 0.0)
    camera.position = camera.focal_point + (high[0] - low[0]) * np.array(EYE)
    camera.up = (0.0, 1.0, 0.0)
    plotter.trame.export_html(folder / FILE)


def _row(plotter: pyvista.Plotter, panels: Sequence[Shapes]) -> tuple[np.ndarray, np.ndarray]:
    """Springs side by side with their names below; corners of the box that holds them."""
    springs = [np.concatenate(panel.parts) for panel in panels]
    lows, highs = (np.array([bound(points, axis=0) for points in springs]) for bound in (np.min, np.max))
    widths = (highs - lows)[:, 0]
    lefts = np.cumsum(widths + GAP) - widths - GAP
    low = lows.min(axis=0)
    for panel, move in zip(panels, lefts - lows[:, 0], strict=True):
        moved = [part + np.array((move, 0.0, 0.0)) for part in panel.parts]
        add_spring(plotter, moved, panel.diameter, FEW_SIDES)
        _write(plotter, panel.spring, moved[0][:, 0].mean(), low[1] - 2.0 * LETTER, "black")
    low[0], high = 0.0, highs.max(axis=0)
    high[0] = lefts[-1] + widths[-1]
    return low, high


def _write(plotter: pyvista.Plotter, words: str, centre: float, top: float, colour: str) -> None:
    """Words in the working plane."""
    text = pyvista.Text3D(words, height=LETTER, depth=0.05, center=(centre, top - 0.5 * LETTER, 0.0))
    plotter.add_mesh(text, color=colour, lighting=False)


def draw_frames(folder: Path, window: bool) -> None:
    """The frames given in `folder` in a window, or as PNG files there."""
    plotter = pyvista.Plotter(off_screen=not window, window_size=SIZE, lighting=LIGHTS)
    plotter.set_background("white")
    if not window:
        plotter.show(auto_close=False)  # OpenGL gets ready while the scene is solved
    frames = given(folder)
    draw(plotter, frames, len(frames.times) - 1)
    _scale(plotter, frames)
    aim(plotter, frames.points.reshape(-1, 3), 2.0 * frames.diameter)
    if window:
        last = len(frames.times) - 1

        def go_to(step: float) -> None:
            draw(plotter, frames, round(step))
            plotter.render()

        plotter.camera.zoom(ROOM)
        plotter.add_slider_widget(go_to, (0, last), value=last, **SLIDER)
        plotter.show(title="coilcheck view")
        return
    plotter.enable_anti_aliasing("ssaa")
    for step in range(len(frames.times)):
        draw(plotter, frames, step)
        plotter.render()
        plotter.screenshot(folder / f"{step:04d}.png")
    plotter.close()


def draw(plotter: pyvista.Plotter, frames: Frames, step: int) -> None:
    """Replace the step in the picture, which is not rendered here: each part would cost as much as all."""
    once: dict[str, Any] = {"reset_camera": False, "render": False}
    points, touched = frames.points[step], frames.touched
    wire = tubes([points], 0.5 * frames.diameter, 16)
    plotter.add_mesh(wire, name="wire", color=GREY, ambient=0.3, smooth_shading=True, **once)
    if touched.size:
        spheres = pyvista.PolyData(points[touched])
        spheres[TITLE] = frames.forces[step, touched]
        ball = pyvista.Sphere(radius=SPHERE * frames.diameter, theta_resolution=16, phi_resolution=16)
        plotter.add_mesh(
            spheres.glyph(geom=ball, scale=False, orient=False),
            name="contact",
            scalars=TITLE,
            clim=(0.0, float(frames.forces.max())),
            cmap="viridis",
            scalar_bar_args=SCALE,
            **once,
        )
    time = f"time {frames.times[step]:.3g}"
    plotter.add_text(time, name="time", color="black", font_size=11, render=False)


def _scale(plotter: pyvista.Plotter, frames: Frames) -> None:
    """Directions of the axes, and a round length in the plane of the picture."""
    centre, half = picture_frame(frames.points.reshape(-1, 3), 2.0 * frames.diameter)
    length = 10.0 ** np.floor(np.log10(0.4 * half))
    length *= next(factor for factor in (5.0, 2.0, 1.0) if factor * length <= 0.4 * half)
    right, up, _ = view()
    start = centre - 1.25 * half * right - 0.9 * half * up
    end = start + length * right
    plotter.add_mesh(pyvista.Line(start, end), color="black", line_width=3, reset_camera=False)
    look: dict[str, Any] = {"shape": None, "show_points": False, "always_visible": True}
    plotter.add_point_labels(
        [0.5 * (start + end)], [f"{length:g} mm"], font_size=16, text_color="black", **look
    )
    plotter.add_axes(color="black", viewport=(0.0, 0.1, 0.2, 0.34))


if __name__ == "__main__":
    main(Path(sys.argv[1]), sys.argv[2])
