"""``coilcheck study-law``: all parts of the study of a law, its page, CSV file and figure.

Work comes in pieces: each is done once, in parallel with others, and kept in the store under its key.
"""

import json
import os
from collections.abc import Callable, Mapping
from concurrent.futures import as_completed
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

import equivbeam
from coilspring import InputError, spring_a
from coilspring.workers import processes
from equivbeam.laws import law_of
from equivbeam.laws.userlaw import UserLaw
from validation.campaign.run import verified
from validation.campaign.scenes import case_id
from validation.lawstudy import checks, page, springs
from validation.study.files import prepare, write_files
from validation.study.frames import to_csv
from validation.study.keys import key, sources
from validation.study.machine import timed_on, versions
from validation.study.partialsolve import partial_path
from validation.study.paths import PathStore
from validation.study.provenance import write_provenance
from validation.study.store import Store, default_folder
from validation.verification.randomscenes import KINDS

SAMPLED, CHUNK, SEED = 2000, 20, 1  # scenes of the stability sample, those of a piece of work, their seed
COLUMNS = ("id", "class", "outcome", "reason", "corner", "by")  # of a sampled scene
QUICK = springs.Extent((0,), 4), 160
FILE, RESULT = "law.csv", "result.json"  # of the study; of an entry of the store
Progress = Callable[[str], None]
Rows = list[dict[str, Any]]


def study_law(
    law: UserLaw, out: Path, progress: Progress = lambda line: None, *, quick: bool = False
) -> list[str]:
    """Write ``law.md``, ``law.csv`` and ``law.png`` of a `tried` law to a folder; the page's summary.

    What is solved is kept in the store under the content of the file: a study that was interrupted goes on.
    `quick`: fewer springs and scenes, up to three minutes.
    """
    if law.source is None:
        raise InputError(f"law {law.name} must come from a file: its content is part of every key")
    prepare(out)
    store = Store(default_folder())
    with store.kept_if_interrupted():
        parts = _parts(law, store, progress, quick)
        progress("drawing")
        data = {name: pd.DataFrame(rows) for name, rows in parts.items()}
        data["springs"] = springs.frame(parts["springs"])
        files, summary = page.files(law, data)
        write_files({FILE: to_csv(table(data), digits=5)} | files, out)
        file = Path(law.source[0])
        name = file.name if file.is_absolute() else file.as_posix()
        write_provenance(f"coilcheck study-law {name}{' --quick' if quick else ''}", out, law=str(law))
    return summary


def _parts(law: UserLaw, store: Store, progress: Progress, quick: bool) -> dict[str, Rows]:
    """Rows of all parts of a study."""
    extent, count = QUICK if quick else (springs.Extent(), SAMPLED)
    paths = PathStore(progress, store)
    paths.make_ready()
    progress("derivatives and limits")
    return {
        "derivatives": checks.derivatives(law),
        "limits": checks.limits(law),
        "half coil": checks.holds(law),
        "cases": springs.budget(law, paths),
        "place": _place(law, paths, store, progress),
        "springs": _springs(law, store, extent, progress),
        "stability": _stability(law, store, count, progress),
    }


def tried(file: str | Path) -> UserLaw:
    """The law in a file, compiled; `InputError` where it holds none, or none of a spring at rest."""
    law = law_of(Path(file))
    assert isinstance(law, UserLaw)
    partial_path(equivbeam.solve, spring_a(), law=law, steps=1)
    return law


def table(data: dict[str, pd.DataFrame]) -> pd.DataFrame:
    """All parts as one table, each with its columns; of the sampled scenes those alike are counted."""
    by = [name for name in COLUMNS if name != "id"]
    counted = data["stability"].groupby(by, sort=False).size().rename("scenes").reset_index()
    parts = (part.assign(part=name) for name, part in (data | {"stability": counted}).items())
    found = pd.concat(parts, ignore_index=True)
    return found[["part", *found.columns.drop("part")]]


def gathered(store: Store, jobs: Mapping[str, partial], progress: Callable[[int, int], None]) -> list[Any]:
    """Results of jobs by key, in their order; those that are not stored are done by all processor cores."""
    files = {key: store.get(key) for key in jobs}
    missing = [key for key, entry in files.items() if entry is None]
    if missing:
        with processes(os.cpu_count() or 1) as pool:
            waiting = {pool.submit(jobs[key]): key for key in missing}
            for done, future in enumerate(as_completed(waiting), len(jobs) - len(missing) + 1):
                entry = files[waiting[future]] = {RESULT: json.dumps(future.result()).encode()}
                store.put(waiting[future], entry)
                progress(done, len(jobs))
    return [json.loads(entry[RESULT]) for entry in files.values() if entry]


def _key(kind: str, *modules: str, **given: object) -> str:
    """Key of a piece of work: the models, these modules, versions, and what it was given."""
    used = sources("coilspring", "equivbeam", *modules)
    return key(f"law study, {kind}", sources=used, versions=versions(), **given)


def _place(law: UserLaw, paths: PathStore, store: Store, progress: Progress) -> Rows:
    errors = springs.errors(law, paths)
    progress("timing")
    measuring = (
        "lawstudy.springs",
        *(f"study.{name}" for name in ("timing", "cases", "paths", "partialsolve")),
    )
    modules = (f"validation.{name}" for name in measuring)
    times = _key("times", "wirefe", *modules, law=law, machine=timed_on())
    (seconds,) = gathered(store, {times: partial(springs.times, law)}, lambda done, of: None)
    both = pd.DataFrame(errors).merge(pd.DataFrame(seconds), on=["scene", "series"])
    return both.to_dict("records")


def _springs(law: UserLaw, store: Store, extent: springs.Extent, progress: Progress) -> Rows:
    names = ("lawstudy.springs", "verification.randomscenes", "verification.randomsprings")
    modules = ("wirefe", *(f"validation.{name}" for name in names))
    pieces = [(seed, kind.name, extent.each) for seed in extent.seeds for kind in KINDS]
    jobs = {_key("wire", *modules, piece=piece): partial(springs.wire_curves, *piece) for piece in pieces}
    by = "random springs by the wire model, part {} of {}".format
    wires = gathered(store, jobs, lambda *counts: progress(by(*counts)))
    jobs = {
        _key("springs", *modules, piece=piece, law=law): partial(springs.law_errors, law, rows, extent.each)
        for piece, rows in zip(pieces, wires, strict=True)
    }
    found = gathered(store, jobs, lambda *counts: progress("random springs, part {} of {}".format(*counts)))
    return [row for rows in found for row in rows]


def _stability(law: UserLaw, store: Store, count: int, progress: Progress) -> Rows:
    jobs = {
        _key("stability", "validation.campaign", law=law, seed=SEED, start=start): partial(
            sampled, law, start, min(CHUNK, count - start)
        )
        for start in range(0, count, CHUNK)
    }
    said = "stability, {} of {} scenes".format
    found = gathered(store, jobs, lambda done, of: progress(said(done * CHUNK, of * CHUNK)))
    return [row for rows in found for row in rows]


def sampled(law: UserLaw, start: int, count: int) -> list[dict[str, str]]:
    """Verified scenes of the stability campaign's sequence with the law."""
    with np.errstate(all="ignore"):  # bold trial states of the verifier
        rows = [verified(case_id("b", number), SEED, law) for number in range(start, start + count)]
    return [{name: row[name] for name in COLUMNS} for row in rows]
