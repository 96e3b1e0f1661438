"""Draws the deforming wire by pyvista; the subprocess of `validation.view.animation`."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from validation.study.style import GREY
from validation.view.frames import Frames
from validation.view.process import given
from validation.view.render3d import aim, tubes
from validation.view.shapes import picture_frame, view

if TYPE_CHECKING:
    import pyvista

PIXELS = [1000, 720]  # room for the scale beside the spring
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
    """Show the frames given in `folder` in a window, or draw them as PNG files there."""
    import pyvista

    window = what == "window"
    plotter = pyvista.Plotter(off_screen=not window, window_size=PIXELS, lighting=LIGHTS)
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
    import pyvista

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
    import pyvista

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
