"""The deforming wire: a series of VTU files, a movie of it, and words where there is no window."""

import errno
import shutil
import sys
from dataclasses import replace

import numpy as np
import pytest
from PIL import Image

import wirefe
from coilspring import Contact, Load, load_scene, scene_text, spring_b
from validation.cli import main
from validation.view import animation, frames, process
from validation.view.process import Drawing


@pytest.fixture(scope="module")
def run(tmp_path_factory):
    folder = tmp_path_factory.mktemp("run")
    arguments = ["solve", "spring-b", "--model", "wirefe", "--steps", "3", "--vtu-series", "--quiet"]
    assert main([*arguments, "--out", str(folder)]) == 0
    return folder


def test_the_series_is_the_path(run):
    """Times, shapes and forces of the run are those of the solved scene, behind a frame at rest."""
    found, solved = frames.of_run(run), frames.of_path(frames.solved(spring_b().with_steps(3)))
    np.testing.assert_allclose(found.times, [0.0, 1 / 3, 2 / 3, 1.0], rtol=1e-11)
    np.testing.assert_allclose(found.points, solved.points, atol=1e-9)
    np.testing.assert_allclose(found.forces, solved.forces, atol=1e-6)
    assert found.diameter == solved.diameter == 1.5
    path = wirefe.solve(spring_b(), steps=3)
    nodes = found.points[:, 40:-40]  # the others are of the end turns
    np.testing.assert_allclose(nodes[0], path.shape.mesh.points, atol=1e-9)
    np.testing.assert_allclose(found.forces[1:].max(axis=1), path.contact_forces.max(axis=1), rtol=1e-9)


WHOLE = {
    "tilted": ("rigid", (), 0.75),
    "without end turns": ("rigid", (), 0.0),
    "plates": ("plate", ("ux", "rotz"), 0.75),
}


@pytest.mark.parametrize("case", WHOLE)
def test_the_whole_wire_is_drawn(case):
    """End turns were left out, against which active coils were seen to close."""
    seat, held, end_turns = WHOLE[case]
    spring = replace(spring_b().spring, end_turns=end_turns)
    supports = replace(spring_b().supports, top_held=held, seat=seat)
    scene = replace(
        spring_b(), spring=spring, supports=supports, load=Load((0.0 if held else -3.0, -20.0), 2)
    )
    found, path = frames.of_path(frames.solved(scene)), wirefe.solve(scene)
    assert held or abs(path.tips[-1, 2]) > 0.02
    assert found.points.shape[:2] == found.forces.shape
    phases = np.linspace(*spring.phase_range, found.points.shape[1])
    np.testing.assert_allclose(found.points[0], spring.points(phases), atol=1e-9)
    for step in range(2):
        np.testing.assert_allclose(found.points[step + 1], path.centreline(step), atol=1e-6)


def test_paraview_opens_the_series(run):
    import pyvista

    reader = pyvista.get_reader(run / "wire.pvd")
    assert reader.time_values == pytest.approx([1 / 3, 2 / 3, 1.0])


def pictures(file):
    with Image.open(file) as movie:
        return movie.n_frames


def test_a_movie_of_a_run(run, tmp_path, capsys):
    movie = tmp_path / "out" / "b.gif"
    assert main(["view", str(run), "--movie", str(movie)]) == 0
    assert pictures(movie) == 4
    assert f"written to {movie}" in capsys.readouterr().out


def test_a_path_that_ends_early_is_said_beside_what_is_shown_of_it(tmp_path, monkeypatch, capsys):
    """As `solve` says it; a movie of a part was written without a word."""
    monkeypatch.setattr(animation, "show", lambda load: load())
    monkeypatch.setattr(animation, "require", lambda movie: None)
    scene = replace(spring_b().with_steps(4), contact=Contact(geometry="spheres"))
    file, movie = tmp_path / "own.toml", tmp_path / "own.gif"
    file.write_text(scene_text(scene))
    path = frames.solved(load_scene(file))
    ending = f"wirefe: {path.outcome}, {len(path.times)} of 4 steps"
    for options, done in (["--movie", str(movie)], "written"), ([], "shown"):
        assert main(["view", str(file), *options]) == 3
        said = capsys.readouterr()
        assert said.out.splitlines() == [ending, *([f"written to {movie}"] if options else [])]
        assert said.err == f"coilcheck: wirefe: {path.message}; what was reached is {done}\n"
    assert pictures(movie) == 1 + len(path.times)
    file.write_text(scene_text(scene.with_steps(1)))
    assert main(["view", str(file)]) == 3
    assert capsys.readouterr().err.startswith("coilcheck: spring-b has no step to show: ")


