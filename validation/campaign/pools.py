"""Where a campaign's cases are verified: processes of this machine, or the workers of a Dask cluster."""

from __future__ import annotations

from collections.abc import Iterator
from concurrent.futures import Executor
from contextlib import contextmanager

from coilspring import InputError, workers

PATIENCE = "10s"  # for a scheduler to answer


@contextmanager
def processes(count: int) -> Iterator[tuple[Executor, int]]:
    """Processes of this machine, and how many."""
    with workers.processes(count) as pool:
        yield pool, count


@contextmanager
def cluster(scheduler: str) -> Iterator[tuple[Executor, int]]:
    """Workers of the Dask cluster at an address, and how many threads they have.

    Raises
    ------
    InputError : Dask is not installed, nothing answers at the address, or the cluster has no workers.
    """
    try:
        from distributed import Client
    except ModuleNotFoundError:
        raise InputError(
            f"scheduler {scheduler!r} needs the package distributed: pip install 'coilcheck[dask]'"
        ) from None
    try:
        client = Client(scheduler, timeout=PATIENCE, set_as_default=False)
    except (OSError, ValueError) as error:
        words = f"scheduler must be the address of a Dask scheduler, as tcp://HOST:8786, got {scheduler!r}"
        raise InputError(f"{words}: {error or type(error).__name__}") from None
    with client:
        size = sum(client.nthreads().values())
        if size == 0:
            raise InputError(f"scheduler {scheduler!r} has no workers")
        pool = client.get_executor(pure=False)
        try:
            yield pool, size
        finally:  # after an exception there are cases left, which are cancelled
            pool.shutdown(wait=False)
