"""How each table and figure of the paper is made, and the report on them."""

from __future__ import annotations

import io
from collections.abc import Callable
from contextlib import ExitStack
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path
from types import ModuleType
from typing import TYPE_CHECKING

import pandas as pd

from validation.reproduce import claims, curves, evidence, facts, report, tables, times
from validation.reproduce.assembly import PAGE
from validation.study import frames
from validation.study.cases import PathStore
from validation.study.document import Table
from validation.study.output import FACTS, json_bytes, write_files
from validation.study.provenance import FILE, provenance
from validation.view import htmlscene, render3d, shapes

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from validation.view.render3d import Rendering
    from validation.view.shapes import Shapes

Files = dict[str, bytes]  # by name


@dataclass
class Maker:
    """Makes artifacts, writes their files and keeps them in the store."""

    out: Path  # folder of the results
    paths: PathStore  # of both models; their store keeps the artifacts, too
    render: bool  # whether pictures are made
    cleanup: ExitStack  # ends the rendering processes, whatever happens
    times: bytes = b""  # CSV file of Table 3, for the artifacts that show it
    # by artifact, its key, its other files, and panels and running process of its figure in space
    renderings: dict[str, tuple[str, Files, tuple[Shapes, ...], Rendering]] = field(default_factory=dict)
    notes: list[str] = field(default_factory=list)  # what did not go as planned, one sentence each

    def measure(self) -> bytes:
        """Measure the times of Table 3; its CSV file."""
        return frames.to_csv(times.measure(self.paths))

    def make(self, name: str, key: str) -> Files:
        """Make an artifact; it is kept under its key when all of it is there.

        Figures in space are written later, by `finish`.
        """
        if name in SPRINGS:
            return self._springs(name, key)
        files = MAKERS[name](self)
        if not self.notes:  # which are of this machine today
            self.paths.store.put(key, files)
        return files

    def finish(self) -> None:
        """Wait for the figures in space and write them."""
        for name, (key, files, panels, rendering) in self.renderings.items():
            self.paths.announce(f"rendering {name}")
            rendered = rendering.result()
            figure = partial(_spring_figures().space_figure, panels, rendered)
            picture = self.picture(name, figure, lines=False)
            write_files(picture, self.out)
            if isinstance(rendered, str):
                note = f"{name} was drawn by matplotlib, since pyvista could not render here: {rendered}."
                self.notes.append(note)
                self.paths.announce(note)
            else:
                self.paths.store.put(key, files | picture)
        self.renderings.clear()

    def interactive(self, mark: str) -> str:
        """Write the springs of all figures in space as one scene; in a few words why there is none."""
        self.paths.announce("springs to be turned")
        panels = [shapes.shapes(self.paths, name) for names in SPRINGS.values() for name in names]
        page = htmlscene.page(panels, mark)
        if isinstance(page, str):
            return page
        write_files({htmlscene.FILE: page}, self.out)
        return ""

    def picture(self, name: str, draw: Callable[[], Figure], lines: bool = True) -> Files:
        """A figure in the common style as PNG, one of lines as SVG too; nothing where none are wanted."""
        if not self.render:
            return {}
        import matplotlib

        from validation.study.plots import drawn, png
        from validation.study.style import RC

        with matplotlib.rc_context(RC):
            return drawn(draw(), name) if lines else {f"{name}.png": png(draw())}

    def _springs(self, name: str, key: str) -> Files:
        """Deformed springs; the figure in space is rendered in a process of its own while work goes on."""
        panels = tuple(shapes.shapes(self.paths, scene) for scene in SPRINGS[name])
        rendering = self.cleanup.enter_context(render3d.Rendering(panels)) if self.render else None
        files = _csv(name, shapes.centreline_table(panels))
        files |= _csv(f"{name}-plane", shapes.circle_table(panels))
        files |= self.picture(f"{name}-plane", lambda: _spring_figures().plane_figure(panels))
        if rendering is None:
            self.paths.store.put(key, files)
        else:
            self.renderings[name] = (key, files, panels, rendering)
        return files


def _csv(name: str, table: Table) -> Files:
    """A table as a CSV file."""
    return {f"{name}.csv": frames.to_csv(pd.DataFrame(table.rows, columns=list(table.header)))}


def _curves(name: str, data: Callable[[PathStore], pd.DataFrame], figure: str) -> Callable[[Maker], Files]:
    """Curves: their data, and the figure that shows them."""

    def make(maker: Maker) -> Files:
        found = data(maker.paths)
        picture = maker.picture(name, lambda: getattr(_figures(), figure)(found))
        return {f"{name}.csv": frames.to_csv(found, digits=9)} | picture

    return make


def _figures() -> ModuleType:
    """Drawing is imported only where pictures are made: matplotlib takes most of a second."""
    from validation.reproduce import figures

    return figures


def _spring_figures() -> ModuleType:
    from validation.reproduce import springfigures

    return springfigures


def _report(maker: Maker) -> Files:
    """The reproduction's page; all pictures are there when it is made."""
    found = evidence.gather(maker.paths, frames.read_csv(io.BytesIO(maker.times)))
    known = facts.facts(found)
    sticking = found.cases["spring-b"].wire
    picture = maker.picture("sliding", lambda: _figures().sliding_figure(sticking, found.frictionless))
    maker.finish()
    page = report.compose(found, known, maker.paths, maker.render, maker.notes)
    return {
        **picture,
        **_csv("claims", claims.claim_table(known)),
        "phases.csv": frames.to_csv(found.phases),
        PAGE: page.encode(),
        FILE: provenance("coilcheck reproduce"),
        FACTS: json_bytes(known),
    }


SPRINGS = {"fig4": ("spring-a-no-contact", "spring-a"), "fig6": ("spring-b-no-contact", "spring-b")}
MAKERS: dict[str, Callable[[Maker], Files]] = {
    "table1": lambda maker: _csv("table1", tables.table1()),
    "table2": lambda maker: _csv("table2", tables.table2()),
    "table3": lambda maker: {"table3.csv": maker.times},
    "fig5": _curves("fig5", curves.tip_curves, "tip_figure"),
    "fig7": _curves("fig7", curves.load_deflection, "load_figure"),
    "fig8": _curves("fig8", curves.iteration_counts, "iteration_figure"),
    "report": _report,
}
