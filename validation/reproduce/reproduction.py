"""The paper's Tables 1-3 and Figures 4-8 by both models, and the report on them.

An artifact that was made before from the same sources, by the same versions, is taken from the store; models
and drawing are loaded for the others alone.
"""

from __future__ import annotations

import csv
import re
from collections.abc import Callable
from contextlib import ExitStack
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING

from coilspring import InputError
from coilspring.errors import require_names
from validation.reproduce import ARTEFACTS
from validation.reproduce.assembly import PAGE, assemble
from validation.study.files import prepare, write_files, writing
from validation.study.keys import key, sources
from validation.study.machine import timed_on, versions
from validation.study.provenance import PACKAGES
from validation.study.store import Store, default_folder
from validation.view.htmlscene import FILE, is_made, require_extra

if TYPE_CHECKING:
    from validation.reproduce.artifacts import Maker

REPORT, TURNED = "report", "turned"
TIMED = ("table3", REPORT)  # artifacts that show solution times
TABLE3 = "table3.csv"
DRAWING = ("matplotlib", "pillow", "pyvista", "vtk")


def reproduce(
    out: Path,
    only: tuple[str, ...] | None = None,
    render: bool = True,
    progress: Callable[[str], None] = lambda line: None,
    time: bool = False,
    turned: bool = False,
) -> tuple[str, ...]:
    """Write the paper's tables and figures to `out`; with all of them the report.

    Returned are sentences on where the results come from. Every artifact is written when it is finished.

    Parameters
    ----------
    only : names of `ARTEFACTS` that are wanted; None for all and the report.
    render : False makes no pictures: CSV files, and the report without figures.
    time : measure the solution times of Table 3 even where some are stored.
    turned : write the springs as a scene that can be turned in a browser, too.

    Raises
    ------
    InputError : an unknown name in `only`, `time` without Table 3, or `turned` without its extra.
    EquilibriumNotFound : one of the four cases could not be solved to full load.
    """
    names = ARTEFACTS if only is None else only
    require_names("only", names, ARTEFACTS)
    if time and "table3" not in names:
        raise InputError(f"time goes with table3, got only {', '.join(names)}")
    if turned:
        require_extra()
    out = Path(out)
    prepare(out)
    store = Store(default_folder())
    with store.kept_if_interrupted(), ExitStack() as cleanup:
        run = _Run(out, store, render, progress, time, cleanup)
        if turned:
            run.turn()
        for name in (*names, REPORT) if only is None else names:
            progress(name)
            run.provide(name)
        run.finish()
    said = [*run.remarks, *([store.trouble] if store.trouble else [])]
    if only is None:
        with writing(out):
            verdict = re.search(r"\*\*(.+?)\*\*", (out / PAGE).read_text(encoding="utf-8"))
        said.append(f"{verdict[1] if verdict else 'Done.'} Open {out / 'report.html'}.")
    return tuple(said)


@dataclass
class _Run:
    """One call of `reproduce`; its arguments, the store and what the reader should know."""

    out: Path
    store: Store
    render: bool
    progress: Callable[[str], None]
    time: bool
    cleanup: ExitStack
    remarks: list[str] = field(default_factory=list)

    @cached_property
    def maker(self) -> Maker:
        """What makes artifacts, loaded with both models for the first that is missing."""
        self.progress("loading both models")
        from validation.reproduce.artifacts import Maker
        from validation.study.paths import PathStore

        return Maker(self.out, PathStore(self.progress, self.store), self.render, self.cleanup)

    def provide(self, name: str) -> None:
        """Write an artifact, as it was made before or made now; and the report with the other studies."""
        mark = self._key(name)
        files = self.store.get(mark)
        if files is None:
            files = self.maker.make(name, mark, self.times if name in TIMED else b"")
        page = files.pop(PAGE, None)
        write_files(files, self.out)
        if page is not None:
            self.finish()
            scene = FILE if is_made(self.out, self._key(TURNED)) else None
            html = assemble(page.decode(), self.out, scene)
            write_files({PAGE: page, "report.html": html}, self.out)

    def turn(self) -> None:
        """Write the springs as a scene, unless the one there was made from the same."""
        mark = self._key(TURNED)
        trouble = "" if is_made(self.out, mark) else self.maker.interactive(mark)
        if trouble:
            self.remarks.append(f"no {FILE}: pyvista could not export the springs here ({trouble})")

    def finish(self) -> None:
        """Wait for the figures that are still being made."""
        if "maker" in vars(self):
            self.maker.finish()

    def _key(self, name: str) -> str:
        return key(
            "artifact",
            name=name,
            render=self.render,
            times=self.times.decode() if name in TIMED else None,
            sources=sources(*PACKAGES, "validation"),
            versions=versions(*DRAWING),
        )

    @cached_property
    def times(self) -> bytes:
        """Table 3 as CSV: stored times of these sources and this processor, or measured now."""
        measuring = ("reproduce.times", "study.timing", "study.cases", "study.paths")
        name = key(
            "times",
            sources=sources(*PACKAGES, *(f"validation.{module}" for module in measuring)),
            versions=versions(),
            machine=timed_on(),
        )
        files = None if self.time else self.store.get(name)
        if files is None:
            files = {TABLE3: self.maker.measure()}
            self.store.put(name, files)
        else:
            row = next(csv.DictReader(files[TABLE3].decode().splitlines()))
            origin = f"measured on {row['measured']} on {row['processor']}"
            self.remarks.append(f"solution times: {origin}; --time measures them again")
        return files[TABLE3]
