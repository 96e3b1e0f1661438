"""The campaign: cases in parallel, a row each, kept as they come and not computed twice."""

import os
import traceback
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import as_completed
from dataclasses import replace
from functools import partial
from pathlib import Path
from time import process_time

import pandas as pd

from coilspring import EquilibriumPath, InputError
from coilspring.words import counted
from coilspring.workers import processes
from equivbeam.laws.userlaw import UserLaw
from validation.campaign import table, wireverifier
from validation.campaign.beamverifier import verify_critical, verify_states
from validation.campaign.energy import BeamEnergy
from validation.campaign.overlap import verify_overlap
from validation.campaign.page import write_page
from validation.campaign.runs import verified_rows, verify_invariance, verify_steps
from validation.campaign.scenes import Case, case_id, make_case
from validation.campaign.table import COLUMNS, Key, row_of, version
from validation.campaign.verdict import CRITICAL, REFUSED, VERIFIED, Verdict, reached
from validation.campaign.wire import WireForces
from validation.campaign.wirejump import verify_jump
from validation.study.files import prepare
from validation.study.provenance import write_provenance
from validation.study.rows import Row, append, kept_if_interrupted

CHUNK = {"b": 8, "w": 1}  # cases handed to a worker at a time


def campaign(
    out: Path,
    *,
    beams: int = 20_000,
    wires: int = 1_000,
    seeds: Sequence[int] = (1,),
    workers: int | None = None,
    progress: Callable[[int, int], None] = lambda done, of: None,
) -> pd.DataFrame:
    """Verify the first `beams` and `wires` scenes of each seed, and write what became of them.

    ``stability.csv`` takes a row for each case as it is verified; a campaign that was interrupted goes on
    from there. ``stability.md`` and its pictures are written at the end.

    Parameters
    ----------
    out : folder of the results.
    beams, wires : number of scenes of a seed for the equivalent beam and for the wire model.
    seeds : of the sequences that the scenes are drawn from.
    workers : processes; by default one for each processor core. 0: in this process.
    progress : called with the number of cases verified so far and the number of all.

    Returns
    -------
    pandas.DataFrame
        The rows of the scenes, texts, in the order of seeds and ids.
    """
    prepare(out)
    file = out / "stability.csv"
    names = [case_id("b", i) for i in range(beams)] + [case_id("w", i) for i in range(wires)]
    wanted = [(seed, name) for seed in seeds for name in names]
    done = table.kept(file, seeds, version()) & set(wanted)
    missing = [key for key in wanted if key not in done]
    with kept_if_interrupted(file, done, len(wanted)):
        for rows in _results(missing, os.cpu_count() or 1 if workers is None else workers):
            append(rows, file, COLUMNS)
            done |= set(map(table.key_of, rows))
            progress(len(done), len(wanted))
        chosen = table.sort(file, wanted)
        write_page(chosen, out)
    options = f"--beams {beams} --wires {wires} --seeds {','.join(map(str, seeds))}"
    write_provenance(f"coilcheck stability {options}", out)
    return chosen


def digest(data: pd.DataFrame) -> list[str]:
    """How many scenes have which class, for a reader at the terminal."""
    counts = (f"{count} {name}" for name, count in data["class"].value_counts().items())
    return [f"{counted(len(data), 'scene')}: {', '.join(counts)}"]


def verified(name: str, seed: int, law: UserLaw | None = None) -> Row:
    """Solve and verify one case; `law`: with a user's law in place of that drawn."""
    began = process_time()
    case, path, verdict, known = make_case(name, seed), None, Verdict(), {"outcome": REFUSED}
    if law is not None:
        case = replace(case, options={"law": law})
    try:
        path = reached(case)
        verdict = verify(case, path)
        known = {"kind": verify_invariance(verdict, case, path)}
        verify_others(verdict, case)
    except InputError as error:
        known = {"message": str(error)}
        if path is not None:
            verdict.complain(f"refused while verified: {error}")
    except Exception as error:  # a crash is an outcome, the worst one; the campaign goes on
        last = traceback.extract_tb(error.__traceback__)[-1]
        verdict.complain(f"crash: {error!r} in {Path(last.filename).name}:{last.lineno}")
    known["outcome"] = path.outcome if path else REFUSED
    known |= {"class": verdict.class_of(known["outcome"]), "seconds": f"{process_time() - began:.3f}"}
    return row_of(case, path, verdict, seed=seed, **known)


def verify(case: Case, path: EquilibriumPath) -> Verdict:
    """Verify a path of a case, complete or not, by equations of its own, other runs, and overlaps."""
    verdict = Verdict()
    if not verdict.stop("path", path) and path.outcome not in VERIFIED:
        verdict.complain(f"{path.outcome}: {path.message}")
        return verdict
    if case.model == "equivbeam":
        energy = BeamEnergy(case.scene, case.options["law"])
        critical = partial(verify_critical, verdict, energy)
        verify_states(verdict, energy, path)
    else:
        forces = WireForces(case.scene, **case.options)
        critical = partial(wireverifier.verify_wire_critical, verdict, forces)
        for row in sorted(verified_rows(path)):
            wireverifier.verify_row(verdict, forces, path, row)
    verify_overlap(verdict, path)
    verify_steps(verdict, case, path)
    if path.outcome in CRITICAL:
        critical(case, path)
    elif path.outcome == "jump":
        verify_jump(verdict, forces, case, path)
    return verdict


def verify_others(verdict: Verdict, case: Case) -> None:
    """Runs that differ where coils can hold other forces must be stable equilibria as well."""
    for other in verdict.others:
        forces = WireForces(other.scene, **case.options)
        for row in sorted(verified_rows(other)):
            wireverifier.verify_row(verdict, forces, other, row)


def _results(keys: list[Key], workers: int) -> Iterator[list[Row]]:
    """Rows of the cases, in chunks as they come."""
    chunks = []
    for letter, size in CHUNK.items():
        some = [key for key in keys if key[1][0] == letter]
        chunks += [some[i : i + size] for i in range(0, len(some), size)]
    if not keys or workers == 0:
        yield from map(_verified_all, chunks)
        return
    with processes(workers) as pool:
        for future in as_completed([pool.submit(_verified_all, chunk) for chunk in chunks]):
            yield future.result()


def _verified_all(keys: list[Key]) -> list[Row]:
    return [verified(name, seed) for seed, name in keys]
