"""Work in pieces: each is done once, in parallel with others, and kept in the store under its key."""

from __future__ import annotations

import json
import os
from collections.abc import Callable, Mapping
from concurrent.futures import Future, as_completed
from typing import Any, NamedTuple

from coilspring.workers import processes
from validation.study.store import Store

FILE = "result.json"  # of an entry of the store


class Job(NamedTuple):
    """A piece of work: a function and its arguments, which give what JSON can hold."""

    function: Callable[..., Any]
    arguments: tuple

    def __call__(self) -> Any:
        """Do it, and give it as it is read from the store."""
        return json.loads(json.dumps(self.function(*self.arguments)))


def stored(store: Store, key: str) -> Any:
    """A result by its key, or None."""
    files = store.get(key)
    return None if files is None else json.loads(files[FILE])


def kept(store: Store, key: str, job: Job) -> Any:
    """The result of a job, done in this process unless it is stored."""
    found = stored(store, key)
    if found is None:
        found = job()
        store.put(key, {FILE: json.dumps(found).encode()})
    return found


def gathered(store: Store, jobs: Mapping[str, Job], progress: Callable[[int, int], None]) -> list[Any]:
    """Results of jobs by key, in their order; those that are not stored are done by all processor cores."""
    found = {key: stored(store, key) for key in jobs}
    missing = [key for key, result in found.items() if result is None]
    if missing:
        with processes(os.cpu_count() or 1) as pool:
            waiting: dict[Future, str] = {pool.submit(_done, jobs[key]): key for key in missing}
            for future in as_completed(waiting):
                key = waiting[future]
                found[key] = future.result()
                store.put(key, {FILE: json.dumps(found[key]).encode()})
                missing.remove(key)
                progress(len(jobs) - len(missing), len(jobs))
    return list(found.values())


def _done(job: Job) -> Any:
    return job()
