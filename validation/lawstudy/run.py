"""``coilcheck study-law``: all parts of the study of a law, its page, CSV file and figure."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

import equivbeam
from coilspring import spring_a
from equivbeam.laws import law_of
from equivbeam.laws.userlaw import UserLaw
from validation.campaign.run import verified
from validation.campaign.scenes import case_id
from validation.lawstudy import checks, page, place, springs
from validation.lawstudy.jobs import Job, gathered, kept
from validation.study.cases import PathStore
from validation.study.frames import to_csv
from validation.study.keys import key, sources
from validation.study.machine import versions
from validation.study.output import prepare, write_files
from validation.study.partialsolve import partial_path
from validation.study.provenance import write_provenance
from validation.study.store import Store, default_folder
from validation.verification.randomscenes import KINDS

SAMPLED, CHUNK, SEED = 2000, 20, 1  # scenes of the stability sample, those of a piece of work, their seed
COLUMNS = ("id", "class", "outcome", "reason", "corner", "by")  # of a sampled scene
QUICK = springs.Extent((0,), 4), 160
FILE = "law.csv"
Progress = Callable[[str], None]


def study_law(
    file: str | Path, out: Path, progress: Progress = lambda line: None, *, quick: bool = False
) -> list[str]:
    """Study the law in a file and write ``law.md``, ``law.csv`` and ``law.png`` to a folder.

    What is solved is kept in the store under the content of the file: a study that was interrupted goes on.

    Parameters
    ----------
    file : the law, as `equivbeam.solve` takes it.
    out : folder of the results.
    progress : called with one line on what is being done.
    quick : fewer springs and scenes, about a minute.

    Returns
    -------
    The page's summary, a sentence each.

    Raises
    ------
    InputError : no law, or one that cannot be that of a spring at rest.
    """
    law = law_of(Path(file))
    assert isinstance(law, UserLaw)
    progress("compiling the law")
    partial_path(equivbeam.solve, spring_a(), law=law, steps=1)
    prepare(out)
    store = Store(default_folder())
    extent, count = QUICK if quick else (springs.Extent(), SAMPLED)
    paths = PathStore(progress, store)
    paths.make_ready()
    progress("derivatives and limits")
    parts: dict[str, list[dict[str, Any]]] = {
        "derivatives": checks.derivatives(law),
        "limits": checks.limits(law),
        "half coil": checks.holds(law),
        "cases": place.budget(law, paths),
        "place": _place(law, paths, store, progress),
        "springs": _springs(law, store, extent, progress),
        "stability": _stability(law, store, count, progress),
    }
    progress("drawing")
    data = {name: pd.DataFrame(rows) for name, rows in parts.items()}
    data["springs"] = springs.frame(parts["springs"])
    files, summary = page.files(law, data)
    write_files({FILE: to_csv(table(data), digits=5)} | files, out)
    name = Path(file).as_posix() if not Path(file).is_absolute() else Path(file).name
    write_provenance(f"coilcheck study-law {name}{' --quick' if quick else ''}", out, law=str(law))
    return summary


def table(data: dict[str, pd.DataFrame]) -> pd.DataFrame:
    """All parts as one table, each with its columns; of the sampled scenes those alike are counted."""
    by = [name for name in COLUMNS if name != "id"]
    counted = data["stability"].groupby(by, sort=False).size().rename("scenes").reset_index()
    parts = (part.assign(part=name) for name, part in (data | {"stability": counted}).items())
    found = pd.concat(parts, ignore_index=True)
    return found[["part", *found.columns.drop("part")]]


def _key(kind: str, modules: tuple[str, ...], **given: object) -> str:
    """Key of a piece of work: the models, these modules, versions, and what it was given."""
    used = sources("coilspring", "equivbeam", *modules)
    return key(f"law study, {kind}", sources=used, versions=versions(), **given)


def _place(law: UserLaw, paths: PathStore, store: Store, progress: Progress) -> list[dict[str, Any]]:
    errors = place.errors(law, paths)
    progress("timing")
    modules = ("wirefe", "validation.lawstudy.place", "validation.study.timing")
    seconds = kept(store, _key("times", modules, law=law), Job(place.times, (law,)))
    both = pd.DataFrame(errors).merge(pd.DataFrame(seconds), on=["scene", "series"])
    return both.to_dict("records")


def _springs(law: UserLaw, store: Store, extent: springs.Extent, progress: Progress) -> list[dict[str, Any]]:
    names = ("randomscenes", "randomsprings")
    modules = (
        "wirefe",
        "validation.lawstudy.springs",
        *(f"validation.verification.{name}" for name in names),
    )
    pieces = [(seed, kind.name, extent.each) for seed in extent.seeds for kind in KINDS]
    wires = gathered(
        store,
        {_key("wire", modules, piece=piece): Job(springs.wire_curves, piece) for piece in pieces},
        lambda done, of: progress(f"random springs by the wire model, part {done} of {of}"),
    )
    jobs = {
        _key("springs", modules, piece=piece, law=law): Job(springs.law_errors, (law, rows, extent.each))
        for piece, rows in zip(pieces, wires, strict=True)
    }
    found = gathered(store, jobs, lambda done, of: progress(f"random springs, part {done} of {of}"))
    return [row for rows in found for row in rows]


def _stability(law: UserLaw, store: Store, count: int, progress: Progress) -> list[dict[str, Any]]:
    starts = np.arange(0, count, CHUNK).tolist()
    jobs = {
        _key("stability", ("validation.campaign",), law=law, seed=SEED, start=start): Job(
            sampled, (law, start, min(CHUNK, count - start))
        )
        for start in starts
    }
    found = gathered(
        store, jobs, lambda done, of: progress(f"stability, {done * CHUNK} of {of * CHUNK} scenes")
    )
    return [row for rows in found for row in rows]


def sampled(law: UserLaw, start: int, count: int) -> list[dict[str, str]]:
    """Verified scenes of the stability campaign's sequence with the law."""
    with np.errstate(all="ignore"):  # bold trial states of the verifier
        rows = [verified(case_id("b", number), SEED, law) for number in range(start, start + count)]
    return [{name: row[name] for name in COLUMNS} for row in rows]
