"""The paper's Tables 1-3 and Figures 4-8 by both models, and the report on them."""

from __future__ import annotations

import csv
import io
from collections.abc import Callable
from contextlib import ExitStack
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path
from types import ModuleType
from typing import TYPE_CHECKING

from coilspring import InputError
from validation import tables
from validation.cases import PathStore, case
from validation.document import Table, to_html, to_markdown
from validation.output import prepare, write_text
from validation.timing import Timing, measure
from validation.warmup import warm_up

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from validation.render3d import Rendering
    from validation.shapes import Shapes


@dataclass
class Run:
    """One call of `reproduce`.

    Attributes
    ----------
    out : folder of the results.
    store : paths solved so far.
    render : whether pictures are made.
    cleanup : ends the rendering processes, whatever happens.
    timings : of Table 3, once measured.
    renderings : panels and running processes of the figures in space.
    pictures : names of the pictures written.
    notes : what did not go as planned, one sentence each.
    """

    out: Path
    store: PathStore
    render: bool
    cleanup: ExitStack
    timings: tuple[Timing, ...] = ()
    renderings: dict[str, tuple[tuple[Shapes, ...], Rendering]] = field(default_factory=dict)
    pictures: list[str] = field(default_factory=list)
    notes: list[str] = field(default_factory=list)

    def write_table(self, name: str, table: Table) -> None:
        """Write a table as CSV."""
        text = io.StringIO()
        csv.writer(text, lineterminator="\n").writerows((table.header, *table.rows))
        write_text(self.out / f"{name}.csv", text.getvalue())

    def write_figure(self, name: str, draw: Callable[[], Figure]) -> None:
        """Draw a figure in the common style and write it; nothing where pictures are not wanted."""
        if not self.render:
            return
        import matplotlib

        from validation.figures import save
        from validation.style import RC

        with matplotlib.rc_context(RC):
            save(draw(), self.out / f"{name}.png")
        self.pictures.append(name)

    def render_later(self, name: str, panels: tuple[Shapes, ...]) -> None:
        """Start rendering a figure in space, in a process of its own, while other work goes on."""
        if self.render:
            from validation import render3d

            self.renderings[name] = (panels, self.cleanup.enter_context(render3d.Rendering(panels)))

    def finish_renderings(self) -> None:
        """Wait for the figures in space and write them."""
        for name, (panels, rendering) in self.renderings.items():
            self.store.announce(f"rendering {name}")
            rendered = rendering.result()
            if isinstance(rendered, str):
                note = f"{name} was drawn by matplotlib, since pyvista could not render here: {rendered}."
                self.notes.append(note)
                self.store.announce(note)
            self.write_figure(name, partial(_space_figure, panels, rendered))
        self.renderings.clear()


def reproduce(
    out: Path,
    only: tuple[str, ...] | None = None,
    render: bool = True,
    progress: Callable[[str], None] = lambda line: None,
) -> None:
    """Write the paper's tables and figures to `out`; with all of them the report.

    Parameters
    ----------
    out : folder, made where missing. Every piece is written when it is finished.
    only : names of `ITEMS` that are wanted; None for all and the report.
    render : False makes no pictures: CSV files, and the report without figures.
    progress : called with one line on what is being done.

    Raises
    ------
    InputError : an unknown name in `only`.
    EquilibriumNotFound : one of the four cases could not be solved to full load.
    """
    names = tuple(ITEMS) if only is None else only
    for name in names:
        if name not in ITEMS:
            raise InputError(f"only must hold names of {', '.join(ITEMS)}, got {name!r}")
    out = Path(out)
    prepare(out)
    if not {"table1", "table2"}.issuperset(names):
        progress("making the kernels ready")
        warm_up()
    with ExitStack() as cleanup:
        run = Run(out, PathStore(progress), render, cleanup)
        for name in names:
            progress(name)
            ITEMS[name](run)
        if only is None:
            progress("report")
            _report(run)
        run.finish_renderings()


def _table1(run: Run) -> None:
    run.write_table("table1", tables.table1())


def _table2(run: Run) -> None:
    run.write_table("table2", tables.table2())


def _table3(run: Run) -> None:
    run.timings = measure(run.store)
    run.write_table("table3", tables.table3_data(run.timings))


def _springs(run: Run, name: str, scenes: tuple[str, str]) -> None:
    from validation import shapes

    panels = tuple(shapes.shapes(run.store, scene) for scene in scenes)
    run.write_table(name, shapes.centreline_table(panels))
    run.write_table(f"{name}-plane", shapes.circle_table(panels))
    run.render_later(name, panels)
    run.write_figure(f"{name}-plane", partial(_plane_figure, panels))


def _fig4(run: Run) -> None:
    _springs(run, "fig4", ("spring-a-no-contact", "spring-a"))


def _fig5(run: Run) -> None:
    from validation import curves

    run.write_table("fig5", curves.tip_curves(run.store))
    run.write_figure("fig5", lambda: _figures().tip_figure(run.store))


def _fig6(run: Run) -> None:
    _springs(run, "fig6", ("spring-b-no-contact", "spring-b"))


def _fig7(run: Run) -> None:
    from validation import curves

    run.write_table("fig7", curves.load_deflection(run.store))
    run.write_figure("fig7", lambda: _figures().load_figure(run.store))


def _fig8(run: Run) -> None:
    from validation import curves

    run.write_table("fig8", curves.iteration_counts(run.store))
    run.write_figure("fig8", lambda: _figures().iteration_figure(run.store))


def _figures() -> ModuleType:
    """Drawing is imported only where pictures are made: matplotlib takes most of a second."""
    from validation import figures

    return figures


def _space_figure(panels: tuple[Shapes, ...], rendered: list[Path] | str) -> Figure:
    from validation.springfigures import space_figure

    return space_figure(panels, rendered)


def _plane_figure(panels: tuple[Shapes, ...]) -> Figure:
    from validation.springfigures import plane_figure

    return plane_figure(panels)


def _report(run: Run) -> None:
    from validation import evidence, methods, report

    scene = case("spring-b").scene
    found = evidence.gather(run.store, run.timings)
    assumed = methods.assumption_notes(run.store, found)
    run.write_figure("sliding", lambda: _figures().sliding_figure(run.store.wire(scene), found.frictionless))
    run.finish_renderings()
    claims = report.judge(found)
    blocks = report.compose(found, claims, assumed, run.pictures, run.notes)
    run.write_table("claims", report.claim_table(claims))
    write_text(run.out / "report.md", to_markdown(blocks))
    write_text(run.out / "report.html", to_html(blocks, run.out, report.TITLE))


ITEMS: dict[str, Callable[[Run], None]] = {
    "table1": _table1,
    "table2": _table2,
    "table3": _table3,
    "fig4": _fig4,
    "fig5": _fig5,
    "fig6": _fig6,
    "fig7": _fig7,
    "fig8": _fig8,
}