@pytest.mark.slow
def test_a_picture_is_rendered_once(run, monkeypatch):
    """Parts that render themselves took four times as long; counted where VTK may end the process."""
    code = """
import sys, pyvista
from pathlib import Path
from validation.view import pictures
counted, render = [], pyvista.Plotter.render
pyvista.Plotter.render = lambda self: counted.append(1) or render(self)
pictures.main(Path(sys.argv[1]), sys.argv[2])
(Path(sys.argv[1]) / "renders").write_text(str(len(counted)))
"""
    found = frames.of_run(run)
    monkeypatch.setattr(process, "COMMAND", (sys.executable, "-c", code))
    with Drawing("pictures") as drawing:
        drawing.give(found)
        files = [drawing.folder / f"{step:04d}.png" for step in range(len(found.times))]
        counts = []
        assert drawing.failure(60.0, files, written=counts.append) == ""
        renders = int((drawing.folder / "renders").read_text())
    assert len(files) <= renders <= len(files) + 4  # the others make it ready
    assert counts[-1] == len(files)


def test_a_movie_tells_how_far_it_is(run, tmp_path):
    said = []
    assert animation.film(lambda: frames.of_run(run), tmp_path / "b.gif", said.append) == ""
    assert (said[0], said[-2:]) == (
        "drawing: 0 of 4 pictures",
        ["drawing: 4 of 4 pictures", "writing the movie"],
    )
    told = []
    frames.solved(spring_b().with_steps(1), told.append)
    assert told == ["loading wirefe", "solving with wirefe"]


@pytest.mark.parametrize("code", ["raise SystemExit(3)", "pass"])
def test_matplotlib_draws_where_pyvista_cannot(code, run, tmp_path, monkeypatch, capsys):
    """The child fails, or ends well without pictures."""
    monkeypatch.setattr(process, "COMMAND", (sys.executable, "-c", code))
    movie = tmp_path / "b.gif"
    assert main(["view", str(run), "--movie", str(movie)]) == 0
    assert pictures(movie) == 4
    assert "drawn by matplotlib" in capsys.readouterr().out


def test_without_a_display_one_sentence_says_so(run, monkeypatch, capsys):
    monkeypatch.setattr(sys, "platform", "linux")
    monkeypatch.delenv("DISPLAY", raising=False)
    monkeypatch.delenv("WAYLAND_DISPLAY", raising=False)
    assert main(["view", str(run)]) == 2
    assert capsys.readouterr().err == (
        "coilcheck: view needs a display, and there is none: --movie FILE.gif draws without one\n"
    )


def test_a_window_that_does_not_open_is_one_sentence(run, monkeypatch, capsys):
    monkeypatch.setenv("DISPLAY", ":0")
    monkeypatch.setattr(process, "COMMAND", (sys.executable, "-c", "import os; os.abort()"))
    assert main(["view", str(run)]) == 2
    assert capsys.readouterr().err.startswith("coilcheck: no window could be opened (")


@pytest.mark.parametrize("file", ["given.pickle", "0000.png", "a.gif"])
def test_a_movie_for_which_there_is_no_room_is_exit_4(file, run, tmp_path, monkeypatch, capsys):
    """Anything that is written on the way to it, by matplotlib too."""
    from builtins import open as sound

    def no_room(name, mode="r", *more, **others):
        if file in str(name) and "r" not in mode:
            raise OSError(errno.EFBIG, "File too large")
        return sound(name, mode, *more, **others)

    monkeypatch.setattr(process, "COMMAND", (sys.executable, "-c", "import os; os.abort()"))
    monkeypatch.setattr("io.open", no_room)
    monkeypatch.setattr("builtins.open", no_room)
    assert main(["view", str(run), "--movie", str(tmp_path / "a.gif")]) == 4
    where = tmp_path / file if file == "a.gif" else "the folder for temporary files"
    assert capsys.readouterr().err == f"coilcheck: cannot write to {where}: File too large\n"
    assert not list(tmp_path.iterdir())


def test_what_cannot_be_shown_is_refused(run, tmp_path, capsys):
    assert main(["view", str(tmp_path), "--movie", str(tmp_path / "a.gif")]) == 2
    assert "holds no wire.pvd" in capsys.readouterr().err
    assert main(["view", str(run), "--movie", str(tmp_path / "a.mp4")]) == 2
    assert "--movie must be the name of a .gif file" in capsys.readouterr().err
    (tmp_path / "wire.pvd").write_text("<VTKFile>", encoding="utf-8")
    assert main(["view", str(tmp_path), "--movie", str(tmp_path / "a.gif")]) == 2
    assert "is not a whole run" in capsys.readouterr().err
    damaged = tmp_path / "damaged"
    shutil.copytree(run, damaged)
    first = next(iter(sorted(damaged.glob("**/*.vtu"))))
    for content in (b"", b"x", first.read_bytes()[:2000]):
        first.write_bytes(content)
        assert main(["view", str(damaged), "--movie", str(tmp_path / "a.gif")]) == 2
        assert "is not a whole run" in capsys.readouterr().err
