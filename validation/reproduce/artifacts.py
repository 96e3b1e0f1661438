"""How each table and figure of the paper is made, and the report on them."""

from __future__ import annotations

import io
from collections.abc import Callable
from contextlib import ExitStack
from dataclasses import dataclass, field
from pathlib import Path
from types import ModuleType
from typing import TYPE_CHECKING

import pandas as pd

from validation.reproduce import claims, facts, phases, report, times
from validation.reproduce.assembly import PAGE
from validation.reproduce.curves import both_models, iteration_counts
from validation.study import frames
from validation.study.files import FACTS, json_bytes, write_files
from validation.study.paths import PathStore
from validation.study.provenance import FILE, provenance
from validation.view import htmlscene, shapes
from validation.view.process import Drawing

if TYPE_CHECKING:
    from matplotlib.figure import Figure

Files = dict[str, bytes]  # by name
RENDERING = 60.0  # s at most; a picture takes about one


@dataclass
class Maker:
    """Makes artifacts, writes their files and keeps them in the store."""

    out: Path  # folder of the results
    paths: PathStore  # of both models; their store keeps the artifacts, too
    render: bool  # whether pictures are made
    cleanup: ExitStack  # ends the rendering processes, whatever happens
    pending: list[Callable[[], None]] = field(default_factory=list)  # write figures that are being rendered
    warnings: list[str] = field(default_factory=list)  # what did not go as planned, one sentence each

    def measure(self) -> bytes:
        """Measure the times of Table 3; its CSV file."""
        return frames.to_csv(times.measure(self.paths))

    def make(self, name: str, key: str, table3: bytes) -> Files:
        """Make an artifact; it is kept under its key when all of it is there.

        `table3`: its CSV file, for artifacts that show it. Figures in space are written later, by `finish`.
        """
        if name in SPRINGS:
            return self._springs(name, key)
        files = MAKERS[name](self, table3)
        if not self.warnings:  # which are of this machine today
            self.paths.store.put(key, files)
        return files

    def finish(self) -> None:
        """Wait for the figures in space and write them."""
        while self.pending:
            self.pending.pop(0)()

    def interactive(self, mark: str) -> str:
        """Write the springs of all figures in space as one scene; in a few words why there is none."""
        self.paths.announce("springs to be turned")
        panels = [shapes.shapes(self.paths, name) for names in SPRINGS.values() for name in names]
        page = htmlscene.page(panels, mark)
        if isinstance(page, str):
            return page
        write_files({htmlscene.FILE: page}, self.out)
        return ""

    def picture(self, name: str, draw: Callable[[ModuleType], Figure], lines: bool = True) -> Files:
        """A figure in the common style as PNG, one of lines as SVG too; nothing where none are wanted.

        Drawing is imported here alone: matplotlib takes most of a second.
        """
        if not self.render:
            return {}
        from validation.reproduce import figures
        from validation.study.plots import drawn, png, styled

        with styled():
            figure = draw(figures)
            return drawn(figure, name) if lines else {f"{name}.png": png(figure)}

    def curves(self, name: str, data: pd.DataFrame) -> Files:
        """Curves as CSV, and the figure that shows them."""
        picture = self.picture(name, lambda figures: figures.CURVES[name](data))
        return {f"{name}.csv": frames.to_csv(data, digits=9)} | picture

    def _springs(self, name: str, key: str) -> Files:
        """Deformed springs; the figure in space is rendered in a process of its own while work goes on."""
        panels = tuple(shapes.shapes(self.paths, scene) for scene in SPRINGS[name])
        rendering = self.cleanup.enter_context(Drawing("panels").give(panels)) if self.render else None
        files = {f"{name}.csv": shapes.centreline_table(panels).csv()}
        files |= {f"{name}-plane.csv": shapes.circle_table(panels).csv()}
        files |= self.picture(f"{name}-plane", lambda figures: figures.plane_figure(panels))
        if rendering is None:
            self.paths.store.put(key, files)
            return files
        pictures = [rendering.folder / f"panel{i}.png" for i in range(len(panels))]

        def finish() -> None:
            self.paths.announce(f"rendering {name}")
            found = rendering.failure(RENDERING, pictures, "it wrote no picture") or pictures
            picture = self.picture(name, lambda figures: figures.space_figure(panels, found), lines=False)
            write_files(picture, self.out)
            if isinstance(found, str):
                warning = f"{name} was drawn by matplotlib, since pyvista could not render here: {found}."
                self.warnings.append(warning)
                self.paths.announce(warning)
            else:
                self.paths.store.put(key, files | picture)

        self.pending.append(finish)
        return files


def _report(maker: Maker, table3: bytes) -> Files:
    """The reproduction's page; all pictures are there when it is made."""
    paths, seconds = maker.paths, frames.read_csv(io.BytesIO(table3))
    turned = phases.over_phases(paths)
    known = facts.facts(paths, seconds, turned)
    lines = paths.wire(facts.B), paths.partial_wire(facts.frictionless(facts.B))
    picture = maker.picture("sliding", lambda figures: figures.sliding_figure(*lines))
    maker.finish()
    return {
        **picture,
        "claims.csv": claims.claim_table(known).csv(),
        "phases.csv": frames.to_csv(turned),
        PAGE: report.compose(known, paths, seconds, turned, maker.render, maker.warnings).encode(),
        FILE: provenance("coilcheck reproduce"),
        FACTS: json_bytes(known),
    }


SPRINGS = {"fig4": ("spring-a-no-contact", "spring-a"), "fig6": ("spring-b-no-contact", "spring-b")}
MAKERS: dict[str, Callable[[Maker, bytes], Files]] = {
    "table1": lambda *_: {"table1.csv": report.table1().csv()},
    "table2": lambda *_: {"table2.csv": report.table2().csv()},
    "table3": lambda _, table3: {"table3.csv": table3},
    "fig5": lambda maker, _: maker.curves("fig5", both_models(maker.paths, "spring-a", frames.TIPS)),
    "fig7": lambda maker, _: maker.curves("fig7", both_models(maker.paths, "spring-b", frames.TIPS[1:2])),
    "fig8": lambda maker, _: maker.curves("fig8", iteration_counts(maker.paths)),
    "report": _report,
}
